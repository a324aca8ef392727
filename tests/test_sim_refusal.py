"""Steps that are refused: nothing has changed, the error names joint and cause, and the run goes on from there."""

import math
from collections.abc import Callable
from dataclasses import astuple

import numpy as np
import pymunk
import pytest
from hard_cases import Case, chain, law

from sim import DuctileJoint, SolverError, Structure, chipmunk
from sim.compiling import law_function
from sim.kernels import layout as at
from sim.memory import floats
from sim.noted import notes_known


def struck() -> Case:
    """A bar that yields under a ball, in the middle of the blow; two bodies hang from a pin beside it."""
    case = chain(8, law(strength=0.05), shapes=True)
    space = case.space
    for _ in range(10):
        space.step(1 / 60)
    ball = pymunk.Body(8.0, 0.01)
    ball.position, ball.velocity = case.bodies[6].position + pymunk.Vec2d(0.0, 0.35), (0.0, -15.0)
    hung = [pymunk.Body(1.0, 1.0) for _ in range(2)]
    hung[0].position, hung[1].position = (3.0, 3.0), (4.0, 3.0)
    space.add(ball, pymunk.Circle(ball, 0.05), *hung, pymunk.PinJoint(*hung))
    space.add(pymunk.PivotJoint(space.static_body, hung[0], (2.0, 3.0)))
    case.bodies.append(ball)
    for _ in range(2):
        space.step(1 / 60)
    return case


def everything(case: Case) -> list[np.ndarray]:
    """All that the next step depends on, as far as there is a name for it."""
    structure = case.structure
    bodies = [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in case.space.bodies]
    of_joints = [structure.force, structure.plastic_deformation, structure.dissipated, structure.deformation]
    return [np.array(bodies), *of_joints, structure.tables._states.copy(), np.array(astuple(structure.energy))]


def without_bound(case: Case) -> None:
    case.bodies[4].force = (math.inf, 0.0)


def too_far(case: Case) -> None:
    case.bodies[4].force = (1e200, 0.0)


def no_number(case: Case) -> None:
    case.bodies[4].torque = math.nan


@pytest.mark.parametrize("spoil", [without_bound, too_far, no_number])
def test_a_refused_step_leaves_the_whole_space_as_it_was(spoil: Callable[[Case], None]) -> None:
    case = struck()
    assert case.structure.tables.control[at.PARTS] > 1, "the blow is to be on"
    before, twin = everything(case), case.space.copy()
    spoil(case)
    with pytest.raises(SolverError, match=r"joint 4 .*not finite: a body of it has a force of"):
        case.space.step(1 / 60)
    for now, then in zip(everything(case), before, strict=True):
        np.testing.assert_allclose(now, then, rtol=1e-14, atol=1e-15)
    for _ in range(20):
        case.space.step(1 / 60)
        twin.step(1 / 60)
    # Stock constraints swing on from places that are right to rounding.
    for body, other in zip(case.space.bodies, twin.bodies, strict=True):
        np.testing.assert_allclose(body.position, other.position, rtol=0.0, atol=1e-12 if body in case.bodies else 1e-5)


def a_velocity(case: Case) -> None:
    case.bodies[4].velocity = (math.nan, 0.0)


def an_impulse(case: Case) -> None:
    case.bodies[4].apply_impulse_at_local_point((math.inf, 0.0))


def gravity(case: Case) -> None:
    case.space.gravity = (0.0, -math.inf)


def a_place(case: Case) -> None:
    case.bodies[4].position = (math.nan, 0.0)


@pytest.mark.parametrize(
    ("spoil", "what"),
    [
        (a_velocity, "a body of it has a velocity"),
        (an_impulse, "a body of it has a velocity"),
        (gravity, "the space has a gravity"),
        (a_place, "a body of it has a position"),
    ],
)
def test_what_was_set_is_named_and_not_what_follows_from_it(spoil: Callable[[Case], None], what: str) -> None:
    case = chain(6)
    case.space.step(1 / 60)
    spoil(case)
    with pytest.raises(SolverError, match=f"not finite: {what} of .*shorter step"):
        case.space.step(1 / 60)


