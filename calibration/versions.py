"""Versions of everything that the numbers of a report depend on."""

from importlib.metadata import version

_LIBRARIES = ("ductile-joints", "numpy", "scipy", "scikit-fem", "pymunk", "numba")


def versions() -> dict[str, str]:
    """By the names of the libraries."""
    return {name: version(name) for name in _LIBRARIES}
