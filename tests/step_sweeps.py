"""Blows, falls and sudden loads at several steps and iterations, with implicit Euler unless said."""

import itertools
import math
from collections.abc import Callable, Iterator

import pymunk
import sudden_cases as sudden
from crash_cases import into_wall
from held_cases import HELD
from sudden_cases import BEAM
from vehicle_cases import post_hit

from capacity import capacity, parse_material, parse_section
from sim import AVERAGE_ACCELERATION, DuctileJoint, ElasticPlastic, Limits, Model, Structure, assemble

RATES = (60, 120, 240, 1000)
ITERATIONS = (2, 10, 30)


def crate(rate: int, iterations: int, gap: float = 0.4, slop: float = 0.1) -> tuple[float, float]:
    """Peak and lasting deflection of the tip [m]: 200 kg fall by ``gap`` on a cantilever IPE 100 of 1 m."""
    space = pymunk.Space()
    space.gravity, space.iterations, space.collision_slop = (0.0, -9.81), iterations, slop
    beam = assemble(BEAM, Model("lobatto", 6, "fibre", fibres=8), space)
    body = pymunk.Body(200.0, 200.0 * 0.3**2 / 6.0)
    body.position = (0.85, 0.05 + gap + 0.15)
    shape = pymunk.Poly.create_box(body, (0.3, 0.3))
    shape.friction = 1.0
    space.add(body, shape)
    lowest = 0.0
    for _ in range(round(1.5 * rate)):
        space.step(1.0 / rate)
        lowest = min(lowest, beam.nodes["tip"].now()[1])
    return -lowest, -beam.nodes["tip"].now()[1]


def post(rate: int, iterations: int, speed: float = 15.0) -> tuple[float]:
    """What a ball of 200 kg keeps of its speed behind a post that it breaks at its foot [m/s]."""
    space = pymunk.Space()
    space.iterations, space.collision_slop = iterations, 1e-3
    body = pymunk.Body(36.0, 36.0 * (3.0**2 + 0.1**2) / 12.0)
    body.position = (0.0, 1.6)
    tube = capacity(parse_section("RHS 100x100x4 mm"), parse_material("fy=275 MPa"))
    law = ElasticPlastic((tube.EA / 0.1, tube.GA_s / 0.1, tube.EI / 0.1), (210.4e3, 210.4e3, 15.1e3))
    limits = Limits(elongation=0.1, slip=0.1, rotation=0.2)
    foot = DuctileJoint(space.static_body, body, (0.0, 0.1), law, direction=math.pi / 2, limits=limits)
    ball = pymunk.Body(200.0, 0.5 * 200.0 * 0.5**2)
    ball.position, ball.velocity = (-0.57, 1.5), (speed, 0.0)
    space.add(body, pymunk.Poly.create_box(body, (0.1, 3.0)), foot, ball, pymunk.Circle(ball, 0.5))
    while not foot.broken:
        space.step(1.0 / rate)
    return (ball.velocity.x,)


def struck_in_flight(rate: int, iterations: int) -> tuple[float]:
    """What a free bar of ten weak pieces takes of a ball of 5 kg that flies into its middle at 20 m/s [J]."""
    space = pymunk.Space()
    space.iterations, space.collision_slop = iterations, 1e-3
    steel, section = parse_material("fy=235 MPa, E=200 GPa, rho=7800 kg/m^3"), parse_section("rectangle 40x20 mm")
    c, piece = capacity(section, steel), 0.1
    bodies = []
    for i in range(10):
        mass = steel.density * section.area * piece
        body = pymunk.Body(mass, mass * piece**2 / 12.0)
        body.position = ((i + 0.5) * piece, 0.0)
        shape = pymunk.Poly.create_box(body, (piece, 0.02))
        shape.filter = pymunk.ShapeFilter(group=1)
        space.add(body, shape)
        bodies.append(body)
    law = ElasticPlastic((c.EA / piece, c.GA_s / piece, c.EI / piece), (c.N_max, c.Q_max, c.M_max))
    joints = [
        DuctileJoint(a, b, (b.position.x - 0.5 * piece, 0.0), law, direction=0.0) for a, b in itertools.pairwise(bodies)
    ]
    structure = Structure(joints)
    ball = pymunk.Body(5.0, 5.0 * 0.05**2 / 2.0)
    ball.position, ball.velocity = (0.5, 0.35), (0.0, -20.0)
    space.add(*joints, ball, pymunk.Circle(ball, 0.05))
    for _ in range(round(0.3 * rate)):
        space.step(1.0 / rate)
    return (float(structure.dissipated.sum()),)


