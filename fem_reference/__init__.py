"""What the continuum does: elastic–plastic beams and frames on scikit-fem, each answer with an error estimate."""

from fem_reference.dynamics import MotionResult, motion
from fem_reference.hinge_events import HingeEvent
from fem_reference.member_results import MemberResult
from fem_reference.modes import Modes, natural_modes
from fem_reference.paths import NotConverged
from fem_reference.pushover import Energy, Pushover, pushover
from fem_reference.validity import remarks

__all__ = [
    "Energy",
    "HingeEvent",
    "MemberResult",
    "Modes",
    "MotionResult",
    "NotConverged",
    "Pushover",
    "motion",
    "natural_modes",
    "pushover",
    "remarks",
]
