"""Sudden loads, falls and vehicles at several steps: what they bend, for `step_sweeps`.

Each case is a function of steps a second and iterations; the time integration is the default one.
"""

import itertools
import math
from dataclasses import replace

import pymunk
from conftest import CASES as OPEN
from frames import frame_scene

import sim
from capacity import capacity, parse_material, parse_section
from scene import Scene, builtin_text, parse_scene
from sim import IMPLICIT_EULER, DuctileJoint, ElasticPlastic, Model, Structure, assemble

IPE = builtin_text("cantilever").replace("rectangle 50x100 mm", "IPE 100")
#: A cantilever IPE 100 of 1 m, and one that ends in a mass.
BEAM = parse_scene(IPE, "beam")
SIX = Model("lobatto", 6, "fibre", fibres=8)


def new_space(iterations: int, gravity: float = 9.81) -> pymunk.Space:
    """A space with so many iterations, and gravity downwards [m/s²]."""
    space = pymunk.Space()
    space.gravity, space.iterations, space.collision_slop = (0.0, -gravity), iterations, 1e-3
    return space


def sudden_load(rate: int, iterations: int, scheme: tuple[float, float] = IMPLICIT_EULER) -> tuple[float, float]:
    """Peak and plastic rotation [rad] of a bar on a yielding hinge, with a period of 0.5 s, under a sudden load."""
    space = new_space(iterations, 0.0)
    bar = pymunk.Body(10.0, 10.0 * 1.0**2 / 12.0)
    bar.position = (0.5, 0.0)
    inertia = 10.0 * 1.0**2 / 3.0
    stiffness = inertia * (2.0 * math.pi / 0.5) ** 2
    law = ElasticPlastic((1e9, 1e9, stiffness), (1e9, 1e9, 0.02 * stiffness))
    hinge = DuctileJoint(space.static_body, bar, (0.0, 0.0), law, direction=0.0, scheme=scheme)
    space.add(bar, hinge)
    highest = 0.0
    for _ in range(rate):
        bar.apply_force_at_world_point((0.0, 0.7 * 0.02 * stiffness), bar.local_to_world((0.5, 0.0)))
        space.step(1.0 / rate)
        highest = max(highest, bar.angle)
    return highest, float(hinge.plastic_deformation[3])


def loaded_beam(
    space: pymunk.Space, mass: float, scheme: tuple[float, float] = IMPLICIT_EULER
) -> tuple[sim.Assembly, pymunk.Body]:
    """The cantilever with a mass joined to its tip."""
    beam = assemble(BEAM, replace(SIX, scheme=scheme), space, shapes=False)
    tip = beam.nodes["tip"]
    body = pymunk.Body(mass, mass * 0.1**2)
    body.position = tuple(tip.now())
    rigid = ElasticPlastic((1e9, 1e9, 1e7), (1e9, 1e9, 1e9))
    space.add(body, DuctileJoint(tip.body, body, tuple(tip.now()), rigid, direction=0.0, scheme=scheme))
    return beam, body


def deepest(space: pymunk.Space, body: pymunk.Body, rate: int, seconds: float) -> float:
    """How far down a body goes from now on [m]."""
    start, lowest = body.position.y, 0.0
    for _ in range(round(seconds * rate)):
        space.step(1.0 / rate)
        lowest = min(lowest, body.position.y - start)
    return -lowest


def gravity_at_once(rate: int, iterations: int) -> tuple[float, float]:
    """Peak deflection [m] and plastic work [J] of the cantilever, with 750 kg at its tip when gravity begins."""
    space = new_space(iterations)
    beam, body = loaded_beam(space, 750.0)
    return deepest(space, body, rate, 0.5), sum(float(joint.dissipated) for joint in beam.joints)


