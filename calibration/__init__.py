"""Which joints, which rule, which step: rigid bodies tuned to the continuum, with the error and what it costs.

>>> from calibration import calibrate
>>> from scene import load_scene
>>> result = calibrate(load_scene("cantilever"), target_error=0.01)
>>> result.target_met
True
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from calibration.trials import Trial
    from calibration.tuning import Calibration, calibrate

__all__ = ["Calibration", "Trial", "calibrate"]


def __getattr__(name: str) -> Any:
    # Imported on demand: the command line lives in this package and must answer before the kernels are loaded.
    if name in __all__:
        from importlib import import_module

        return getattr(import_module("calibration.tuning"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