@pytest.mark.parametrize("step", [-1 / 60, math.nan, math.inf])
def test_a_step_that_is_none_is_refused(step: float) -> None:
    case = chain(5)
    for _ in range(10):
        case.space.step(1 / 60)
    before = everything(case)
    with pytest.raises(SolverError, match=r"a step of .* s cannot be taken; give one above 0"):
        case.space.step(step)
    for now, then in zip(everything(case), before, strict=True):
        np.testing.assert_array_equal(now, then)
    case.space.step(0.0)
    case.space.step(1 / 60)
    assert np.isfinite(case.structure.force).all()


@law_function
def respond(parameters, state, deformation, out):  # type: ignore[no-untyped-def]  # noqa: ARG001
    """An elastic law that knows no force from a limit of slip on."""
    p, q, r = floats(parameters, 2), floats(deformation, 3), floats(out, 9)
    for i in range(9):
        r[i] = 0.0
    for i in range(3):
        r[i] = p[0] * q[i]
    r[3], r[6], r[8] = p[0], p[0], p[0]
    if abs(q[1]) > p[1]:
        r[1] = np.nan


@law_function
def commit(parameters, state, deformation, out):  # type: ignore[no-untyped-def]
    p, q, s, r = floats(parameters, 2), floats(deformation, 3), floats(state, 1), floats(out, 5)
    s[0] += 1.0
    r[0] = 0.5 * p[0] * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    for i in range(1, 5):
        r[i] = 0.0


class Fails:
    """What no law should do; its state counts how often it was committed."""

    name, yields_by = "fails", ("", "", "")
    respond_address, commit_address = respond, commit

    def __init__(self, stiffness: float, limit: float) -> None:
        self.stiffness, self.limit = stiffness, limit

    def parameters(self) -> np.ndarray:
        return np.array([self.stiffness, self.limit])

    def state(self) -> np.ndarray:
        return np.zeros(1)

    def elastic_tangent(self) -> tuple[float, float, float, float, float, float]:
        return (self.stiffness, 0.0, 0.0, self.stiffness, 0.0, self.stiffness)

    def capacities(self) -> tuple[float, float, float]:
        return math.inf, math.inf, math.inf


def test_what_fails_in_a_later_part_of_a_step_takes_the_earlier_ones_along() -> None:
    """A ball falls on a body on one joint, whose law fails once it has given way by 5 mm: some parts into the step."""
    space = pymunk.Space()
    space.collision_slop = 1e-4
    body, ball = pymunk.Body(5.0, 0.1), pymunk.Body(5.0, 0.1)
    ball.position, ball.velocity = (0.5, 0.2), (0.0, -4.0)
    joint = DuctileJoint(space.static_body, body, (0.0, 0.0), Fails(1e5, 5e-3), direction=0.0)
    space.add(body, pymunk.Poly.create_box(body, (1.0, 0.1)), ball, pymunk.Circle(ball, 0.1), joint)
    case = Case(space, Structure([joint]))
    before: list[np.ndarray] = []

    def run() -> None:
        for _ in range(60):
            before[:] = everything(case)
            space.step(1 / 60)

    with pytest.raises(SolverError, match="joint 0"):
        run()
    assert case.structure.tables[at.COPY].any(), "some of its parts were taken"
    for now, then in zip(everything(case), before, strict=True):
        np.testing.assert_allclose(now, then, rtol=0.0, atol=1e-14)


def aside(space: pymunk.Space) -> None:
    """A pile on the ground, a pendulum on a pin, a body on a spring, and a bar that sags, far from all else."""
    ground = pymunk.Segment(space.static_body, (40.0, -0.1), (60.0, -0.1), 0.1)
    ground.friction = 0.8
    space.add(ground)
    for i in range(3):
        box = pymunk.Body(2.0, 0.1)
        box.position, shape = (50.0 + 0.01 * i, 0.05 + 0.1 * i), pymunk.Poly.create_box(box, (0.1, 0.1))
        shape.friction = 0.6
        space.add(box, shape)
    bob, hung = pymunk.Body(1.0, 1.0), pymunk.Body(1.0, 1.0)
    bob.position, hung.position = (71.0, 0.0), (75.0, -1.0)
    bar = pymunk.Body(3.0, 0.1)
    bar.position = (80.5, 0.0)
    space.add(bob, hung, bar, pymunk.PinJoint(space.static_body, bob, (70.0, 0.0)))
    space.add(pymunk.DampedSpring(space.static_body, hung, (75.0, 0.0), (0.0, 0.0), 0.5, 100.0, 1.0))
    space.add(DuctileJoint(space.static_body, bar, (80.0, 0.0), law(strength=1e-4), direction=0.0))


