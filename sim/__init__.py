"""What rigid bodies with ductile joints do: pymunk, and one implicit solve for a whole structure inside its step."""

from sim import collision_tree, installed

installed.verify()
collision_tree.verify()

from sim.debug_draw import draw_joints  # noqa: E402  (nothing may run on structs that do not fit)
from sim.energy import Energy, energy  # noqa: E402
from sim.first_touch import stop_at_first_touch  # noqa: E402
from sim.joint import AVERAGE_ACCELERATION, IMPLICIT_EULER, DuctileJoint  # noqa: E402
from sim.joint_arrays import JointArrays  # noqa: E402
from sim.laws import LAWS, Bearing, ElasticPlastic, FibreSection, InteractionPlastic, Law, RigidPlastic, section_law  # noqa: E402
from sim.limits import Limits  # noqa: E402
from sim.member_joints import JointPlace  # noqa: E402
from sim.members import Assembly, assemble  # noqa: E402
from sim.model import MemberModel, Model  # noqa: E402
from sim.modes import natural_modes  # noqa: E402
from sim.motion import Course, follow, set_going  # noqa: E402
from sim.pushover import PACE, Pace, Push, push_over  # noqa: E402
from sim.recording import Recorder, Recording  # noqa: E402
from sim.rules import RULES, Rule, equal, graded, lobatto, radau  # noqa: E402
from sim.step_back import SolverError  # noqa: E402
from sim.structure import Structure  # noqa: E402
from sim.system_ledger import SystemLedger  # noqa: E402

__all__ = [
    "AVERAGE_ACCELERATION",
    "IMPLICIT_EULER",
    "LAWS",
    "PACE",
    "RULES",
    "Assembly",
    "Bearing",
    "Course",
    "DuctileJoint",
    "ElasticPlastic",
    "Energy",
    "FibreSection",
    "InteractionPlastic",
    "JointArrays",
    "JointPlace",
    "Law",
    "Limits",
    "MemberModel",
    "Model",
    "Pace",
    "Push",
    "Recorder",
    "Recording",
    "RigidPlastic",
    "Rule",
    "SolverError",
    "Structure",
    "SystemLedger",
    "assemble",
    "draw_joints",
    "energy",
    "equal",
    "follow",
    "graded",
    "lobatto",
    "natural_modes",
    "push_over",
    "radau",
    "section_law",
    "set_going",
    "stop_at_first_touch",
]
