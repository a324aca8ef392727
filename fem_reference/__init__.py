"""What the continuum does: elastic–plastic beams and frames on scikit-fem, each answer with an error estimate."""

from fem_reference.paths import NotConverged
from fem_reference.pushover import Pushover, pushover

__all__ = ["NotConverged", "Pushover", "pushover"]
