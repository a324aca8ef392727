"""Steps in which Newton's method alone gets nowhere, or contacts and joints go round in circles."""

import numpy as np
import pytest
from hard_cases import chain, law, momenta

from sim import AVERAGE_ACCELERATION, IMPLICIT_EULER, Structure
from sim.kernels.active_rows import eliminate


@pytest.mark.parametrize("scheme", [IMPLICIT_EULER, AVERAGE_ACCELERATION])
@pytest.mark.parametrize(("stiffness", "strength"), [(1.0, 0.1), (1e3, 1e-2)])
def test_weak_stiff_joints_that_are_thrown_about_converge(
    stiffness: float, strength: float, scheme: tuple[float, float]
) -> None:
    """Every joint yields one way and then the other, within a step."""
    case, random = chain(15, law(stiffness, strength)), np.random.default_rng(3)
    case.structure.scheme = scheme
    for body in case.bodies:
        body.velocity, body.angular_velocity = tuple(random.uniform(-100.0, 100.0, 2)), random.uniform(-100.0, 100.0)
    for _ in range(20):
        case.space.step(1 / 60)
        assert case.structure.utilisation.max() <= 1.0 + 1e-9
    assert case.structure.unconverged == 0


def test_joints_bear_no_more_than_they_can_in_solutions_that_are_worth_little() -> None:
    """With a tolerance of a hundredth of the bodies' velocities, which is much to weak joints."""
    case, random = chain(10, law(strength=1e-2), clamped=False, gravity=0.0), np.random.default_rng(5)
    structure = Structure(case.structure.joints, tolerance=1e-2)
    for body in case.bodies:
        body.velocity, body.angular_velocity = tuple(random.uniform(-30.0, 30.0, 2)), random.uniform(-30.0, 30.0)
    for _ in range(50):
        before, _ = momenta(case.bodies)
        case.space.step(1e-3)
        now, size = momenta(case.bodies)
        assert structure.utilisation.max() <= 1.0 + 1e-9
        assert np.abs(now - before).max() <= 1e-13 * size


def test_equations_of_contacts_are_solved_by_elimination() -> None:
    """Against numpy's solver; a matrix that has no inverse is noticed."""
    random = np.random.default_rng(1)
    for count in (1, 2, 7):
        matrix, wanted = random.normal(size=(count, count)), random.normal(size=count)
        right = matrix @ wanted
        assert eliminate.py_func(matrix, right)
        assert right == pytest.approx(wanted, rel=1e-9)
    assert not eliminate.py_func(np.ones((3, 3)), np.ones(3))
