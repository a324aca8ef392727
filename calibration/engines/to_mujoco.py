"""MuJoCo: a tree of bodies, each joint a hinge with a position servo whose torque ends at M_max.

A servo forgets what has yielded unless its set point follows: `follow` is what a simulation loop has to do. Hinges with
dry friction would remember by themselves, but MuJoCo's friction creeps: a cantilever held by it sinks within seconds.

The bodies' frames are not turned as the scene begins; x and z are the scene's x and y, and hinges turn about -y. A loop
is closed by a body that is in either branch with half its mass, the halves welded together: no joint is left out.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from calibration.engines.handover import Handover, JointTerms, PushPoint
from calibration.engines.pushing import Pushed, push_rig

#: How hard welds are: MuJoCo's solimp near one, and a solref far shorter than its default, with which a light node's
#: weld gives way as much as the members.
_IMPEDANCE, _REFERENCE = "0.9999 0.9999 0.001 0.5 2", "0.0001 1"
#: The pusher's spring over the stiffest joint's over the way: it gives way by next to nothing.
_PUSHER = 1e3


def model_xml(handover: Handover, notes: str) -> str:
    """The scene as MJCF."""
    return _Tree(handover, notes).text()


@dataclass
class _Tree:
    handover: Handover
    notes: str
    elements: dict[int, ET.Element] = field(default_factory=dict)

    def text(self) -> str:
        handover = self.handover
        root = ET.Element("mujoco", model=handover.name)
        root.append(ET.Comment("\n" + self.notes.replace("--", "-") + "\n"))
        ET.SubElement(root, "compiler", angle="radian")
        ET.SubElement(
            root, "option", timestep=repr(handover.model.dt), integrator="discrete", iterations="100",
            tolerance="1e-12", gravity=f"0 0 {-handover.gravity!r}",
        )  # fmt: skip
        self.elements[-1] = ET.SubElement(root, "worldbody")
        self.equality, self.actuator = ET.SubElement(root, "equality"), ET.SubElement(root, "actuator")
        left = list(enumerate(handover.joints))
        while left:
            ready = next((item for item in left if {item[1].a, item[1].b} & self.elements.keys()), None)
            if ready is None:
                self._float(left[0][1].a)
            else:
                left.remove(ready)
                self._join(*ready)
        ET.indent(root)
        return ET.tostring(root, encoding="unicode") + "\n"

    def _at(self, body: int) -> tuple[float, float]:
        return (0.0, 0.0) if body < 0 else (self.handover.bodies[body].x, self.handover.bodies[body].y)

    def _float(self, body: int) -> None:
        """A part that nothing holds moves freely in its plane."""
        element = self.elements[body] = self._body(-1, body, self.handover.bodies[body].name)
        for kind, axis in (("slide", "1 0 0"), ("slide", "0 0 1"), ("hinge", "0 -1 0")):
            ET.SubElement(element, "joint", type=kind, axis=axis)

    def _join(self, number: int, joint: JointTerms) -> None:
        parent, child = (joint.a, joint.b) if joint.a in self.elements and joint.b >= 0 else (joint.b, joint.a)
        if child in self.elements:
            element = self._twin(parent, child, number)
        else:
            element = self.elements[child] = self._body(parent, child, self.handover.bodies[child].name)
        (x, y), (px, py) = self._at(child), joint.at
        pos = f"{px - x!r} 0 {py - y!r}"
        if joint.slide is not None:
            axis = f"{math.cos(joint.slide)!r} 0 {math.sin(joint.slide)!r}"
            ET.SubElement(element, "joint", name=f"slide.{number}", type="slide", pos=pos, axis=axis)
        name = f"joint.{number}"
        ET.SubElement(element, "joint", name=name, type="hinge", pos=pos, axis="0 -1 0")
        if not joint.turns_freely:
            servo = ET.SubElement(self.actuator, "position", name=name, joint=name)
            servo.attrib |= {"kp": repr(joint.stiffness[2]), "kv": repr(joint.damping)}
            if math.isfinite(joint.capacity[2]):
                servo.attrib["forcerange"] = f"{-joint.capacity[2]!r} {joint.capacity[2]!r}"

    def _twin(self, parent: int, body: int, number: int) -> ET.Element:
        """Another half of a body that is in the tree already, welded to the first."""
        name = self.handover.bodies[body].name
        twin = self._body(parent, body, f"{name}.twin.{number}")
        inertial, copied = self.elements[body].find("inertial"), twin.find("inertial")
        assert inertial is not None
        assert copied is not None
        for key in ("mass", "diaginertia"):
            inertial.attrib[key] = " ".join(repr(0.5 * float(x)) for x in inertial.attrib[key].split())
            copied.attrib[key] = inertial.attrib[key]
        ET.SubElement(
            self.equality, "weld", body1=name, body2=f"{name}.twin.{number}", solimp=_IMPEDANCE, solref=_REFERENCE
        )
        return twin

    def _body(self, parent: int, body: int, name: str) -> ET.Element:
        piece = self.handover.bodies[body]
        (x, y), (px, py) = self._at(body), self._at(parent)
        element = ET.SubElement(self.elements[parent], "body", name=name, pos=f"{x - px!r} 0 {y - py!r}")
        inertia = " ".join([repr(piece.moment)] * 3)
        ET.SubElement(element, "inertial", pos="0 0 0", mass=repr(piece.mass), diaginertia=inertia)
        if piece.length > 0.0:
            size = " ".join(repr(float(0.5 * x)) for x in (piece.length, piece.depth, piece.depth))
            turned = f"0 {-piece.angle!r} 0"
            ET.SubElement(element, "geom", type="box", size=size, euler=turned, contype="0", conaffinity="0")
        return element


def push_xml(text: str, handover: Handover, push: PushPoint, distances: np.ndarray) -> Pushed:
    """Load a model that `model_xml` wrote, and push it in MuJoCo."""
    return push_rig(_MujocoRig(text, handover, push), handover, push, distances)


def follow(data: Any, yields: Sequence[tuple[str, float]]) -> None:
    """Move the set points of servos that have yielded; ``yields`` names them with their largest elastic rotation."""
    for name, largest in yields:
        turned, servo = float(data.joint(name).qpos[0]), data.actuator(name)
        elastic = turned - float(servo.ctrl[0])
        if abs(elastic) > largest:
            servo.ctrl[0] = turned - math.copysign(largest, elastic)


class _MujocoRig:
    """The model with a pusher added; see `calibration.engines.pushing.Rig`."""

    def __init__(self, text: str, handover: Handover, push: PushPoint) -> None:
        import mujoco

        self.lib, self.handover = mujoco, handover
        spec = mujoco.MjSpec.from_string(text)
        piece = handover.bodies[push.body]
        c, s = math.cos(piece.angle), math.sin(piece.angle)
        (px, py), (dx, dy) = push.point, push.direction
        offset = (c * px - s * py, 0.0, s * px + c * py)
        at = (piece.x + offset[0], 0.0, piece.y + offset[2])
        pusher = spec.worldbody.add_body(name="pusher", pos=at)
        pusher.mass, pusher.inertia, pusher.explicitinertial = 1e-3 * piece.mass, [piece.moment] * 3, True
        slide = mujoco.mjtJoint.mjJNT_SLIDE
        pusher.add_joint(name="along", type=slide, axis=(dx, 0.0, dy))
        pusher.add_joint(name="across", type=slide, axis=(-dy, 0.0, dx))
        tie = spec.add_equality(name="tie", type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_BODY)
        tie.name1, tie.name2 = "pusher", piece.name
        tie.data[:3] = (0.0, 0.0, 0.0)
        tie.solimp[:] = [float(x) for x in _IMPEDANCE.split()]
        tie.solref[:] = [float(x) for x in _REFERENCE.split()]
        self.stiffness = _PUSHER * max(j.stiffness[2] for j in handover.joints)
        spec.add_actuator(
            name="push", target="along", trntype=mujoco.mjtTrn.mjTRN_JOINT,
            gainprm=[self.stiffness, *[0.0] * 9], biastype=mujoco.mjtBias.mjBIAS_AFFINE,
            biasprm=[0.0, -self.stiffness, *[0.0] * 8],
        )  # fmt: skip
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.numbers = [self.model.body(body.name).id for body in handover.bodies]
        self.yields = [
            (f"joint.{i}", joint.yield_rotation)
            for i, joint in enumerate(handover.joints)
            if math.isfinite(joint.yield_rotation)
        ]
        self.held, self.origin = False, 0.0
        self._grip(0.0)
        mujoco.mj_forward(self.model, self.data)

    def _grip(self, stiffness: float) -> None:
        push = self.model.actuator("push").id
        self.model.actuator_gainprm[push, 0], self.model.actuator_biasprm[push, 1] = stiffness, -stiffness

    def place(self, body: int) -> tuple[float, float, float]:
        number, piece = self.numbers[body], self.handover.bodies[body]
        x, _, y = self.data.xpos[number]
        turned = self.data.xmat[number].reshape(3, 3)
        return float(x), float(y), piece.angle + math.atan2(turned[2, 0], turned[0, 0])

    def act(self, body: int, force: tuple[float, float], moment: float) -> None:
        self.data.xfrc_applied[self.numbers[body]] += (force[0], 0.0, force[1], 0.0, -moment, 0.0)

    def hold(self) -> None:
        self.held, self.origin = True, float(self.data.joint("along").qpos[0])
        self._grip(self.stiffness)

    def step(self, travel: float) -> float:
        if self.held:
            self.data.actuator("push").ctrl[0] = self.origin + travel
        self.lib.mj_step(self.model, self.data)
        follow(self.data, self.yields)
        self.data.xfrc_applied[:] = 0.0
        self.lib.mj_kinematics(self.model, self.data)
        # The step is implicit: what the spring bore in it is what it bears at its end.
        left = self.origin + travel - float(self.data.joint("along").qpos[0])
        return self.stiffness * left if self.held else 0.0
