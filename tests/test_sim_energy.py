"""The ledger: every entry against what it is to be, and the sum of all to rounding."""

import itertools
import math

import pymunk
import pytest
from bodies import kinetic, spring
from hard_cases import MASS, PIECE, Case, chain, largest, law, rests

from sim import DuctileJoint, ElasticPlastic, Energy, Limits, Structure, energy
from sim.kernels import layout as at


def check(case: Case) -> Energy:
    """Ledger of a case after its steps, closed and without energy from nowhere in each of them."""
    done = 0.0
    for step in range(case.steps):
        case.act(step)
        case.space.step(case.dt)
        now, structure = case.structure.energy, case.structure
        assert abs(now.gap) <= 1e-12 * largest(now)
        assert now.numerical >= -1e-12 * largest(now)
        assert now.kinetic == pytest.approx(kinetic(case.bodies[: len(structure.bodies)]), rel=1e-12, abs=1e-20)
        # The ledger stands in the middle of a move, the joints at its end; in parts that is the last part's.
        end = structure.dissipated.sum()
        if structure.tables.control[at.PARTS] == 1:
            assert now.plastic == pytest.approx(0.5 * (done + end), rel=1e-9, abs=1e-20)
        else:
            assert 0.5 * (done + end) * (1.0 - 1e-9) <= now.plastic <= end * (1.0 + 1e-9)
        done = structure.dissipated.sum()
    return case.structure.energy


def test_a_load_that_stays_works_along_its_way_and_half_of_it_is_stored() -> None:
    space, body, joint = spring(1e4, 1e9)
    for _ in range(2000):
        body.force = (50.0, 0.0)
        space.step(1 / 100)
    found, way = joint.structure.energy, 50.0 / 1e4
    assert found.external == pytest.approx(50.0 * way, rel=1e-9)
    assert found.elastic == pytest.approx(0.5 * 50.0 * way, rel=1e-9)
    assert found.numerical == pytest.approx(0.5 * 50.0 * way, rel=1e-9)
    assert found.plastic == found.contact == found.viscous == 0.0


def test_an_impulse_brings_its_kinetic_energy_and_a_plastic_joint_takes_it() -> None:
    """300 J into a joint that yields at 1 kN: all but its elastic share becomes plastic work."""
    space, body, joint = spring(1e7, 1000.0, mass=6.0)
    body.velocity = (10.0, 0.0)
    space.step(1e-3)
    assert joint.structure.energy.external == pytest.approx(300.0, rel=1e-12)
    for _ in range(500):
        space.step(1e-3)
    found = joint.structure.energy
    assert found.external == pytest.approx(300.0, rel=1e-12)
    assert found.plastic == pytest.approx(300.0, rel=0.02)
    assert 0.0 <= found.numerical <= 0.02 * 300.0


def test_a_moved_body_works_on_the_structure() -> None:
    """A kinematic body that pulls by 5 mm: its work, in steps of 1 mm s⁻¹, is what the joint stores."""
    space, body, _ = spring(0.0, 0.0)
    driver = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    pull = DuctileJoint(driver, body, (0.0, 0.0), ElasticPlastic((1e5, 1e5, 1e5), (1e9, 1e9, 1e9)), direction=0.0)
    hold = DuctileJoint(
        space.static_body, body, (0.0, 0.0), ElasticPlastic((1e5, 1e5, 1e5), (1e9, 1e9, 1e9)), direction=0.0
    )
    space.add(driver, pull, hold)
    driver.velocity = (0.001, 0.0)
    for _ in range(5000):
        space.step(1e-3)
    driver.velocity = (0.0, 0.0)
    for _ in range(500):
        space.step(1e-3)
    found = pull.structure.energy
    assert found.elastic == pytest.approx(0.5 * 5e4 * 0.005**2, rel=1e-2)
    assert found.external == pytest.approx(found.elastic, rel=1e-2)


def test_moving_a_body_by_hand_is_external_work() -> None:
    space, body, joint = spring(1e4, 1e9)
    space.step(1e-3)
    body.position = (0.01, 0.0)
    for _ in range(3):
        space.step(1e-3)
        assert abs(joint.structure.energy.gap) <= 1e-14
    assert joint.structure.energy.external == pytest.approx(1e4 * 0.01**2, rel=0.1)
    assert joint.structure.energy.numerical >= 0.0


