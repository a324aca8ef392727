"""What the continuum does: elastic–plastic frames and plane stress on scikit-fem, each with an error estimate."""

from fem_reference.beam_fields import motion_field_files, push_field_files
from fem_reference.branching import branches_at
from fem_reference.dynamics import HISTORY_SHARE, MotionResult, motion
from fem_reference.hinge_events import HingeEvent
from fem_reference.hinge_times import HingeTime
from fem_reference.member_results import MemberErrors, MemberPath, MemberResult
from fem_reference.modes import Modes, natural_modes
from fem_reference.paths import NotConverged
from fem_reference.plane import Fields, PlanePush, field_files, plane_push
from fem_reference.push_over import PushAnswer, default_tolerance, push_over
from fem_reference.pushover import Energy, Pushover, pushover
from fem_reference.validity import remarks, wants_plane_stress

__all__ = [
    "HISTORY_SHARE",
    "Energy",
    "Fields",
    "HingeEvent",
    "HingeTime",
    "MemberErrors",
    "MemberPath",
    "MemberResult",
    "Modes",
    "MotionResult",
    "NotConverged",
    "PlanePush",
    "PushAnswer",
    "Pushover",
    "branches_at",
    "default_tolerance",
    "field_files",
    "motion",
    "motion_field_files",
    "natural_modes",
    "plane_push",
    "push_field_files",
    "push_over",
    "pushover",
    "remarks",
    "wants_plane_stress",
]
