"""The structure as one Chipmunk constraint: against its plain twin, statics, and conservation laws."""

import itertools
import math

import numpy as np
import pymunk
import pytest
from bodies import piece
from cantilevers import cantilever
from hard_cases import momenta
from hypothesis import given
from hypothesis import strategies as st
from twin import Twin

import sim
from sim import AVERAGE_ACCELERATION, DuctileJoint, ElasticPlastic, Model, SolverError, Structure


def portal(
    law: ElasticPlastic, clamped: bool = True, scheme: tuple[float, float] = (0.0, 1.0)
) -> tuple[pymunk.Space, list[pymunk.Body], Structure]:
    """Seven bars in an arch with a tie across it, so that the graph has a loop."""
    space = pymunk.Space()
    space.iterations = 2
    angles = np.linspace(math.pi, 0.0, 8)
    points = np.column_stack([np.cos(angles), np.sin(angles)])
    bodies = []
    for (x0, y0), (x1, y1) in itertools.pairwise(points):
        bodies.append(piece(space, 2.0, 0.05, (x0 + x1) / 2, (y0 + y1) / 2, math.atan2(y1 - y0, x1 - x0)))
    ends = [space.static_body, *bodies, space.static_body] if clamped else bodies
    spots = points if clamped else points[1:-1]
    joints = [
        DuctileJoint(a, b, tuple(at), law, direction=math.atan2(-at[0], at[1]), length=0.4, scheme=scheme)
        for a, b, at in zip(ends[:-1], ends[1:], spots, strict=True)
    ]
    joints.append(DuctileJoint(bodies[1], bodies[5], (0.0, 0.7), law, direction=0.0, scheme=scheme))
    structure = Structure(joints)
    space.add(*joints)
    return space, bodies, structure


def twin_of(structure: Structure) -> Twin:
    bodies = structure.bodies
    index = {body: i for i, body in enumerate(bodies)}
    state = [(b.position.x, b.position.y, b.angle, b.velocity.x, b.velocity.y, b.angular_velocity) for b in bodies]
    rows = np.array(state)
    return Twin(
        position=rows[:, :3],
        velocity=rows[:, 3:],
        mass=np.array([(b.mass, b.mass, b.moment) for b in bodies]),
        ends=np.array([(index[j.a], index[j.b]) for j in structure.joints]),
        anchors=np.array([j.geometry[:4] for j in structure.joints]).reshape(-1, 2, 2),
        rest=np.array([j.geometry[4:6] for j in structure.joints]),
        turn=np.array([j.turn for j in structure.joints]),
        arc=np.array([j.geometry[11] for j in structure.joints]),
        stiffness=np.array([j.law.stiffness for j in structure.joints]),
        cap=np.array([j.law.capacity for j in structure.joints]),
    )


@pytest.mark.parametrize("cap", [1e9, 150.0], ids=["elastic", "yielding"])
@pytest.mark.parametrize("scheme", [(0.0, 1.0), (0.25, 0.0), (0.25, 0.02)])
def test_kernel_agrees_with_its_plain_twin(scheme: tuple[float, float], cap: float) -> None:
    """A looped frame that is thrown about: same velocities, forces and deformations as in numpy, to rounding."""
    law = ElasticPlastic((2e6, 1e6, 3e4), (cap, cap, 0.2 * cap))
    space, bodies, structure = portal(law, scheme=scheme)
    # The twin knows whole steps only.
    structure.whole_steps_only = True
    twin = twin_of(structure)
    twin.beta, twin.delta = scheme
    space.gravity = (0.0, -9.81)
    weight = np.array(
        [(0.0, -9.81 * b.mass, 0.0) if b.body_type == pymunk.Body.DYNAMIC else (0, 0, 0) for b in structure.bodies]
    )
    bodies[3].velocity = (4.0, -2.0)
    twin.velocity[structure.bodies.index(bodies[3])] = (4.0, -2.0, 0.0)
    yielded = False
    for _ in range(40):
        space.step(1e-3)
        twin.step(1e-3, weight)
        ours = np.array([(*b.velocity, b.angular_velocity) for b in structure.bodies])
        np.testing.assert_allclose(ours, twin.velocity, rtol=1e-7, atol=1e-7)
        np.testing.assert_allclose(
            structure.force, twin.force, rtol=1e-6, atol=1e-4 * max(1.0, np.abs(twin.force).max())
        )
        yielded |= bool(np.abs(twin.slip).max() > 1e-4)
    assert yielded == (cap < 1e6)
    assert structure.unconverged == 0


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240, 1 / 1000])
@pytest.mark.parametrize(("rule", "joints"), [("lobatto", 3), ("lobatto", 6), ("lobatto", 8)])
def test_sag_under_own_weight_is_exact(rule: str, joints: int, dt: float) -> None:
    """q L⁴ / 8 EI at the tip of a cantilever, within 0.1 %, at any step, with two iterations."""
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.01, gravity=9.81)
    assembly = sim.assemble(scene, Model(rule, joints, "fibre", dt=dt, iterations=2))
    for _ in range(round(4.0 / dt)):
        assembly.space.step(dt)
    sag = -assembly.nodes["tip"].now()[1]
    assert sag == pytest.approx(7850 * 9.81 * 0.005 / (8 * 875000.0), rel=1e-3)
    assert assembly.structure.unconverged == 0


