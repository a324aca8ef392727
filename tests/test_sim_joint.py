"""A joint in a space of one's own: how it is made, and what it says."""

import gc
import itertools
import math
import tracemalloc
from pathlib import Path

import numpy as np
import pymunk
import pytest

import sim
from capacity import InputError, capacity, parse_material, parse_section
from sim import (
    AVERAGE_ACCELERATION,
    LAWS,
    DuctileJoint,
    ElasticPlastic,
    JointArrays,
    Limits,
    RigidPlastic,
    Structure,
    section_law,
)
from sim.kernels import layout as at

STEEL, BAR = parse_material("S235"), parse_section("IPE 200")


def arm(space: pymunk.Space, mass: float, length: float, thickness: float, x: float = 0.0) -> pymunk.Body:
    """A bar from x to x + length."""
    body = pymunk.Body(mass, mass * (length**2 + thickness**2) / 12.0)
    body.position = (x + 0.5 * length, 0.0)
    space.add(body)
    return body


def test_joint_by_frequency_and_largest_elastic_rotation() -> None:
    """The paper's ramp: 1 Hz, damping ratio 0.2, 0.12 rad and 58 320 kg m² give 2.302 MN m/rad and 276.3 kN m."""
    space = pymunk.Space()
    ramp = pymunk.Body(2160.0, 58320.0)
    ramp.position = (51.0, 5.0)
    space.add(ramp)
    joint = DuctileJoint.by_frequency(ramp, space.static_body, (60.0, 5.0), 1.0, 0.2, elastic_rotation=0.12)
    _, _, M_max = joint.law.capacities()
    assert joint.law.elastic_tangent()[5] == pytest.approx(2.302e6, rel=2e-4)
    assert M_max == pytest.approx(276.3e3, rel=2e-4)
    assert joint.damping[2] == pytest.approx(2.0 * 0.2 * 2.302e6 / (2.0 * math.pi), rel=2e-4)
    with pytest.raises(InputError, match="both given"):
        DuctileJoint.by_frequency(
            ramp, space.static_body, (60.0, 5.0), 1.0, 0.2, elastic_rotation=0.1, capacity=(1.0, 1.0, 1.0)
        )
    with pytest.raises(InputError, match="greater than zero"):
        DuctileJoint.by_frequency(ramp, space.static_body, (60.0, 5.0), 0.0, 0.2)


def test_bodies_vibrate_with_the_frequency_and_the_damping_that_were_asked_for() -> None:
    """Two wheels on one pivot turn against each other: period and logarithmic decrement of a damped oscillator."""
    space = pymunk.Space()
    wheels = [pymunk.Body(3.0, moment) for moment in (2.0, 5.0)]
    space.add(*wheels)
    joint = DuctileJoint.by_frequency(*wheels, (0.0, 0.0), 2.0, 0.05, direction=0.0, scheme=AVERAGE_ACCELERATION)
    space.add(joint)
    wheels[0].angular_velocity, wheels[1].angular_velocity = 0.5, -0.2  # no momentum
    h, turned = 1.0 / 400.0, []
    for _ in range(1200):
        space.step(h)
        turned.append(wheels[1].angle - wheels[0].angle)
    angle = np.array(turned)
    falls = np.flatnonzero((angle[:-1] > 0.0) & (angle[1:] <= 0.0))
    crossings = h * (falls + angle[falls] / (angle[falls] - angle[falls + 1]))
    damped = 2.0 * math.sqrt(1.0 - 0.05**2)
    assert 1.0 / np.diff(crossings).mean() == pytest.approx(damped, rel=2e-3)
    peaks = [angle[a:b].max() for a, b in itertools.pairwise(falls)]
    decrement = np.log(np.array(peaks[:-1]) / peaks[1:]).mean()
    assert decrement == pytest.approx(2.0 * math.pi * 0.05 / math.sqrt(1.0 - 0.05**2), rel=0.02)