@pytest.mark.parametrize("strength", [1.0, 1e-3], ids=["elastic", "folding"])
def test_pushing_and_falling(strength: float) -> None:
    case = chain(12, law(strength=strength))
    case.steps = 100
    found = check(case)
    assert (found.plastic > 0.0) == (strength < 1.0)


def test_friction_and_impact_are_lost_to_contact() -> None:
    """A bar slides on the ground until it stops: all it had goes to friction."""
    case = chain(5, clamped=False, shapes=True)
    ground = pymunk.Segment(case.space.static_body, (-5.0, -1.05), (50.0, -1.05), 1.0)
    ground.friction = 0.8
    case.space.add(ground)
    case.dt, case.steps = 1 / 240, 200
    for body in case.bodies:
        body.velocity = (2.0, 0.0)
    found = check(case)
    assert found.kinetic <= 1e-6
    moved = 0.5 * 5 * 3.12 * 2.0**2
    assert found.contact == pytest.approx(moved, rel=0.02)
    assert found.external == pytest.approx(moved, rel=0.02)


def test_a_loose_body_that_hits_loses_what_the_structure_gets() -> None:
    """What a box gives up is the structure's external work, but for its own share of the time integration's loss."""
    case = rests(200.0, 3.12)
    box = next(b for b in case.space.bodies if b not in case.bodies)
    box.position, box.velocity = (0.7, 0.0505 + 0.05), (0.0, -3.0)
    case.space.gravity, case.dt, case.steps = (0.0, 0.0), 1 / 20000, 2000
    before = 0.5 * box.kinetic_energy
    found = check(case)
    assert found.external == pytest.approx(before - 0.5 * box.kinetic_energy, rel=0.02)
    assert found.contact > 0.0


def test_a_torn_structure_closes_and_its_parts_begin_with_what_they_have() -> None:
    case = chain(8, law(strength=0.005), clamped=False, gravity=0.0, limits=Limits(rotation=0.02))
    case.bodies[0].velocity = (0.0, 40.0)
    first, broke = case.structure, False
    for _ in range(200):
        case.space.step(1 / 4000)
        joints = [joint for joint in first.joints if not joint.broken]
        for structure in {joint.structure for joint in joints}:
            assert abs(structure.energy.gap) <= 1e-12 * largest(structure.energy)
            assert structure.energy.numerical >= -1e-12 * largest(structure.energy)
        broke |= any(joint.broken for joint in first.joints)
    assert broke
    together = energy(case.space)
    parts = {joint.structure for joint in case.space.constraints}
    assert together.kinetic == pytest.approx(sum(part.energy.kinetic for part in parts), rel=1e-12)


def test_light_links_under_a_heavy_load_swing_and_do_not_whip() -> None:
    """1000 kg on a cord of twenty links of 0.1 kg let go at 90°: at the bottom v² = 2 g L, at any step."""
    for dt in (1 / 60, 1 / 240, 1 / 1000):
        case = chain(20, law(strength=1e12, bending=0.0), mass=0.1, tip=1000.0)
        tip, fastest = case.bodies[-1], 0.0
        for _ in range(round(1.2 / dt)):
            case.space.step(dt)
            fastest = max(fastest, tip.velocity.length)
        way = 20 * PIECE - 0.5 * PIECE
        # Implicit, so damped: by ωh/2 with ω = √(g/L), and least where the step is short.
        assert fastest <= 1.001 * math.sqrt(2.0 * 9.81 * way)
        assert fastest >= (1.0 - 8.0 * dt) * math.sqrt(2.0 * 9.81 * way)


def test_ledgers_add_up() -> None:
    one = Energy(external=3.0, kinetic=1.0, numerical=2.0)
    both = one + Energy(external=1.0, plastic=1.0)
    assert both == Energy(external=4.0, kinetic=1.0, plastic=1.0, numerical=2.0)
    assert both.gap == 0.0