def test_equal_pieces_sag_by_the_trapezoidal_rule() -> None:
    """1 + 1/n² of the exact sag for n equal pieces with a half cell at the root."""
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.01, gravity=9.81)
    assembly = sim.assemble(scene, Model("equal", 6, "elastic-plastic"))
    for _ in range(240):
        assembly.space.step(1 / 60)
    exact = 7850 * 9.81 * 0.005 / (8 * 875000.0)
    assert -assembly.nodes["tip"].now()[1] == pytest.approx(exact * (1 + 1 / 25), rel=2e-3)


@given(
    velocities=st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50), st.floats(-30, 30)), min_size=7, max_size=7),
    cap=st.sampled_from([10.0, 1e3, 1e9]),
    dt=st.sampled_from([1 / 30, 1 / 60, 1e-3]),
)
def test_free_structure_keeps_its_momenta(velocities: list[tuple[float, float, float]], cap: float, dt: float) -> None:
    """Linear and angular momentum of a free structure, to rounding, however hard its joints yield."""
    space, bodies, _ = portal(ElasticPlastic((1e6, 1e6, 1e4), (cap, cap, 0.1 * cap)), clamped=False)
    for body, (vx, vy, w) in zip(bodies, velocities, strict=True):
        body.velocity, body.angular_velocity = (vx, vy), w

    scale = sum(b.mass * (b.velocity.length + 1.0) * (b.position.length + 1.0) for b in bodies)
    before, _ = momenta(bodies)
    for _ in range(20):
        space.step(dt)
        after, _ = momenta(bodies)
        reach = max(b.position.length for b in bodies) + 1.0
        assert np.abs(after - before).max() <= 1e-12 * scale * reach
        before = after


def test_perfectly_plastic_forces_stay_within_their_caps() -> None:
    space, bodies, structure = portal(ElasticPlastic((1e7, 1e7, 1e5), (500.0, 300.0, 40.0)))
    space.gravity = (0.0, -9.81)
    bodies[3].velocity = (30.0, -40.0)
    for _ in range(100):
        space.step(1 / 240)
        assert np.all(np.abs(structure.force) <= np.array([500.0, 300.0, 40.0]) * (1.0 + 1e-6))
        assert structure.utilisation.max() <= 1.0 + 1e-6
    assert structure.utilisation.max(axis=0) == pytest.approx(
        np.abs(structure.force / [500.0, 300.0, 40.0]).max(axis=0)
    )
    assert structure.joints[0].utilisation == tuple(structure.utilisation[0].tolist())
    assert structure.dissipated.sum() > 0.0
    assert structure.dissipated.min() >= 0.0


@pytest.mark.parametrize("law", ["elastic-plastic", "fibre"])
def test_many_iterations_change_nothing(law: str) -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.05)
    distances = np.linspace(0.0, 0.05, 61)
    few, many = (sim.push_over(scene, Model("lobatto", 5, law, iterations=i), distances) for i in (2, 30))
    np.testing.assert_allclose(few.load, many.load, rtol=1e-6, atol=1e-3)


