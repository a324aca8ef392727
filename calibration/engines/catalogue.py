"""The engines: what is written for each, what it cannot express, and whether it can be run here."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from calibration.engines import snippets
from calibration.engines.handover import Handover, PushPoint
from calibration.engines.in_box2d import push_in_box2d
from calibration.engines.in_bullet import NoTree, push_in_bullet
from calibration.engines.pushing import Pushed
from calibration.engines.to_mujoco import model_xml, push_xml
from calibration.engines.to_pymunk import Turn, module_text, push_module

#: Writes a file's text from what is handed over and the notes at its head.
Writer = Callable[[Handover, str], str]
#: Pushes the scene in the engine, given the file's text.
Runner = Callable[[str, Handover, PushPoint, np.ndarray], Pushed]


@dataclass(frozen=True)
class Engine:
    """An engine that joints can be handed to.

    Attributes
    ----------
    title : str
        What the file is.
    suffix : str
        Of the file.
    comment : str
        What begins a line of notes.
    writers : dict[str, Writer]
        Ways to put a ductile joint in the engine's terms; the one with the least error is taken.
    cannot : str
        What the engine cannot express, and what the file does about it.
    run : Runner, optional
        How it is pushed over here.
    needs : str
        Module that must be installed for that.
    run_as : str
        What is run, where it is not the file itself.
    """

    title: str
    suffix: str
    comment: str
    writers: dict[str, Writer]
    cannot: str
    run: Runner | None = None
    needs: str = ""
    run_as: str = ""

    @property
    def installed(self) -> bool:
        """Whether it can be run here."""
        return self.run is not None and find_spec(self.needs) is not None


def _pymunk(turn: Turn) -> Writer:
    return lambda handover, notes: module_text(handover, turn, notes)


_ONE_BY_ONE = (
    "Joints are solved one after another, so long chains are too soft: few pieces, short steps and many iterations "
    "help. "
)
_NO_INTERACTION = (
    "N, Q and M do not interact. N and Q are one limit on the resultant force, the smaller of N_max and Q_max. "
)
_FOLLOW = "A spring forgets what has yielded: call the function at the end after every step. "
_MOTOR = (
    "No spring has a largest torque: the rotation is held by a motor that stands still until M_max, rigid and then "
    "plastic, and it creeps while it holds. Stiffness and damping are given for use without yielding. "
)
_SOFT_PINS = "Axial and shear stiffness: pins are rigid. "
_BREAK = (
    "Breaking goes by plastic rotation, counted by the function at the end; the engine's own thresholds would snap it. "
)

ENGINES: dict[str, Engine] = {
    "pymunk": Engine(
        "pymunk 7, stock constraints only",
        ".py",
        "",
        {"gear": _pymunk("gear"), "spring": _pymunk("spring")},
        _ONE_BY_ONE
        + _NO_INTERACTION
        + _SOFT_PINS
        + "A gear is rigid until it yields; a spring is elastic, but explicit, "
        "and runs away when the step is long.",
        lambda text, handover, push, way: push_module(text, handover, push, way),
        "pymunk",
    ),
    "box2d": Engine(
        "Box2D 3.2 or later, C",
        ".c",
        "// ",
        {"": snippets.box2d},
        _ONE_BY_ONE + _NO_INTERACTION + _SOFT_PINS + _FOLLOW + _BREAK,
        lambda text, handover, push, way: push_in_box2d(handover, push, way),
        "Box2D",
        "Box2D 2.3 with the same pins, and with motors that stand still until M_max in place of the springs, which it "
        "does not have",
    ),
    "bullet": Engine(
        "Bullet 2.87 or later, C++",
        ".cpp",
        "// ",
        {"": snippets.bullet},
        _ONE_BY_ONE
        + _NO_INTERACTION
        + _SOFT_PINS
        + _MOTOR
        + "With 200 iterations motors hold; with 30 a chain folds under a tenth of its load. "
        + "Breaking by plastic rotation: only the pin's force breaks it.",
        lambda text, handover, push, way: push_in_bullet(handover, push, way),
        "pybullet",
        "PyBullet as a tree of links with motors of the same torque",
    ),
    "mujoco": Engine(
        "MuJoCo 3.13 or later, MJCF",
        ".xml",
        "",
        {"": model_xml},
        "Axial and shear stiffness and limits, and their interaction with M: hinges are rigid. A servo forgets what "
        "has yielded: after each step, where |qpos - ctrl| > M_max / kp, move ctrl after qpos until it is M_max / kp. "
        "Breaking: set the servo's forcerange to 0 by hand.",
        lambda text, handover, push, way: push_xml(text, handover, push, way),
        "mujoco",
    ),
    "rapier": Engine(
        "rapier2d 0.25, Rust",
        ".rs",
        "// ",
        {"": snippets.rapier},
        _ONE_BY_ONE
        + "Iterations are num_internal_pgs_iterations. "
        + _SOFT_PINS
        + "Limits on N and Q: read the joint's impulses and remove it. "
        + _FOLLOW
        + _BREAK,
    ),
    "godot": Engine(
        "Godot 4, GDScript",
        ".gd",
        "# ",
        {"": snippets.godot},
        _ONE_BY_ONE
        + _SOFT_PINS
        + _MOTOR
        + "Forces of a joint cannot be read or limited. PinJoint2D has no largest torque "
        "either, hence three dimensions.",
    ),
    "unity": Engine(
        "Unity 2022 or later, C#",
        ".cs",
        "// ",
        {"": snippets.unity},
        _ONE_BY_ONE + _NO_INTERACTION + _SOFT_PINS + _FOLLOW + _BREAK,
    ),
    "unreal": Engine(
        "Unreal 5, C++; cm, kg, s, degrees",
        ".cpp",
        "// ",
        {"": snippets.unreal},
        _ONE_BY_ONE
        + _NO_INTERACTION
        + _SOFT_PINS
        + _FOLLOW
        + "Unreal's own angular plasticity resets the rest angle to "
        "where the joint is: all of the torque is gone at each yielding, and it is not used. " + _BREAK,
    ),
    "json": Engine(
        "any engine, as plain data",
        ".json",
        "",
        {"": snippets.plain_json},
        "Nothing is left out but what the law itself leaves out: gradual yielding, hardening, interaction.",
    ),
}

__all__ = ["ENGINES", "Engine", "NoTree"]
