"""The ledger of a whole space: structures, loose bodies, and what they do to each other."""

import itertools

import pymunk
import pytest
from hard_cases import MASS, Case, chain, largest, law, rests

from scene import load_scene
from sim import Energy, Recorder, SystemLedger
from sim.world import World


def kinetic(space: pymunk.Space) -> float:
    # pymunk's kinetic energy is m v² + I ω², without the half.
    return sum(0.5 * body.kinetic_energy for body in space.bodies if body.body_type == pymunk.Body.DYNAMIC)


def scatter(case: Case, count: int, restitution: float) -> None:
    """Boxes and balls that fly at the bar, and at each other."""
    for i in range(count):
        body = pymunk.Body(2.0 + i, (2.0 + i) * 0.1**2 / 6.0)
        body.position, body.velocity = (0.08 + 0.11 * (i % 3), 0.15 + 0.13 * i), (0.5 - 0.3 * i, -4.0)
        body.angular_velocity = 3.0 * i
        shape = pymunk.Circle(body, 0.05) if i % 2 else pymunk.Poly.create_box(body, (0.1, 0.1))
        shape.friction, shape.elasticity = 0.6, restitution
        case.space.add(body, shape)


def run(case: Case, steps: int, dt: float) -> list[Energy]:
    ledger = SystemLedger(case.space)
    entries = []
    for _ in range(steps):
        case.space.step(dt)
        ledger.note()
        entries.append(ledger.energy)
    return entries


@pytest.mark.parametrize("restitution", [0.0, 0.7])
@pytest.mark.parametrize("rate", [60, 120, 240, 1000, 2040])
def test_bodies_that_collide_keep_what_they_had_but_for_what_is_booked_as_lost(rate: int, restitution: float) -> None:
    """No weight: what came in is kinetic at first, and everything after is in the ledger, found entry by entry.

    In steps that are taken in parts, and in whole ones, in which the bodies strike each other, too.
    """
    case = chain(8, law(strength=0.002), shapes=True, gravity=0.0)
    scatter(case, 4, restitution)
    given = kinetic(case.space)
    for now in run(case, rate * 5 // 6, 1.0 / rate):
        assert now.external == pytest.approx(given, rel=1e-12)
        assert abs(now.gap) <= 1e-12 * given
        assert now.numerical >= -1e-12 * given
        assert now.stock == 0.0
    assert now.kinetic == pytest.approx(kinetic(case.space), rel=1e-12)
    assert now.contact > 0.1 * given
    assert now.plastic > 0.01 * given


def test_weights_work_along_the_way_to_the_middle_of_a_move() -> None:
    """Also when the step changes, and for bodies in and out of structures alike; no step is taken in parts.

    To two hundred-thousandths: bodies of structures are carried on to where a step of another length had them, and what
    overlap is taken out in such a step strains joints by as much as that is off.
    """
    case = chain(6, law(strength=0.02), shapes=True)
    scatter(case, 3, 0.3)
    case.structure.whole_steps_only = True
    ledger, work, started = SystemLedger(case.space), 0.0, kinetic(case.space)
    for dt in itertools.islice(itertools.cycle((1 / 2500, 1 / 2500, 1 / 2000)), 600):
        before = [(body, body.velocity.y) for body in case.space.bodies]
        case.space.step(dt)
        ledger.note()
        work -= sum(9.81 * dt * body.mass * 0.5 * (v + body.velocity.y) for body, v in before)
    assert ledger.energy.external == pytest.approx(started + work, rel=2e-5)
    assert abs(ledger.energy.gap) <= 1e-12 * largest(ledger.energy)


def test_a_body_slowed_over_several_steps_gives_all_it_loses_to_the_structure() -> None:
    """200 kg stopped by a bar within ten steps of 1/2000 s."""
    case = rests(200.0, MASS)
    box = next(b for b in case.space.bodies if b not in case.bodies)
    box.position, box.velocity = (0.7, 0.0505 + 0.05), (0.0, -3.0)
    case.space.gravity = (0.0, 0.0)
    before = 0.5 * box.kinetic_energy
    for _ in range(100):
        case.space.step(1 / 2000)
    lost = before - 0.5 * box.kinetic_energy
    assert lost > 0.5 * before
    assert case.structure.energy.external == pytest.approx(lost, rel=1e-12)


def test_what_a_stock_spring_stores_is_its_own_entry() -> None:
    space = pymunk.Space()
    a, b = pymunk.Body(2.0, 0.1), pymunk.Body(3.0, 0.1)
    b.position = (1.0, 0.0)
    space.add(a, b, pymunk.DampedSpring(a, b, (0.0, 0.0), (0.0, 0.0), 1.0, 1000.0, 0.0))
    a.velocity = (-1.0, 0.0)
    ledger, most = SystemLedger(space), 0.0
    for _ in range(1000):
        space.step(1e-4)
        ledger.note()
        stretch = b.position.x - a.position.x - 1.0
        assert ledger.energy.stock == pytest.approx(500.0 * stretch**2, abs=0.005)
        assert abs(ledger.energy.gap) <= 1e-12
        most = max(most, ledger.energy.stock)
    # All but what the common motion of both bodies keeps.
    assert most == pytest.approx(0.5 * 1.2, rel=1e-2)


@pytest.mark.parametrize("name", ["car-on-ramp", "gate"])
def test_a_scene_with_vehicles_and_loose_bodies_closes(name: str) -> None:
    world = World(load_scene(name))
    recorder = Recorder(world.space)
    for _ in range(600):
        world.step()
        recorder.sample(world.part)
    energy = {account: float(values[-1]) for account, values in recorder.finish().energy.items()}
    now = Energy(**energy)
    assert abs(now.gap) <= 1e-9 * largest(now)
    assert now.kinetic == pytest.approx(kinetic(world.space), rel=1e-9)
    assert (now.stock != 0.0) == bool(world.cars)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 240, 1 / 1000])
def test_a_blow_that_breaks_a_joint_is_booked_once(dt: float) -> None:
    """½ · 200 kg · (30 m/s)² and no more, also where the foot breaks in the very first step."""
    world = World(load_scene("post-impact"), dt, duration=0.05)
    ledger = SystemLedger(world.space)
    while not world.finished:
        world.step()
        ledger.note()
    assert world.broken
    assert ledger.energy.external == pytest.approx(90e3, rel=2e-3)
    assert abs(ledger.energy.gap) < 1e-6 * 90e3
    assert ledger.energy.contact < 0.3 * 90e3
