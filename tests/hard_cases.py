"""Hard cases of the structure solver; `hard_case_table` says what each is held to.

The member is a steel bar of 100 x 100 mm (E = 200 GPa, fy = 235 MPa) in pieces of 40 mm and 3.12 kg, clamped at one
end, 2 iterations a step, unless a case says otherwise.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pymunk

from capacity import capacity, parse_material, parse_section
from sim import DuctileJoint, ElasticPlastic, Energy, Limits, Structure

BAR = capacity(parse_section("rectangle 100x100 mm"), parse_material("fy=235 MPa, E=200 GPa, rho=7800 kg/m^3"))
PIECE, MASS = 0.04, 3.12
RIGID = 1e12
UNBREAKABLE = Limits()


@dataclass
class Case:
    """A space with a structure in it, and how to step it."""

    space: pymunk.Space
    structure: Structure
    steps: int = 200
    dt: float = 1.0 / 60.0
    act: Callable[[int], None] = lambda step: None
    #: Whether nothing from outside acts on the bodies, so that their momenta stay.
    isolated: bool = False
    bodies: list[pymunk.Body] = field(default_factory=list)


def law(stiffness: float = 1.0, strength: float = 1.0, bending: float = 1.0) -> ElasticPlastic:
    """The bar's joint over one piece, with multiples of its stiffness and capacity."""
    k = stiffness / PIECE
    caps = (strength * BAR.N_max, strength * BAR.Q_max, strength * bending * BAR.M_max)
    return ElasticPlastic((k * BAR.EA, k * BAR.GA_s, k * bending * BAR.EI), caps)


def chain(
    count: int,
    own: ElasticPlastic | None = None,
    *,
    mass: float = MASS,
    tip: float | None = None,
    clamped: bool = True,
    gravity: float = 9.81,
    limits: Limits = UNBREAKABLE,
    shapes: bool = False,
    y: float = 0.0,
) -> Case:
    """Pieces in a row along x."""
    space = pymunk.Space()
    space.gravity, space.iterations, space.collision_slop = (0.0, -gravity), 2, 1e-4
    bodies: list[pymunk.Body] = []
    for i in range(count):
        m = tip if tip is not None and i == count - 1 else mass
        body = pymunk.Body(m, m * PIECE**2 / 12.0)
        body.position = ((i + 0.5) * PIECE, y)
        space.add(body)
        bodies.append(body)
        if shapes:
            box = pymunk.Poly.create_box(body, (PIECE, 0.1))
            box.friction, box.filter = 0.5, pymunk.ShapeFilter(group=1)
            space.add(box)
    ends = [space.static_body, *bodies] if clamped else bodies
    joints = []
    for a, b in itertools.pairwise(ends):
        at = (b.position.x - 0.5 * PIECE, y)
        joints.append(DuctileJoint(a, b, at, own or law(), direction=0.0, limits=limits))
    structure = Structure(joints)
    space.add(*joints)
    return Case(space, structure, bodies=bodies)


def struck(speed: float) -> Case:
    """A ball of 5 kg flies into the middle of a free bar of 20 pieces."""
    case = chain(20, clamped=False, gravity=0.0, shapes=True)
    ball = pymunk.Body(5.0, 5.0 * 0.05**2 / 2.0)
    ball.position, ball.velocity = (0.42, 0.3), (0.0, -speed)
    case.space.add(ball, pymunk.Circle(ball, 0.05))
    case.bodies.append(ball)
    case.dt, case.steps = 1.0 / 2000.0, 300
    return case


def rests(heavy: float, piece: float) -> Case:
    """A box rests on a bar of 20 pieces, near its tip."""
    case = chain(20, mass=piece, shapes=True)
    box = pymunk.Body(heavy, heavy * 0.1**2 / 6.0)
    box.position = (0.7, 0.05 + 0.05)
    shape = pymunk.Poly.create_box(box, (0.1, 0.1))
    shape.friction = 0.5
    case.space.add(box, shape)
    return case


def spinning() -> Case:
    case = chain(30, clamped=False, gravity=0.0)
    for body in case.bodies:
        body.velocity, body.angular_velocity = (0.0, 5.0 * (body.position.x - 0.6)), 5.0
    case.steps, case.isolated = 600, True
    return case


def thrown() -> Case:
    """Every piece of a free, weak bar is given a velocity of its own, and no weight acts."""
    case = chain(20, law(strength=0.01), clamped=False, gravity=0.0)
    random = np.random.default_rng(1)
    for body in case.bodies:
        body.velocity, body.angular_velocity = tuple(random.uniform(-10.0, 10.0, 2)), random.uniform(-10.0, 10.0)
    case.isolated = True
    return case


def falling_tower() -> Case:
    """Twenty pieces upright on a hinge tilt over and swing through: forces that push while bodies turn."""
    case = chain(20, law(strength=RIGID))
    foot = case.structure.joints[0]
    foot.law = law(strength=RIGID, bending=0.0)
    case.structure.change_law(0, foot.law)
    turn = math.pi / 2.0 - 0.02
    for body in case.bodies:
        body.position, body.angle = body.position.rotated(turn), turn
    case.steps = 300
    return case


