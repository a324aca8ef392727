"""The structure as one Chipmunk constraint: against its plain twin, statics, and conservation laws."""

import itertools
import math

import numpy as np
import pymunk
import pytest
from cantilevers import cantilever
from hypothesis import given
from hypothesis import strategies as st
from twin import Twin

import sim
from sim import ElasticPlastic, Joint, Model, SolverError, Structure
from sim.chipmunk import IncompatiblePymunk, verify


def piece(space: pymunk.Space, mass: float, moment: float, x: float, y: float, angle: float = 0.0) -> pymunk.Body:
    body = pymunk.Body(mass, moment)
    body.position, body.angle = (x, y), angle
    space.add(body)
    return body


def portal(law: ElasticPlastic, clamped: bool = True) -> tuple[pymunk.Space, list[pymunk.Body], Structure]:
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
        Joint(a, b, tuple(at), math.atan2(-at[0], at[1]), law)
        for a, b, at in zip(ends[:-1], ends[1:], spots, strict=True)
    ]
    joints.append(Joint(bodies[1], bodies[5], (0.0, 0.7), 0.0, law))
    structure = Structure(joints)
    space.add(structure)
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
        anchors=np.array([structure.anchors(i) for i in range(len(structure.joints))]),
        rest=np.array([(j.direction - j.a.angle, j.direction - j.b.angle) for j in structure.joints]),
        turn=np.array([j.turn for j in structure.joints]),
        stiffness=np.array([j.law.stiffness for j in structure.joints]),
        cap=np.array([j.law.capacity for j in structure.joints]),
    )


@pytest.mark.parametrize("cap", [1e9, 150.0], ids=["elastic", "yielding"])
@pytest.mark.parametrize("scheme", [(0.0, 1.0), (0.25, 0.0), (0.25, 0.02)])
def test_kernel_agrees_with_its_plain_twin(scheme: tuple[float, float], cap: float) -> None:
    """A looped frame that is thrown about: same velocities, forces and deformations as in numpy, to rounding."""
    law = ElasticPlastic((2e6, 1e6, 3e4), (cap, cap, 0.2 * cap))
    space, bodies, plain_order = portal(law)
    space.remove(plain_order)
    structure = Structure(plain_order.joints, *scheme)
    space.add(structure)
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
    last = len(assembly.structure.joints) - 1
    assembly.structure.change_law(last, ElasticPlastic((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    for _ in range(round(4.0 / dt)):
        assembly.space.step(dt)
    sag = -assembly.pushed_point()[1]
    assert sag == pytest.approx(7850 * 9.81 * 0.005 / (8 * 875000.0), rel=1e-3)
    assert assembly.structure.unconverged == 0


def test_equal_pieces_sag_by_the_trapezoidal_rule() -> None:
    """1 + 1/n² of the exact sag for n equal pieces with a half cell at the root."""
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.01, gravity=9.81)
    assembly = sim.assemble(scene, Model("equal", 6, "elastic-plastic"))
    last = len(assembly.structure.joints) - 1
    assembly.structure.change_law(last, ElasticPlastic((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    for _ in range(240):
        assembly.space.step(1 / 60)
    exact = 7850 * 9.81 * 0.005 / (8 * 875000.0)
    assert -assembly.pushed_point()[1] == pytest.approx(exact * (1 + 1 / 25), rel=2e-3)


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

    def momenta() -> np.ndarray:
        p = sum(b.mass * np.array(b.velocity) for b in bodies)
        spin = sum(b.mass * b.position.cross(b.velocity) + b.moment * b.angular_velocity for b in bodies)
        return np.array([*p, spin])

    scale = sum(b.mass * (b.velocity.length + 1.0) * (b.position.length + 1.0) for b in bodies)
    before = momenta()
    for _ in range(20):
        space.step(dt)
        after = momenta()
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
    assert structure.dissipated.sum() > 0.0
    assert structure.dissipated.min() >= 0.0


@pytest.mark.parametrize("law", ["elastic-plastic", "fibre"])
def test_many_iterations_change_nothing(law: str) -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.05)
    distances = np.linspace(0.0, 0.05, 61)
    few, many = (sim.push_over(scene, Model("lobatto", 5, law, iterations=i), distances) for i in (2, 30))
    np.testing.assert_allclose(few.load, many.load, rtol=1e-6, atol=1e-3)


def test_a_non_finite_state_is_refused() -> None:
    space, bodies, structure = portal(ElasticPlastic((1e6, 1e6, 1e4), (1e9, 1e9, 1e9)))
    structure.check()
    bodies[2].velocity = (1e308, 1e308)
    space.step(1.0)
    with pytest.raises(SolverError, match="finite"):
        structure.check()


def test_bad_structures_are_refused() -> None:
    with pytest.raises(ValueError, match="at least one joint"):
        Structure([])
    space = pymunk.Space()
    law = ElasticPlastic((1.0, 1.0, 1.0), (1.0, 1.0, 1.0))
    with pytest.raises(ValueError, match="no dynamic body"):
        Structure([Joint(space.static_body, pymunk.Body(body_type=pymunk.Body.KINEMATIC), (0, 0), 0.0, law)])
    body = piece(space, 1.0, 1.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="stiffness that is not finite"):
        Structure([Joint(space.static_body, body, (0, 0), 0.0, ElasticPlastic((math.nan, 1, 1), (1, 1, 1)))])


def test_removed_structure_lets_go() -> None:
    space, bodies, structure = portal(ElasticPlastic((1e6, 1e6, 1e4), (1e9, 1e9, 1e9)))
    space.remove(structure)
    space.gravity = (0.0, -10.0)
    space.step(0.1)
    assert bodies[3].velocity.y == pytest.approx(-1.0)


def test_verify_notices_another_layout(monkeypatch: pytest.MonkeyPatch) -> None:
    verify()
    monkeypatch.setattr("sim.chipmunk.SPIN", 13)
    with pytest.raises(IncompatiblePymunk, match="install version"):
        verify()


def test_same_input_same_bytes() -> None:
    scene = cantilever("rectangle 50x100 mm", 1.0, 0.05)
    distances = np.linspace(0.0, 0.05, 61)
    runs = [sim.push_over(scene, Model("lobatto", 6, "fibre"), distances) for _ in range(2)]
    assert runs[0].load.tobytes() == runs[1].load.tobytes()
    assert runs[0].displacement.tobytes() == runs[1].displacement.tobytes()