def prop_taken_away(rate: int, iterations: int) -> tuple[float, float]:
    """The same, on a prop that is taken away when gravity has acted for half a second."""
    space = new_space(iterations)
    beam, body = loaded_beam(space, 750.0)
    prop = DuctileJoint(
        space.static_body, body, tuple(body.position), ElasticPlastic((1e8, 1e8, 0.0), (1e9, 1e9, 1.0)), direction=0.0
    )
    space.add(prop)
    for _ in range(rate // 2):
        space.step(1.0 / rate)
    space.remove(prop)
    return deepest(space, body, rate, 0.5), sum(float(joint.dissipated) for joint in beam.joints)


def open_motion(
    name: str, scene: Scene, joints: int, rate: int, iterations: int, scheme: tuple[float, float] = IMPLICIT_EULER
) -> tuple[float, float]:
    """Plastic work [J] and what stays of the deflection of B [m] of an open case in motion."""
    model = Model("lobatto", joints, "fibre", 16, dt=1.0 / rate, iterations=iterations, scheme=scheme)
    course = sim.follow(scene, model)
    assert course.unconverged == 0, name
    return course.dissipated, -course.residual["B"][1]


def strip(far: str, extra: str, velocity: float, loads: tuple[str, ...] = (), section: str = "20x50") -> Scene:
    """A beam of 1 m, or of 2 m with B in its middle where it has a ``far`` support, set going."""
    motion = f'[motion]\nduration = 0.15\nwatch = "B"\ndirection = [0, -1]\nvelocity = [0.0, {-velocity!r}]'
    nodes = {"A": (0.0, 0.0, "pinned" if far else "clamped"), "B": (1.0, 0.0, "free")}
    members = [("A", "B")]
    if far:
        nodes["C"], members = (2.0, 0.0, far), [("A", "B"), ("B", "C")]
    else:
        nodes.pop("B")
    return frame_scene(nodes, members, motion, loads, section=f"rectangle {section} mm", extra=extra)


def struck_cantilever(
    rate: int, iterations: int, name: str = "C6-parkes-mid", scheme: tuple[float, float] = IMPLICIT_EULER
) -> tuple[float, float]:
    """Parkes' cantilever, a mass sticking to its tip."""
    mass, speed = OPEN[name]["inputs"]["G_kg"], OPEN[name]["inputs"]["V_m_per_s"]
    tip = f"[nodes.B]\nat = [1.0, 0.0]\nmass = {mass!r}\nvelocity = [0.0, {-speed!r}]"
    return open_motion(name, strip("", tip, 0.0), 9, rate, iterations, scheme)


def beam_on_pins(rate: int, iterations: int, scheme: tuple[float, float] = IMPLICIT_EULER) -> tuple[float, float]:
    """A beam that falls flat and is caught by pins at its ends."""
    scene = strip("roller-x", "", OPEN["C6-drop-beam"]["inputs"]["v_m_per_s"])
    return open_motion("C6-drop-beam", scene, 5, rate, iterations, scheme)


def mass_on_hinge(rate: int, iterations: int, row: int = 1) -> tuple[float, float]:
    """A mass on a cantilever of next to no mass, loaded suddenly."""
    case = OPEN["C6-sdof-step"]
    load, mass = case["outputs"]["rows"][row]["alpha"] * case["inputs"]["Ry_N"], case["inputs"]["tip_mass_kg"]
    tip = f"[nodes.B]\nat = [1.0, 0.0]\nmass = {mass!r}"
    scene = strip("", tip, 0.0, (f'node = "B"\nforce = [0.0, {-load!r}]\nkind = "step"',), "50x100")
    return open_motion("C6-sdof-step", scene, 6, rate, iterations)


def weak_bar(space: pymunk.Space, height: float, tilt: float = 0.0) -> Structure:
    """A bar of ten pieces, 1 m long, that comes down with 6 m/s."""
    steel, section = parse_material("fy=80 MPa, E=200 GPa, rho=7800 kg/m^3"), parse_section("rectangle 40x20 mm")
    c, piece, along = capacity(section, steel), 0.1, pymunk.Vec2d(math.cos(tilt), math.sin(tilt))
    bodies = []
    for i in range(10):
        mass = steel.density * section.area * piece
        body = pymunk.Body(mass, mass * piece**2 / 12.0)
        body.position, body.angle, body.velocity = (0.0, height) + (i - 4.5) * piece * along, tilt, (0.0, -6.0)
        shape = pymunk.Poly.create_box(body, (piece, 0.02))
        shape.filter, shape.friction = pymunk.ShapeFilter(group=1), 0.5
        space.add(body, shape)
        bodies.append(body)
    law = ElasticPlastic((c.EA / piece, c.GA_s / piece, c.EI / piece), (c.N_max, c.Q_max, c.M_max))
    joints = [
        DuctileJoint(a, b, tuple(0.5 * (a.position + b.position)), law, direction=tilt)
        for a, b in itertools.pairwise(bodies)
    ]
    structure = Structure(joints)
    space.add(*joints)
    return structure


def fall(rate: int, iterations: int, *blocks: tuple[float, float], height: float = 0.37, tilt: float = 0.0) -> float:
    """Plastic work [J] of a bar that falls on blocks of the ground, given by their middles and widths."""
    space = new_space(iterations)
    for x, width in blocks:
        left, right = x - 0.5 * width, x + 0.5 * width
        block = pymunk.Poly(space.static_body, [(left, -1.0), (right, -1.0), (right, 0.0), (left, 0.0)])
        block.friction = 0.5
        space.add(block)
    bar = weak_bar(space, height, tilt)
    for _ in range(round(0.2 * rate)):
        space.step(1.0 / rate)
    return float(bar.dissipated.sum())


def bar_on_block(rate: int, iterations: int) -> tuple[float]:
    """A bar falls flat on a block under its middle."""
    return (fall(rate, iterations, (0.0, 0.24)),)


def bar_on_bearings(rate: int, iterations: int) -> tuple[float]:
    """A bar falls flat on blocks under its ends."""
    return (fall(rate, iterations, (-0.44, 0.26), (0.44, 0.26)),)


def loaded_wheel(rate: int, iterations: int) -> tuple[float, float]:
    """Peak and lasting deflection [m] of the cantilever that a wheel of 100 kg falls on by 0.4 m.

    A pivot of pymunk's own hangs 100 kg on its axle.
    """
    space = new_space(iterations)
    beam = assemble(BEAM, SIX, space)
    wheel, load = pymunk.Body(100.0, 0.5 * 100.0 * 0.15**2), pymunk.Body(100.0, 0.5 * 100.0 * 0.1**2)
    wheel.position = load.position = (0.85, 0.05 + 0.4 + 0.15)
    tyre = pymunk.Circle(wheel, 0.15)
    tyre.friction = 1.0
    space.add(wheel, load, tyre, pymunk.PivotJoint(wheel, load, tuple(wheel.position)))
    lowest = 0.0
    for _ in range(round(0.5 * rate)):
        space.step(1.0 / rate)
        lowest = min(lowest, beam.nodes["tip"].now()[1])
    return -lowest, -beam.nodes["tip"].now()[1]


def ball_on_portal(rate: int, iterations: int) -> tuple[float]:
    """Peak deflection [m] of a portal IPE 100 of 3 m by 3 m that a ball of 500 kg falls on."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (0.0, 3.0, "free"), "C": (3.0, 3.0, "free"), "D": (3.0, 0.0, "clamped")}
    space = new_space(iterations)
    space.collision_slop = 0.1
    scene = frame_scene(nodes, [("A", "B"), ("B", "C"), ("D", "C")], "[simulation]\nduration = 1.0", section="IPE 100")
    frame = assemble(scene, Model("lobatto", 6, "fibre", fibres=8, iterations=iterations), space)
    ball = pymunk.Body(500.0, 0.4 * 500.0 * 0.2**2)
    ball.position = (1.5, 3.0 + 0.05 + 0.5 + 0.2)
    space.add(ball, pymunk.Circle(ball, 0.2))
    beam = [span.body for span in frame.spans if span.member == "B-C"]
    lowest = 0.0
    for _ in range(rate):
        space.step(1.0 / rate)
        lowest = max(lowest, *(3.0 - body.position.y for body in beam))
    return (lowest,)
