"""Members that start coarse and are refined: what is carried over, and that the answer is that of the fine model."""

import math

import numpy as np
import pymunk
import pytest
from cantilevers import cantilever
from frames import frame_scene, push_towards

from scene import Scene
from sim import LAWS, Assembly, Model, assemble, push_over
from sim.joint import AVERAGE_ACCELERATION, IMPLICIT_EULER

SCHEMES = (AVERAGE_ACCELERATION, IMPLICIT_EULER)
STEP = 2e-3


def portal(left: str, right: str, push: str = "[simulation]\nduration = 1.0") -> Scene:
    nodes = {"A": (0.0, 0.0, left), "B": (0.0, 3.0, "free"), "C": (4.0, 3.0, "free"), "D": (4.0, 0.0, right)}
    return frame_scene(nodes, [("A", "B"), ("B", "C"), ("C", "D")], push, section="rectangle 50x100 mm")


def moving(scene: Scene, model: Model, steps: int) -> Assembly:
    """The scene's pieces thrown sideways, and left to swing."""
    assembly = assemble(scene, model, shapes=False)
    for piece in assembly.pieces:
        piece.body.velocity = (0.5, 0.2 if piece.member == "B-C" else 0.0)
    for _ in range(steps):
        assembly.step(STEP)
    return assembly


def dynamic(assembly: Assembly) -> list[pymunk.Body]:
    return [body for body in assembly.structure.bodies if body.body_type == pymunk.Body.DYNAMIC]


def totals(assembly: Assembly) -> np.ndarray:
    """Mass, momentum x, y and angular momentum about the origin."""
    total = np.zeros(4)
    for body in dynamic(assembly):
        (x, y), (vx, vy) = body.position, body.velocity
        spin = body.mass * (x * vy - y * vx) + body.moment * body.angular_velocity
        total += body.mass, body.mass * vx, body.mass * vy, spin
    return total


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("rule", "joints"), [("lobatto", 7), ("equal", 21), ("radau", 8)])
@pytest.mark.parametrize(("left", "right"), [("clamped", "clamped"), ("clamped", "pinned"), ("roller-x", "free")])
def test_mass_momentum_and_energy_are_kept(
    left: str, right: str, rule: str, joints: int, scheme: tuple[float, float]
) -> None:
    """To rounding, where the members swing."""
    model = Model(rule, joints, "elastic-plastic", scheme=scheme, refine_at=math.inf)
    assembly = moving(portal(left, right), model, 60)
    before, energy = totals(assembly), assembly.structure.energy
    assert assembly.refine(["A-B", "B-C", "C-D"]) == ("A-B", "B-C", "C-D") == tuple(assembly.refined)
    after, now = totals(assembly), assembly.structure.energy
    mass, speed = before[0], math.sqrt(2.0 * energy.kinetic / before[0])
    assert np.abs(after - before).max() <= 1e-13 * mass * max(1.0, 5.0 * speed)
    whole = energy.kinetic + energy.elastic
    assert now.kinetic == pytest.approx(sum(kinetic(body) for body in dynamic(assembly)), rel=1e-12)
    assert now.kinetic + now.elastic == pytest.approx(whole, rel=1e-12)
    assert abs(now.numerical) <= 1e-12 * whole
    assert now.elastic != pytest.approx(energy.elastic, rel=1e-6)  # what one has more the other has less


def kinetic(body: pymunk.Body) -> float:
    return 0.5 * (body.mass * body.velocity.length_squared + body.moment * body.angular_velocity**2)


def test_a_refined_structure_swings_on_with_its_energy() -> None:
    """What comes and goes with the swinging is below a thousandth of it, and no more than without refinement."""
    assembly = moving(
        portal("clamped", "pinned"), Model("lobatto", 7, "elastic-plastic", scheme=SCHEMES[0], refine_at=math.inf), 25
    )
    energy = assembly.structure.energy
    assembly.refine(["A-B", "B-C", "C-D"])
    for _ in range(500):
        assembly.step(STEP)
        now = assembly.structure.energy
        assert now.kinetic + now.elastic == pytest.approx(energy.kinetic + energy.elastic, rel=1e-3)
    assert assembly.structure.unconverged == 0


@pytest.mark.parametrize("law", LAWS)
def test_a_cantilever_that_starts_coarse_is_pushed_like_a_fine_one(law: str) -> None:
    """Within two ten-thousandths of the largest load; one that stays coarse errs by more where fibres yield."""
    scene, way = cantilever("rectangle 50x100 mm", 2.0, 0.15), np.linspace(0.0, 0.15, 51)
    fine, adaptive, coarse = (
        push_over(scene, Model("lobatto", joints, law, refine_at=at), way)
        for joints, at in ((9, None), (9, 0.5), (3, None))
    )
    assert adaptive.unconverged == 0
    assert (adaptive.joints, fine.joints) == (8, 8)
    largest = fine.load.max()
    assert np.abs(adaptive.load_at_distances - fine.load_at_distances).max() <= 2e-4 * largest
    assert adaptive.dissipated == pytest.approx(fine.dissipated, rel=1e-3)
    if law == "fibre":
        assert np.abs(coarse.load_at_distances - fine.load_at_distances).max() >= 0.02 * largest


@pytest.mark.parametrize("right", ["clamped", "pinned"])
def test_a_portal_that_starts_coarse_is_pushed_like_a_fine_one(right: str) -> None:
    """Within a thousandth of the largest load, there and back."""
    scene = portal("clamped", right, push_towards("B", (1, 0), 0.2))
    way = np.append(np.linspace(0.0, 0.2, 41), np.linspace(0.2, -0.1, 31)[1:])
    fine, adaptive = (push_over(scene, Model("lobatto", 7, "fibre", refine_at=at), way) for at in (None, 0.5))
    assert adaptive.unconverged == 0
    assert adaptive.joints == fine.joints
    error = np.abs(adaptive.load_at_distances - fine.load_at_distances).max()
    assert error <= 1e-3 * np.abs(fine.load_at_distances).max()