@pytest.mark.parametrize("sleeps", [False, True])
def test_what_fails_in_one_structure_takes_back_the_whole_space(sleeps: bool) -> None:
    """Once a joint's law fails: bodies and their times at rest, contacts, constraints, ledgers."""
    space = pymunk.Space()
    space.gravity, space.collision_slop = (0.0, -9.81), 1e-4
    if sleeps:
        space.sleep_time_threshold = 10.0
    weak, other = pymunk.Body(5.0, 0.1), pymunk.Body(5.0, 0.1)
    other.position = (2.0, 0.0)
    failing = DuctileJoint(space.static_body, weak, (0.0, 0.0), Fails(1e6, 5e-3), direction=0.0)
    space.add(weak, other, failing, DuctileJoint(space.static_body, other, (2.0, 0.0), law(), direction=0.0))
    aside(space)
    for _ in range(40):
        space.step(1 / 60)

    def numbers() -> list[np.ndarray]:
        joints = [c for c in space.constraints if isinstance(c, DuctileJoint)]
        arbiters = chipmunk.listed(space, chipmunk.ARBITERS_OF_SPACE).tolist()
        return [
            *(chipmunk.save_body(body) for body in space.bodies),
            *(contact[7:9].copy() for arbiter in arbiters for contact in chipmunk.contacts_of(arbiter)),
            *(np.atleast_1d(c.impulse) for c in space.constraints if isinstance(c, pymunk.PinJoint)),
            *(np.array(astuple(joint.structure.energy)) for joint in joints if joint.structure is not None),
            *(joint.structure.force for joint in joints if joint.structure is not None),
            np.array([space.current_time_step]),
        ]

    weak.force = (0.0, -1e6)
    before = numbers()
    with pytest.raises(SolverError, match="joint 0"):
        space.step(1 / 50)
    # The force was used up.
    before[0][11] = 0.0
    for now, then in zip(numbers(), before, strict=True):
        np.testing.assert_allclose(now, then, rtol=0.0, atol=1e-14)
    for _ in range(10):
        space.step(1 / 60)
    assert all(np.isfinite(body.position).all() for body in space.bodies)


def test_the_error_of_structures_that_touch_comes_once() -> None:
    space = chain(4, shapes=True).space
    upper = pymunk.Body(3.0, 0.1)
    upper.position = (0.08, 0.1)
    plate = pymunk.Poly.create_box(upper, (0.16, 0.1))
    space.add(upper, plate, DuctileJoint(space.static_body, upper, (0.0, 0.1), law(), direction=0.0))
    for _ in range(30):
        space.step(1 / 60)
    upper.force = (0.0, -math.inf)
    with pytest.raises(SolverError):
        space.step(1 / 60)
    for _ in range(3):
        space.step(1 / 60)


def test_a_structure_that_joins_a_step_leaves_what_was_noted_of_it() -> None:
    """A box lies on the ground; two more bars come into the space together, the second of which looks for itself."""
    case = chain(3, law())
    box = pymunk.Body(1.0, 1.0)
    ground = pymunk.Segment(case.space.static_body, (50.0, 0.0), (60.0, 0.0), 0.1)
    box.position = (55.0, 0.6)
    case.space.add(box, pymunk.Poly.create_box(box, (1.0, 1.0)), ground)
    for _ in range(5):
        case.space.step(1 / 60)
    for x in (70.0, 80.0):
        bar = pymunk.Body(1.0, 1.0)
        bar.position = (x, 0.0)
        case.space.add(bar, DuctileJoint(case.space.static_body, bar, (x, 0.0), case.structure.joints[0].law))
    case.space.step(1 / 60)
    notes = notes_known(case.space)
    assert notes is not None
    assert len(notes.contacts) == 2
    assert (notes.contacts[:, 0].view(np.int64) != 0).all()
    assert notes.contacts[:, 1].sum() > 0.0