@pytest.mark.parametrize("name", LAWS)
def test_laws_by_name_bear_what_their_section_bears(name: str) -> None:
    c = capacity(BAR, STEEL)
    law = section_law(name, BAR, STEEL, 0.2)
    assert law.name == name
    assert law.capacities() == pytest.approx((c.N_max, c.Q_max, c.M_max), rel=2e-3)
    if name != "rigid-plastic":
        assert law.elastic_tangent()[5] == pytest.approx(c.EI / 0.2, rel=1e-9)


def test_unknown_law_is_refused() -> None:
    with pytest.raises(ValueError, match="there is no joint law"):
        section_law("rubber", BAR, STEEL, 0.2)


def loaded(law_name: str, moment: float, damping: float = 0.0) -> tuple[pymunk.Space, DuctileJoint]:
    """An arm on a joint of a length of 0.2 m at the ground, under a moment that grows to its size and stays."""
    space = pymunk.Space()
    body = arm(space, 20.0, 1.0, 0.1)
    law = section_law(law_name, BAR, STEEL, 0.2)
    k = law.elastic_tangent()
    joint = DuctileJoint(
        space.static_body,
        body,
        (0.0, 0.0),
        law,
        direction=0.0,
        damping=(damping * k[0], damping * k[3], damping * k[5]),
    )
    space.add(joint)
    for i in range(240):
        body.torque = moment * min(1.0, i / 120.0)
        space.step(1.0 / 240.0)
    return space, joint


@pytest.mark.parametrize("damping", [0.0, 1e-3])
def test_an_elastic_joint_says_what_it_bears_and_that_nothing_yields(damping: float) -> None:
    c = capacity(BAR, STEEL)
    _, joint = loaded("elastic-plastic", -0.5 * c.M_max, damping)
    N, Q, M = joint.force
    # The ground's joint holds the arm: what turns the arm clockwise bends it so that b is turned clockwise.
    assert pytest.approx(-0.5 * c.M_max, rel=1e-3) == M
    assert max(abs(N), abs(Q)) < 1e-3 * c.Q_max
    assert joint.utilisation[2] == pytest.approx(0.5, rel=1e-3)
    assert joint.elastic_deformation == pytest.approx(joint.deformation, rel=1e-6, abs=1e-9)
    assert joint.deformation[2] == pytest.approx(-0.5 * c.M_max * 0.2 / c.EI, rel=1e-3)
    assert (joint.active_limit, joint.dissipated, joint.broken) == ("", 0.0, False)


@pytest.mark.parametrize(
    ("name", "limits"),
    [
        ("rigid-plastic", {"M"}),
        # Stopped at once by 78 kN, the bar rings on its shear stiffness up to nearly twice that: 145.5 kN are Q_max.
        ("elastic-plastic", {"M", "Q+M"}),
        ("interaction", {"N-Q-M"}),
        ("fibre", {"fibres"}),
    ],
)
def test_a_joint_that_yields_says_by_what(name: str, limits: set[str]) -> None:
    c = capacity(BAR, STEEL)
    space, joint = loaded(name, 0.0)
    joint.b.torque = 0.0
    joint.b.angular_velocity, joint.b.velocity = 30.0, (0.0, 15.0)
    found = set()
    for _ in range(400):
        space.step(1.0 / 10000.0)
        found.add(joint.active_limit)
    assert found == {""} | limits
    elastic, total = np.array(joint.elastic_deformation), np.array(joint.deformation)
    arrays = JointArrays([joint])
    np.testing.assert_allclose(arrays.residual_deformation[0], total - elastic, atol=1e-12)
    assert arrays.residual_deformation[0, 2] > 1e-3
    # What moved is stopped by plastic work, but for what still swings and what implicit Euler damps.
    before = 0.5 * 30.0**2 * (joint.b.moment + joint.b.mass * 0.5**2)
    assert joint.dissipated <= before
    assert joint.dissipated > 0.5 * before
    assert joint.dissipated == pytest.approx(c.M_max * arrays.residual_deformation[0, 2], rel=0.1)


