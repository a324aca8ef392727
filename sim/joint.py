"""A ductile joint: a pymunk constraint that yields, stays bent, and breaks when its plastic reserve is used up."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from capacity import InputError
from capacity.behaviour import from_elastic_rotation, reduced, stiffness_and_damping
from sim import chipmunk
from sim.joint_checks import check_bodies, check_law, check_numbers, check_options, check_place
from sim.joint_readings import JointReadings
from sim.kernels import compiled_callbacks
from sim.kernels.layout import GEOMETRY
from sim.laws import ElasticPlastic, Law
from sim.limits import NO_LIMITS, Limits

if TYPE_CHECKING:
    from sim.structure import Structure

#: β and δ of the time integration (see `sim.kernels.newton`): robust and damped, or second order and undamped.
IMPLICIT_EULER = (0.0, 1.0)
AVERAGE_ACCELERATION = (0.25, 0.0)


class DuctileJoint(JointReadings):
    """A joint between two bodies, free of force as they lie when it is made.

    Add it to a `pymunk.Space` like any other constraint. Joints that share dynamic bodies form one structure by
    themselves and are solved together; see `structure`.

    With x along ``direction`` and y to the left of it, N > 0 goes with b moving along +x, away from a; Q > 0 with b
    moving along +y, past a; M > 0 with b turning counter-clockwise against a. What the joint does to b is -N, -Q, -M.

    While it holds, its bodies do not collide with each other, for it stands for all that is between them: unlike other
    constraints it begins with ``collide_bodies = False``.

    Parameters
    ----------
    a, b : pymunk.Body
        At least one of them dynamic.
    at : (float, float)
        World position of the joint [m].
    law : Law
        Force from deformation, e.g. `ElasticPlastic`.
    direction : float, optional
        Angle of the joint's x axis, along which N acts [rad]; by default from a to b, where a body that is not dynamic,
        such as the ground, counts as being at the joint.
    turn : float, optional
        Share of b's rotation that the axes follow, the rest being a's; ½ between dynamic bodies, and otherwise none,
        so that they stay with the body that holds.
    length : float
        Of the member that the joint stands for [m]; bent, it reaches further than the kink that the joint makes.
    damping : (float, float, float)
        Viscous force over rate of deformation: N s/m, N s/m, N m s/rad.
    limits : Limits
    scheme : (float, float)
        β and δ of the time integration, the same for all joints of a structure.
    on_break : callable, optional
        Called with the joint in the step in which it breaks.

    Raises
    ------
    InputError
        When neither body is dynamic, or something else will not do.
    """

    def __repr__(self) -> str:
        x, y = self.at
        return f"DuctileJoint(at=({x:g}, {y:g}), law={self.law.name!r}, active_limit={self.active_limit!r})"

    def __init__(
        self,
        a: pymunk.Body,
        b: pymunk.Body,
        at: tuple[float, float],
        law: Law,
        *,
        direction: float | None = None,
        turn: float | None = None,
        length: float = 0.0,
        damping: tuple[float, float, float] = (0.0, 0.0, 0.0),
        limits: Limits = NO_LIMITS,
        scheme: tuple[float, float] = IMPLICIT_EULER,
        on_break: Callable[[DuctileJoint], None] | None = None,
    ) -> None:
        check_bodies(a, b)
        check_law(law)
        self.at = check_place(at)
        moving = [body.body_type == pymunk.Body.DYNAMIC for body in (a, b)]
        if direction is None:
            start, end = (
                x.position if moves else pymunk.Vec2d(*self.at) for x, moves in zip((a, b), moving, strict=True)
            )
            direction = (end - start).angle
        if turn is None:
            turn = 0.5 if all(moving) else float(moving.index(False))
        check_options(turn, length, limits, on_break)
        self.law = law
        self.direction = direction
        self.turn = turn
        self.damping = damping
        self.limits = limits
        self.scheme = scheme
        self.on_break = on_break
        rest = (direction - a.angle, direction - b.angle)
        axes = [f(angle) for angle in rest for f in (math.cos, math.sin)]
        self._geometry: np.ndarray | None = np.array(
            [*_anchor(a, self.at), *_anchor(b, self.at), *rest, turn, *axes, length / 24.0]
        )
        check_numbers(damping, scheme, self._geometry)
        self._structure: Structure | None = None
        self._index = 0
        self._attach(a, b)
        self.collide_bodies = False
        self.ask_for_structure()

    def _attach(self, a: pymunk.Body, b: pymunk.Body) -> None:
        """Become a constraint of Chipmunk's between two bodies."""
        self._init(a, b, chipmunk.pivot(a, b))
        chipmunk.adopt(self._constraint, compiled_callbacks().functions)

    def __getstate__(self) -> dict[str, Any]:
        """For `pickle`, `copy` and `pymunk.Space.copy`: all attributes, with the structure and its plastic state."""
        return {
            "bodies": (self.a, self.b),
            "own": {name: value for name, value in vars(self).items() if not name.startswith("_")},
            "geometry": self.geometry.copy(),
            "place": (self._structure, self._index),
            "collide_bodies": self.collide_bodies,
            "asks": self.pre_solve is not None,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state["own"])
        self._geometry = state["geometry"]
        self._structure, self._index = state["place"]
        self._attach(*state["bodies"])
        self.collide_bodies = state["collide_bodies"]
        if self._structure is not None:
            self._structure.restore_joint()
        if state["asks"]:
            self.ask_for_structure()

    @classmethod
    def by_frequency(
        cls,
        a: pymunk.Body,
        b: pymunk.Body,
        at: tuple[float, float],
        frequency: float,
        damping_ratio: float,
        *,
        elastic_rotation: float | None = None,
        capacity: tuple[float, float, float] = (math.inf, math.inf, math.inf),
        translation_frequency: float = 1000.0,
        limits: Limits = NO_LIMITS,
        direction: float | None = None,
        scheme: tuple[float, float] = IMPLICIT_EULER,
        on_break: Callable[[DuctileJoint], None] | None = None,
    ) -> DuctileJoint:
        """An elastic–plastic joint given by how its bodies vibrate on it, as in other engines.

        k = (2π f)² I and c = 2 ζ 2π f I with the moment of inertia I = I_a I_b / (I_a + I_b) that the bodies put
        against each other about their own centres; likewise with their masses in translation.

        Parameters
        ----------
        frequency, damping_ratio : float
            f [Hz] and ζ [-] of the rotation.
        elastic_rotation : float, optional
            Largest elastic rotation [rad], which makes M_max = k θ; in place of the capacity's M_max.
        capacity : (float, float, float)
            N_max [N], Q_max [N], M_max [N m].
        translation_frequency : float
            f of extension and slip [Hz], high, for the joint is rigid in them; ζ as in rotation.

        Raises
        ------
        InputError
            When a number is out of range, both M_max and the elastic rotation are given, or neither body is dynamic.
        """
        moment, mass = (_against(a, b, what) for what in ("moment", "mass"))
        turn, turn_damping = stiffness_and_damping(frequency, damping_ratio, moment)
        shift, shift_damping = stiffness_and_damping(translation_frequency, damping_ratio, mass)
        N_max, Q_max, M_max = capacity
        if elastic_rotation is not None:
            if M_max < math.inf:
                fault = "M_max and the largest elastic rotation are both given"
                raise InputError("elastic rotation", fault, "leave one of them out")
            M_max = from_elastic_rotation(turn, elastic_rotation).value
        return cls(
            a,
            b,
            at,
            ElasticPlastic((shift, shift, turn), (N_max, Q_max, M_max)),
            direction=direction,
            damping=(shift_damping, shift_damping, turn_damping),
            limits=limits,
            scheme=scheme,
            on_break=on_break,
        )

    def ask_for_structure(self) -> None:
        """Have the joints of its space grouped into structures anew at the start of the next step."""
        from sim.grouping import ask

        ask(self)

    def join(self, structure: Structure, index: int) -> None:
        """Become joint ``index`` of ``structure``, whose memory has its geometry; called by the structure itself."""
        self._structure, self._index, self._geometry = structure, index, None
        self.pre_solve = None

    def point_on(self, body: pymunk.Body) -> tuple[float, float]:
        """Where the joint is now, as a point that moves with ``body``, one of its two [m]."""
        ax, ay, bx, by = self.geometry[:4]
        x, y = body.local_to_world(body.center_of_gravity + ((ax, ay) if body is self.a else (bx, by)))
        return x, y

    def rates_on(self, body: pymunk.Body) -> np.ndarray:
        """How fast the joint's end on ``body`` moves along its axes and turns, for the body's vx, vy and ω, (3, 3)."""
        rest_a, rest_b, turn = self.geometry[4:7]
        angle = (1.0 - turn) * (self.a.angle + rest_a) + turn * (self.b.angle + rest_b)
        c, s = math.cos(angle), math.sin(angle)
        arm = pymunk.Vec2d(*self.point_on(body)) - body.local_to_world(body.center_of_gravity)
        return np.array([[c, s, s * arm.x - c * arm.y], [-s, c, c * arm.x + s * arm.y], [0.0, 0.0, 1.0]])

    def rate(self) -> np.ndarray:
        """Rates of extension, slip and rotation, (3,) [m/s, m/s, rad/s]."""
        a, b = (self.rates_on(body) @ [*body.velocity, body.angular_velocity] for body in (self.a, self.b))
        rates: np.ndarray = b - a
        return rates

    @property
    def geometry(self) -> np.ndarray:
        """Anchors, rest angles and axes on the two bodies, (12,), as `sim.kernels.layout` lists them."""
        if self._geometry is not None:
            return self._geometry
        assert self._structure is not None
        row: np.ndarray = self._structure.tables[GEOMETRY][self._index]
        return row

    @property
    def structure(self) -> Structure | None:
        """The structure that the joint is solved with; None before the first step."""
        return self._structure

    @property
    def index(self) -> int:
        """The joint's row in the arrays of its structure."""
        return self._index


def _against(a: pymunk.Body, b: pymunk.Body, what: str) -> float:
    """Mass or moment of inertia that two bodies put against each other; one that is held puts any against the other."""
    return reduced(*(getattr(x, what) if x.body_type == pymunk.Body.DYNAMIC else math.inf for x in (a, b)))


def _anchor(body: pymunk.Body, at: tuple[float, float]) -> list[float]:
    """From the body's centre of gravity to ``at``, in body coordinates [m]."""
    x, y = body.world_to_local(at) - body.center_of_gravity
    return [x, y]