CASES: dict[str, Callable[[int, int], tuple[float, ...]]] = {
    "crate of 200 kg falls 0.4 m on a cantilever: peak, lasting deflection [m]": crate,
    "the same from 0.38 m": lambda rate, iterations: crate(rate, iterations, gap=0.38),
    "the same, overlap of 1 mm allowed": lambda rate, iterations: crate(rate, iterations, slop=1e-3),
    "ball of 15 m/s breaks a post: speed kept [m/s]": post,
    "ball of 30 m/s breaks a post: speed kept [m/s]": lambda rate, iterations: post(rate, iterations, 30.0),
    "ball flies into a free bar: plastic work [J]": struck_in_flight,
    "wheel of 100 kg with 100 kg pivoted on its axle falls 0.4 m on it: the same": sudden.loaded_wheel,
    "sudden load on a yielding hinge: peak, plastic rotation [rad]": sudden.sudden_load,
    "the same, second-order scheme": lambda rate, n: sudden.sudden_load(rate, n, AVERAGE_ACCELERATION),
    "gravity begins, cantilever with 750 kg at its tip: peak [m], plastic work [J]": sudden.gravity_at_once,
    "the same, its prop is taken away": sudden.prop_taken_away,
    "mass sticks to a cantilever, C6-parkes-mid: plastic work [J], what stays [m]": sudden.struck_cantilever,
    "C6-parkes-heavy": lambda rate, n: sudden.struck_cantilever(rate, n, "C6-parkes-heavy"),
    "C6-parkes-mid, second-order scheme": lambda rate, n: sudden.struck_cantilever(
        rate, n, scheme=AVERAGE_ACCELERATION
    ),
    "beam falls on pins, C6-drop-beam: the same": sudden.beam_on_pins,
    "the same, by the second-order scheme": lambda rate, n: sudden.beam_on_pins(rate, n, AVERAGE_ACCELERATION),
    "mass on a hinge, sudden load, C6-sdof-step: the same": sudden.mass_on_hinge,
    "weak bar falls flat on a block under its middle: plastic work [J]": sudden.bar_on_block,
    "the same on blocks under its ends": sudden.bar_on_bearings,
    "ball of 500 kg falls 0.5 m on a portal: peak deflection [m]": sudden.ball_on_portal,
    "car of 540 kg on springs hits a post at 10 m/s: furthest [m], plastic work [J]": lambda r, n: post_hit(r, n)[:2],
    "the same, motors of 200 N m drive it on": lambda rate, n: post_hit(rate, n, torque=200.0)[:2],
    "the same at 20 m/s, without motors": lambda rate, n: post_hit(rate, n, 20.0)[:2],
    "frame of 340 kg flies into a wall at 8 m/s, N-Q-M interaction: plastic work [J]": into_wall,
    "the same at 15 m/s, fibres": lambda rate, n: into_wall(rate, n, 15.0, "fibre"),
    **HELD,
}


def table() -> Iterator[str]:
    """The table, line by line, in Markdown."""
    yield "| case | " + " | ".join(f"1/{rate} s" for rate in RATES) + " | spread | over iterations |"
    yield "|---|" + "---|" * (len(RATES) + 2)
    for name, run in CASES.items():
        found = {rate: run(rate, 10) for rate in RATES}
        spread = max(max(column) / min(column) for column in zip(*found.values(), strict=True)) - 1.0
        over = [run(60, iterations) for iterations in ITERATIONS]
        change = max(max(column) / min(column) for column in zip(*over, strict=True)) - 1.0
        values = [", ".join(f"{value:.3g}" for value in found[rate]) for rate in RATES]
        yield f"| {name} | " + " | ".join(values) + f" | {spread:.1%} | {change:.1%} |"


if __name__ == "__main__":
    for line in table():
        print(line, flush=True)