def test_arrays_over_joints_of_several_structures_and_a_broken_one() -> None:
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    strong, weak = ElasticPlastic((1e8, 1e8, 1e6), (1e6, 1e6, 1e4)), RigidPlastic((1e6, 1e6, 10.0))
    joints = []
    for x, law in ((0.0, strong), (5.0, weak), (10.0, strong)):
        body = arm(space, 20.0, 1.0, 0.1, x)
        limits = Limits(rotation=0.05 if law is weak else math.inf)
        joints.append(DuctileJoint(space.static_body, body, (x, 0.0), law, direction=0.0, limits=limits))
    stock = pymunk.PivotJoint(space.static_body, joints[0].b, (1.0, 0.0))
    arrays = JointArrays([*joints, stock])
    assert arrays.joints == tuple(joints)
    assert not arrays.force.any()
    assert arrays.active_limit == ("", "", "")
    space.add(*joints)
    for _ in range(120):
        space.step(1.0 / 120.0)
    assert arrays.broken.tolist() == [False, True, False]
    assert arrays.active_limit == ("", "broken", "")
    assert not arrays.force[1].any()
    moment = -20.0 * 9.81 * 0.5  # own weight pulls b down, clockwise
    assert arrays.force[[0, 2], 2] == pytest.approx([moment, moment], rel=1e-3)
    assert arrays.capacity_used.tolist() == [0.0, 1.0, 0.0]
    assert arrays.dissipated[1] == pytest.approx(10.0 * 0.05, rel=0.05)


@pytest.mark.parametrize("shared", [True, False])
def test_a_joint_takes_less_than_two_kilobytes(shared: bool) -> None:
    """All that `sim` keeps for a joint of a chain, without what pymunk keeps for any constraint and for bodies."""
    count, numbers = 1000, itertools.count(1)

    def law() -> ElasticPlastic:
        m_max = 1e3 * (1.0 if shared else float(next(numbers)))
        return ElasticPlastic((1e6, 1e6, 1e4), (1e4, 1e4, m_max))

    one = law()
    space = pymunk.Space()
    bodies = [space.static_body, *(pymunk.Body(1.0, 1.0) for _ in range(count))]
    for i, body in enumerate(bodies[1:]):
        body.position = (i + 0.5, 0.0)
    own = str(Path(sim.__file__).parent / "*")
    gc.collect()
    tracemalloc.start()
    try:
        joints = [
            DuctileJoint(a, b, (float(i), 0.0), one if shared else law())
            for i, (a, b) in enumerate(itertools.pairwise(bodies))
        ]
        structure = Structure(joints)
        gc.collect()
        taken = tracemalloc.take_snapshot().filter_traces(
            [tracemalloc.Filter(inclusive=True, filename_pattern=name) for name in (own, __file__)]
        )
    finally:
        tracemalloc.stop()
    arrays = sum(structure.tables[word].nbytes for word in (at.RESULT, at.GRADIENT, at.LOWER_BLOCKS))
    assert arrays < sum(trace.size for trace in taken.traces) < 2000 * count


@pytest.mark.parametrize("at", [(0.0, 0.0), (3.0, 5.0)])
@pytest.mark.parametrize("first", [True, False])
def test_the_axis_of_a_joint_to_the_ground_runs_along_the_bar(at: tuple[float, float], first: bool) -> None:
    """A bar that lies to the right of where it is held bears its weight as shear, wherever the ground's origin is."""
    space = pymunk.Space()
    space.gravity = (0.0, -9.81)
    bar = pymunk.Body(2.0, 1.0)
    bar.position = at + pymunk.Vec2d(0.5, 0.0)
    bodies = (space.static_body, bar) if first else (bar, space.static_body)
    joint = DuctileJoint(*bodies, at, ElasticPlastic((1e8, 1e8, 1e6), (1e6, 1e6, 1e6)))
    space.add(bar, joint)
    for _ in range(60):
        space.step(1 / 60)
    N, Q, M = joint.force
    # From the bar to the ground x runs to the left, and what is cut off in front of it is the bar.
    assert abs(N) < 1e-3
    assert pytest.approx(-2.0 * 9.81, rel=1e-3) == Q
    assert pytest.approx(-9.81 if first else 9.81, rel=1e-3) == M