def test_a_structure_built_of_moving_bodies_brings_their_energy() -> None:
    case = chain(4, clamped=False, gravity=0.0)
    for body in case.bodies:
        body.velocity = (3.0, 0.0)
    case.space.step(1 / 60)
    again = Structure(case.structure.joints)
    assert again.energy.external == pytest.approx(0.5 * 4 * 3.12 * 9.0, rel=1e-12)
    case.space.step(1 / 60)
    assert abs(again.energy.gap) <= 1e-12 * again.energy.external


def test_a_support_that_sinks_works_while_a_blow_is_taken_in_parts() -> None:
    """As much as its force times its way, in every step; a crate lies on the beam that it bends."""
    space = pymunk.Space()
    space.gravity, space.collision_slop = (0.0, -9.81), 1e-3
    sinking = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    sinking.position = (2.0, 0.0)
    pieces = [pymunk.Body(4.0, 4.0 * 0.5**2 / 12.0) for _ in range(4)]
    held = [space.static_body, *pieces, sinking]
    law = ElasticPlastic((1e7, 1e7, 1e5), (1e5, 1e5, 3e3))
    for i, piece in enumerate(pieces):
        piece.position = (0.25 + 0.5 * i, 0.0)
        space.add(piece, pymunk.Poly.create_box(piece, (0.5, 0.1)))
    joints = [DuctileJoint(a, b, (0.5 * i, 0.0), law) for i, (a, b) in enumerate(itertools.pairwise(held))]
    for shape in space.shapes:
        shape.filter = pymunk.ShapeFilter(group=1)
    crate = pymunk.Body(20.0, 1.0)
    crate.position = (1.0, 0.6)
    space.add(sinking, crate, pymunk.Poly.create_box(crate, (0.4, 0.4)), *joints)
    worked, blows = 0.0, 0
    for _ in range(120):
        sinking.velocity = (0.0, -0.05)
        space.step(1 / 60)
        assert joints[-1].structure is not None
        worked += joints[-1].force[1] * -0.05 / 60.0
        blows += joints[-1].structure.energy.contact > 0.0
    found = energy(space)
    assert blows > 50
    assert found.plastic > 50.0
    assert found.numerical >= 0.0
    # What else works on the structure is its own weight and the crate's: no more than both along the way sunk.
    assert worked <= found.external <= worked + 36.0 * 9.81 * 0.1 + 20.0 * 9.81 * 0.4


@pytest.mark.parametrize("stiffness", [1e3, 1e9])
def test_damping_takes_no_more_than_there_was(stiffness: float) -> None:
    """A thrown body is stopped within a step by far too much damping, and by a stiff joint beside it."""
    space, body, joint = spring(stiffness, 1e12, damping=1e5)
    body.velocity = (10.0, 0.0)
    for _ in range(20):
        space.step(1 / 60)
        found = joint.structure.energy
        assert found.external == pytest.approx(100.0, rel=1e-9)
        assert 0.0 <= found.viscous <= 100.0
        assert found.numerical >= 0.0


def test_a_longer_step_takes_back_all_of_what_a_contact_gave_in_a_shorter_one() -> None:
    """Chipmunk begins a step with the last one's impulses times the ratio of the steps; no ball may keep them."""
    case = chain(6, gravity=0.0, shapes=True)
    case.structure.whole_steps_only = True
    ball = pymunk.Body(10.0, 10.0 * 0.02**2)
    ball.position, ball.velocity = (0.21, 0.075), (0.0, -1.0)
    case.space.add(ball, pymunk.Circle(ball, 0.02))
    while ball.velocity.y < -0.99:
        case.space.step(1e-3)
    for _ in range(4):
        case.space.step(1 / 30)
        assert ball.kinetic_energy <= 5.0


@pytest.mark.parametrize("speed", [0.01, -0.01])
def test_a_kick_is_all_that_a_kick_brings(speed: float) -> None:
    """Up or down, on the tip of a bar that has come to rest under its weight; whole steps damp all of it."""
    case = chain(10)
    for _ in range(300):
        case.space.step(case.dt)
    before, case.steps = case.structure.energy, 3
    case.bodies[-1].velocity += (0.0, speed)
    check(case)
    now, brought = case.structure.energy, 0.5 * MASS * speed**2
    assert now.external - before.external == pytest.approx(brought, rel=0.02)
    assert now.numerical - before.numerical == pytest.approx(brought, rel=0.02)