def test_a_step_that_is_not_finite_is_refused() -> None:
    """The error names the joint and a cure; bodies and joints are as before the step, and go on from there."""
    space, bodies, structure = portal(ElasticPlastic((1e6, 1e6, 1e4), (1e9, 1e9, 1e9)))
    space.gravity = (0.0, -9.81)
    for _ in range(10):
        space.step(1 / 60)
    before = [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in bodies]
    force = structure.force
    bodies[2].force = (1e308, 1e308)
    with pytest.raises(SolverError, match=r"joint \d .*not finite.*shorter step"):
        space.step(10.0)
    after = [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in bodies]
    np.testing.assert_allclose(after, before, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(structure.force, force)
    space.step(1 / 60)
    np.testing.assert_allclose(structure.force, force, rtol=0.05, atol=1.0)


def test_bad_joints_are_refused() -> None:
    with pytest.raises(ValueError, match="at least one joint"):
        Structure([])
    space = pymunk.Space()
    law = ElasticPlastic((1.0, 1.0, 1.0), (1.0, 1.0, 1.0))
    with pytest.raises(ValueError, match="needs a dynamic body"):
        DuctileJoint(space.static_body, pymunk.Body(body_type=pymunk.Body.KINEMATIC), (0, 0), law)
    body = piece(space, 1.0, 1.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="place is not finite"):
        DuctileJoint(space.static_body, body, (0, math.inf), law)
    mixed = [
        DuctileJoint(space.static_body, body, (0, 0), law),
        DuctileJoint(space.static_body, body, (1, 0), law, scheme=AVERAGE_ACCELERATION),
    ]
    with pytest.raises(ValueError, match="give both the same scheme="):
        Structure(mixed)


def test_removed_joints_let_go() -> None:
    space, bodies, structure = portal(ElasticPlastic((1e6, 1e6, 1e4), (1e9, 1e9, 1e9)))
    space.remove(*structure.joints[:4])
    space.gravity = (0.0, -10.0)
    space.step(0.1)
    assert bodies[0].velocity.y == pytest.approx(-1.0)
    assert bodies[5].velocity.y == pytest.approx(0.0, abs=0.2)
    space.remove(*structure.joints[4:])
    space.step(0.1)
    assert bodies[5].velocity.y < -0.9


def test_viscous_damping_takes_its_own_share_of_the_energy() -> None:
    """A damped oscillator with a damping ratio of 5 %, integrated without numerical damping."""
    space = pymunk.Space()
    body = piece(space, 2.0, 1.0, 0.0, 0.0)
    stiffness, ratio = 800.0, 0.05
    omega = math.sqrt(stiffness / 2.0)
    law = ElasticPlastic((stiffness, 1e6, 1e6), (1e9, 1e9, 1e9))
    joint = DuctileJoint(
        space.static_body,
        body,
        (0.0, 0.0),
        law,
        direction=0.0,
        damping=(2.0 * ratio * 2.0 * omega, 0.0, 0.0),
        scheme=AVERAGE_ACCELERATION,
    )
    space.add(joint)
    body.velocity = (1.0, 0.0)
    dt = 2.0 * math.pi / omega / 200.0
    for _ in range(2000):
        space.step(dt)
    decay = math.exp(-2.0 * ratio * omega * 2000 * dt)
    left = 0.5 * body.kinetic_energy + joint.structure.elastic_energy[0]
    # pymunk's kinetic energy is m v² + I ω², without the half.
    assert left == pytest.approx(decay, rel=0.1)
    assert joint.structure.viscous_work[0] == pytest.approx(1.0 - decay, rel=0.02)


def test_same_input_same_bytes() -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.05)
    distances = np.linspace(0.0, 0.05, 61)
    runs = [sim.push_over(scene, Model("lobatto", 6, "fibre"), distances) for _ in range(2)]
    assert runs[0].load.tobytes() == runs[1].load.tobytes()
    assert runs[0].displacement.tobytes() == runs[1].displacement.tobytes()


def test_a_motion_that_dies_away_ends() -> None:
    """Across a beam at y = 0 no rounding stops it; it is not to end in numbers too small for processors to be fast."""
    space, before = pymunk.Space(), None
    for i in range(3):
        body = pymunk.Body(1.0, 0.1)
        body.position = (i + 0.5, 0.0)
        law = ElasticPlastic((1e7, 1e7, 1e6), (1e6, 1e6, 1e6))
        space.add(body, DuctileJoint(before or space.static_body, body, (float(i), 0.0), law, direction=0.0))
        before = body
    body.velocity = (0.0, 0.1)
    for _ in range(500):
        space.step(1 / 60)
    assert all(body.velocity.y == 0.0 and body.angular_velocity == 0.0 for body in space.bodies)
    assert all(1e-60 < abs(body.position.y) < 1e-30 for body in space.bodies)
