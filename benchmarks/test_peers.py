"""The same cantilever in other engines, in one run: ``pytest -s benchmarks/test_peers.py``. Only ratios carry over.

Steel, 2 m × 0.1 m × 0.1 m, 50 equal pieces with the stiffness EI / ℓ between them, let go under its own weight and
followed for ten seconds in steps of 1/60 s.
"""

import math
import time
from collections.abc import Callable

import pymunk
import pytest
from test_speed import SECTION, STEEL

from capacity import capacity
from sim import DuctileJoint, ElasticPlastic

PIECES, LENGTH, STEP, STEPS, ROUNDS = 50, 2.0, 1.0 / 60.0, 600, 7
PIECE = LENGTH / PIECES
C, MASS = capacity(SECTION, STEEL), STEEL.density * SECTION.area * PIECE
MOMENT, WEIGHT = MASS * PIECE**2 / 12.0, 9.81 * MASS / PIECE
BENDING, SHEAR = WEIGHT * LENGTH**4 / (8.0 * C.EI), WEIGHT * LENGTH**2 / (2.0 * C.GA_s)


Build = Callable[[], Callable[[], float]]
Join = Callable[[pymunk.Body, pymunk.Body, int], list[pymunk.Constraint]]


def race(*engines: Build) -> list[tuple[float, float]]:
    """Least CPU time of a joint in a step [s], and the sag [m], of each; by turns, so that all see the same machine."""
    best = [(math.inf, math.nan)] * len(engines)
    for _ in range(ROUNDS):
        for i, build in enumerate(engines):
            run = build()
            began = time.process_time()
            sag = run()
            best[i] = min(best[i][0], (time.process_time() - began) / (STEPS * PIECES)), sag
    return best


def in_pymunk(
    iterations: int, join: Callable[[pymunk.Body, pymunk.Body, int], list[pymunk.Constraint]]
) -> Callable[[], float]:
    """The chain in a pymunk space, with what ``join`` makes between two pieces."""
    space = pymunk.Space()
    space.gravity, space.iterations = (0.0, -9.81), iterations
    last = space.static_body
    for i in range(PIECES):
        body = pymunk.Body(MASS, MOMENT)
        body.position = ((i + 0.5) * PIECE, 0.0)
        space.add(body, *join(last, body, i))
        last = body
    space.step(STEP)  # the structure is built in its first step, as exudyn's is before it is solved

    def run() -> float:
        for _ in range(STEPS):
            space.step(STEP)
        return -float(last.local_to_world((0.5 * PIECE, 0.0)).y)

    return run


def ours() -> Callable[[], float]:
    """Joints that would yield, at two iterations."""

    def join(a: pymunk.Body, b: pymunk.Body, i: int) -> list[pymunk.Constraint]:
        law = ElasticPlastic.of_section(C, PIECE * (0.5 if i == 0 else 1.0))
        return [DuctileJoint(a, b, (i * PIECE, 0.0), law, direction=0.0)]

    return in_pymunk(2, join)


def pivots_and_gears() -> Callable[[], float]:
    """Stock joints at ten iterations, the gear held by M_max."""

    def join(a: pymunk.Body, b: pymunk.Body, i: int) -> list[pymunk.Constraint]:
        gear = pymunk.GearJoint(a, b, 0.0, 1.0)
        gear.max_force = C.M_max
        return [pymunk.PivotJoint(a, b, (i * PIECE, 0.0)), gear]

    return in_pymunk(10, join)


def exudyn_chain() -> Callable[[], float]:
    """Rigid bodies on hinges with elastic springs, all implicit (generalised-α).

    Without shear and without yielding, and with what was fastest of its sparse and dense solvers, tolerances, modified
    and full Newton and ρ from 0 to 0.7. Springs as stiff as steel in place of the hinges did not converge at this step.
    """
    exu = pytest.importorskip("exudyn", reason="exudyn is not installed: pip install exudyn")
    items = pytest.importorskip("exudyn.itemInterface")
    container = exu.SystemContainer()
    system = container.AddSystem()
    last = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround())))
    for i in range(PIECES):
        node = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[(i + 0.5) * PIECE, 0.0, 0.0]))
        body = system.AddObject(items.ObjectRigidBody2D(nodeNumber=node, mass=MASS, inertia=MOMENT))
        here = system.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[-0.5 * PIECE, 0.0, 0.0]))
        spring = C.EI / (PIECE * (0.5 if i == 0 else 1.0))
        system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[last, here]))
        system.AddObject(items.ObjectConnectorTorsionalSpringDamper(markerNumbers=[last, here], stiffness=spring))
        weight = system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        system.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0.0, -9.81, 0.0]))
        last = system.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[0.5 * PIECE, 0.0, 0.0]))
    system.Assemble()
    settings = exu.SimulationSettings()
    stepping = settings.timeIntegration
    stepping.numberOfSteps, stepping.endTime, stepping.verboseMode = STEPS, STEPS * STEP, 0
    stepping.generalizedAlpha.spectralRadius = 0.0
    stepping.newton.relativeTolerance, stepping.newton.absoluteTolerance = 1e-5, 1e-7
    settings.solution.file.write = False
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    settings.linearSolver.reuseAnalyzedPattern = True

    def run() -> float:
        system.SolveDynamic(settings)
        return -float(system.GetMarkerOutput(last, exu.OutputVariableType.Position)[1])

    return run


def test_at_least_eight_times_faster_than_exudyn_at_the_same_accuracy() -> None:
    (theirs, their_sag), (own, sag) = race(exudyn_chain, ours)
    print(f"\nexudyn {1e9 * theirs:.0f} ns, here {1e9 * own:.0f} ns a joint and step: {theirs / own:.1f} times")
    assert sag == pytest.approx(BENDING + SHEAR, rel=1e-3)
    assert their_sag == pytest.approx(BENDING, rel=1e-3)
    assert own * 8.0 <= theirs


def test_faster_than_stock_joints_which_are_wrong_at_that_length() -> None:
    (theirs, their_sag), (own, sag) = race(pivots_and_gears, ours)
    print(f"\npivot and gear {1e9 * theirs:.0f} ns, here {1e9 * own:.0f} ns a joint and step: {theirs / own:.2f} times")
    print(f"sag over exact: {their_sag / BENDING:.3g} and {sag / (BENDING + SHEAR):.5f}")
    assert sag == pytest.approx(BENDING + SHEAR, rel=1e-3)
    assert abs(their_sag / BENDING - 1.0) > 1.0
    assert own <= theirs