def falls_on_the_ground(restitution: float) -> Case:
    """Six weak pieces, thrown down at their tip, yield, hit the ground and bounce; shapes as the steel's."""
    case = chain(6, law(strength=3e-4), shapes=True)
    ground = pymunk.Segment(case.space.static_body, (-5.0, -1.15), (50.0, -1.15), 1.0)
    ground.friction = 0.5
    case.space.add(ground)
    for shape in case.space.shapes:
        shape.elasticity = restitution
    case.bodies[-1].velocity = (0.0, -5.0)
    return case


def cyclic() -> Case:
    """The tip of ten pieces is driven to and fro, 100 times past yielding."""
    case = chain(10, gravity=0.0)
    driver = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    driver.position = (0.4, 0.0)
    pull = ElasticPlastic((0.0, 1e9, 0.0), (0.0, math.inf, 0.0))
    joint = DuctileJoint(case.bodies[-1], driver, (0.4, 0.0), pull, direction=0.0, turn=1.0)
    case.space.add(driver, joint)
    case.structure = Structure([*case.structure.joints, joint])
    case.steps, case.dt = 10_000, 1.0 / 100.0
    case.act = lambda step: setattr(driver, "velocity", (0.0, 0.02 * math.cos(2.0 * math.pi * step / 100.0)))
    return case


def all_limits() -> Case:
    """A single joint is pulled, sheared and bent past its limits at once."""
    case = chain(1, law(strength=0.01), gravity=0.0)
    body = case.bodies[0]
    body.mass, body.moment = 1000.0, 1000.0

    def act(step: int) -> None:  # noqa: ARG001
        force = (1.2 * 0.01 * BAR.N_max, -1.5 * 0.01 * BAR.Q_max)
        body.apply_force_at_world_point(force, body.position)
        body.torque += 2.0 * 0.01 * BAR.M_max

    case.act, case.steps, case.dt = act, 60, 1.0 / 240.0
    return case


def redundant() -> Case:
    """Twenty pieces clamped at both ends, and held again at five places between, under 200 times their weight."""
    case = chain(20, gravity=200 * 9.81)
    held = [(case.bodies[-1], 0.8), *((case.bodies[i], case.bodies[i].position.x) for i in (3, 7, 11, 15, 18))]
    more = [DuctileJoint(case.space.static_body, body, (x, 0.0), law(), direction=0.0) for body, x in held]
    case.space.add(*more)
    case.structure = Structure([*case.structure.joints, *more])
    return case


def shattering() -> Case:
    """Every joint of a free bar breaks in the first step."""
    limits = Limits(elongation=1e-6, slip=1e-6, rotation=1e-6)
    case = chain(20, law(strength=0.001), clamped=False, gravity=0.0, limits=limits)
    for i, body in enumerate(case.bodies):
        body.velocity, body.angular_velocity = (5.0 * i, (-1) ** i * 30.0), (-1) ** i * 50.0
    case.steps, case.isolated = 20, True
    return case


CASES: dict[str, Callable[[], Case]] = {
    "1 joint": lambda: chain(1),
    "10 joints": lambda: chain(10),
    "100 joints": lambda: chain(100),
    "1000 joints, falling down": lambda: chain(1000),
    "dt = 1/30 s": lambda: _with(chain(100), dt=1.0 / 30.0),
    "dt = 1e-5 s": lambda: _with(chain(20), dt=1e-5, steps=1000),
    "tip piece of 3e-5 kg": lambda: chain(20, tip=1e-5 * MASS),
    "tip piece of 312 t: the bar folds": lambda: chain(20, tip=1e5 * MASS),
    "1000 kg rest on pieces of 0.1 kg": lambda: rests(1000.0, 0.1),
    "10 g rest on pieces of 1000 kg": lambda: rests(0.01, 1000.0),
    "1000 kg swing on a cord of 20 links of 0.1 kg": lambda: _with(
        chain(20, law(strength=RIGID, bending=0.0), mass=0.1, tip=1000.0), steps=600
    ),
    "stiffness x 1e-3": lambda: chain(20, law(1e-3)),
    "stiffness x 1e6": lambda: chain(20, law(1e6)),
    "20 pieces upright on a hinge fall over": falling_tower,
    "a weak bar falls on the ground, e = 0": lambda: falls_on_the_ground(0.0),
    "a weak bar falls on the ground, e = 0.9": lambda: falls_on_the_ground(0.9),
    "ball at 10 m/s": lambda: struck(10.0),
    "ball at 100 m/s": lambda: struck(100.0),
    "free spinning beam, no gravity": spinning,
    "every piece thrown its own way, no gravity": thrown,
    "10 000 steps of cycles past yielding": cyclic,
    "N, Q and M at their limits at once": all_limits,
    "redundant supports": redundant,
    "everything breaks in one step": shattering,
}


def _with(case: Case, **changes: float) -> Case:
    for name, value in changes.items():
        setattr(case, name, value)
    return case


def momenta(bodies: list[pymunk.Body]) -> tuple[np.ndarray, float]:
    """Linear and angular momentum, and the size of what they are summed from."""
    rows = [(b.mass, b.moment, *b.position, *b.velocity, b.angular_velocity) for b in bodies]
    m, i, x, y, vx, vy, w = np.array(rows).T
    total = np.array([(m * vx).sum(), (m * vy).sum(), (m * (x * vy - y * vx) + i * w).sum()])
    size = float((m * np.hypot(vx, vy) * (1.0 + np.hypot(x, y)) + i * np.abs(w)).sum())
    return total, size


def largest(energy: Energy) -> float:
    """The largest entry of a ledger [J]."""
    return max(map(abs, vars(energy).values()))
