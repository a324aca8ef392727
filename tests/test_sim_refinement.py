"""Members that start coarse and are refined: what is carried over, and that the answer is that of the fine model."""

import itertools
import math

import msgspec
import numpy as np
import pymunk
import pytest
from cantilevers import cantilever
from frames import frame_scene, frame_text, push_towards

from capacity import InputError
from scene import Scene, parse_scene
from sim import LAWS, Assembly, Model, assemble, push_over
from sim.body_places import put_even
from sim.joint import AVERAGE_ACCELERATION, IMPLICIT_EULER
from sim.kernels import layout as at
from sim.kernels.layout import PARTS
from sim.settling import settle

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
    """To rounding, where the members swing; the energy to a millionth, and what is missing is in the ledger."""
    model = Model(rule, joints, "elastic-plastic", scheme=scheme, refine_at=math.inf)
    assembly = moving(portal(left, right), model, 69)
    # What is held is shown where the parts of a step began, with the velocities of their end: not its angular momentum.
    in_parts = assembly.structure.tables.control[at.PARTS] > 1
    before, energy = totals(assembly), assembly.structure.energy
    assert assembly.refine(["A-B", "B-C", "C-D"]) == ("A-B", "B-C", "C-D") == tuple(assembly.refined)
    after, now = totals(assembly), assembly.structure.energy
    mass, speed = before[0], math.sqrt(2.0 * energy.kinetic / before[0])
    kept = np.abs(after - before)[: 3 if in_parts else 4]
    assert kept.max() <= 1e-13 * mass * max(1.0, 5.0 * speed)
    whole = energy.kinetic + energy.elastic
    assert now.kinetic == pytest.approx(sum(kinetic(body) for body in dynamic(assembly)), rel=1e-12)
    lost = now.numerical - energy.numerical
    assert now.kinetic + now.elastic + lost == pytest.approx(whole, rel=1e-12)
    assert abs(lost) <= 1e-6 * whole
    assert now.elastic != pytest.approx(energy.elastic, rel=1e-6)  # what one has more the other has less


def kinetic(body: pymunk.Body) -> float:
    return 0.5 * (body.mass * body.velocity.length_squared + body.moment * body.angular_velocity**2)


def test_a_refined_structure_swings_on_with_its_energy() -> None:
    """What comes and goes with the swinging, and what refining adds, is below a ten-thousandth of it."""
    assembly = moving(
        portal("clamped", "pinned"), Model("lobatto", 7, "elastic-plastic", scheme=SCHEMES[0], refine_at=math.inf), 69
    )
    energy = assembly.structure.energy
    assembly.refine(["A-B", "B-C", "C-D"])
    for _ in range(500):
        assembly.step(STEP)
        now = assembly.structure.energy
        assert now.kinetic + now.elastic == pytest.approx(energy.kinetic + energy.elastic, rel=1e-4)
    assert assembly.structure.unconverged == 0


@pytest.mark.parametrize(
    ("steps", "scheme"), [*itertools.product((15, 20, 25), SCHEMES[1:]), *itertools.product((15, 25, 30), SCHEMES[:1])]
)
def test_a_structure_that_is_refined_in_parts_of_a_step_goes_on_where_it_was(
    steps: int, scheme: tuple[float, float]
) -> None:
    """It loses no more in the steps that follow than by the little damping of those parts, and gains nothing.

    Where it turns, as after 20 steps by the second-order scheme, members move too little to pay for what they store.
    """
    model = Model("lobatto", 7, "elastic-plastic", scheme=scheme, refine_at=math.inf)
    assembly = moving(portal("clamped", "pinned"), model, steps)
    assert assembly.structure.tables.control[PARTS] > 1
    energy = assembly.structure.energy
    assembly.refine(["A-B", "B-C", "C-D"])
    for _ in range(3):
        assembly.step(STEP)
        now = assembly.structure.energy
        assert 0.985 * (energy.kinetic + energy.elastic) <= now.kinetic + now.elastic <= energy.kinetic + energy.elastic


@pytest.mark.parametrize("law", LAWS)
def test_a_cantilever_that_starts_coarse_is_pushed_like_a_fine_one(law: str) -> None:
    """Within two ten-thousandths of the largest load; one that stays coarse errs by more where fibres yield.

    No point is where perfect plasticity bends the curve at once: steps cut that corner here or there.
    """
    scene, way = cantilever("rectangle 50x100 mm", 2.0, 0.15), np.linspace(0.0, 0.15, 44)
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


def test_members_under_their_weight_stay_at_rest() -> None:
    """The elastic line under an even load is exact: no force changes, and nothing begins to swing."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (3.0, 0.0, "pinned"), "C": (5.0, 0.0, "free")}
    scene = frame_scene(nodes, [("A", "B"), ("B", "C")], push_towards("C", (0, -1), 0.1))
    scene = msgspec.structs.replace(scene, gravity=9.81)
    assembly = assemble(scene, Model("lobatto", 9, "elastic-plastic", refine_at=math.inf), shapes=False)
    settle(scene, assembly, 1e-13)
    ends = [0, 3, 4]  # the joints at A and on both sides of B
    force, at = assembly.structure.force[ends], assembly.nodes["C"].now()
    before = assembly.structure.energy
    assert assembly.refine(["A-B", "B-C"]) == ("A-B", "B-C")
    after, ends = assembly.structure.energy, [0, 8, 9]
    assert assembly.structure.force[ends] == pytest.approx(force, rel=2e-4, abs=0.02)
    assert after.elastic == pytest.approx(before.elastic, rel=1e-4)
    assert assembly.nodes["C"].now() == pytest.approx(at, abs=1e-8)
    assembly.structure.scheme = AVERAGE_ACCELERATION
    for _ in range(200):
        assembly.step(STEP)
        assert assembly.nodes["C"].now() == pytest.approx(at, abs=1e-8)
        assert assembly.structure.force[ends] == pytest.approx(force, rel=2e-4, abs=0.02)


SUPPORTS = {
    "roller": 'support = "roller-x"',
    "spring": "spring = [3e6, 5e6, 1e5]",
    "bearing": "bearing = 1e6",
    "settling": 'support = "pinned"\nsettlement = [0.0, -0.01]',
    "heavy": 'support = "clamped"\nmass = 50.0',
}


@pytest.mark.parametrize("support", SUPPORTS)
def test_refined_members_keep_their_supports(support: str) -> None:
    """A beam on them is pushed at its middle like one that is fine from the start, within a thousandth."""
    nodes = {"A": (0.0, 0.0, "clamped"), "C": (2.0, 0.0, "free"), "B": (4.0, 0.0, "free")}
    text = frame_text(nodes, [("A", "C"), ("C", "B")], push_towards("C", (0, -1), 0.06), section="rectangle 50x100 mm")
    text = text.replace('at = [4.0, 0.0]\nsupport = "free"', f"at = [4.0, 0.0]\n{SUPPORTS[support]}")
    scene, way = parse_scene(text, "test"), np.linspace(0.0, 0.06, 21)
    fine, adaptive = (push_over(scene, Model("lobatto", 6, "elastic-plastic", refine_at=at), way) for at in (None, 0.5))
    assert adaptive.unconverged == 0
    assert adaptive.joints == fine.joints
    error = np.abs(adaptive.load_at_distances - fine.load_at_distances).max()
    assert error <= 1e-3 * np.abs(fine.load_at_distances).max()


@pytest.mark.parametrize("law", ["elastic-plastic", "interaction"])
def test_a_member_is_refined_while_a_blow_is_on(law: str) -> None:
    """Between steps in parts bodies are shown elsewhere: momenta to rounding, and the energy to a hundredth."""
    scene = cantilever("rectangle 50x100 mm", 2.0, 0.1)
    assembly = assemble(scene, Model("lobatto", 8, law, refine_at=math.inf, coarse_joints=3, fibres=12), shapes=False)
    for piece in assembly.pieces:
        piece.body.velocity = (0.0, -12.0 * piece.end / 2.0)
    for _ in range(40):
        assembly.step(1e-3)
    structure = assembly.structure
    assert structure.tables.control[PARTS] > 1
    put_even(structure.bodies, structure.tables)
    before, energy = totals(assembly), structure.energy
    assembly.refine(["beam"])
    assert totals(assembly) == pytest.approx(before, rel=1e-12, abs=1e-9)
    lost = assembly.structure.energy.numerical - energy.numerical
    assert abs(lost) <= 0.01 * (energy.kinetic + energy.elastic)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("joints", [8, 9])
def test_what_has_yielded_is_carried_over(joints: int, law: str) -> None:
    """A refined cantilever that was bent by a blow has the same work behind it, and comes to rest in the same place."""
    scene = cantilever("rectangle 50x100 mm", 2.0, 0.1, hardening=0.02 if law == "fibre" else 0.0)
    residual = []
    for refined in (False, True):
        model = Model("lobatto", joints, law, refine_at=math.inf, coarse_joints=3, fibres=12)
        assembly = assemble(scene, model, shapes=False)
        for piece in assembly.pieces:
            piece.body.velocity = (0.0, -12.0 * piece.end / 2.0)
        # In parts the blow would still be on, with much of its energy left to bend the finer member by.
        assembly.structure.whole_steps_only = True
        for _ in range(70):
            assembly.step(1e-3)
        structure = assembly.structure
        work, plastic, used = structure.dissipated.sum(), structure.plastic_deformation.sum(axis=0), structure.energy
        angle = assembly.pieces[-1].body.angle
        assert work > 100.0
        assert abs(angle) > 0.05
        if refined:
            before = totals(assembly)
            assert assembly.refine(["beam"]) == ("beam",)
            structure, now = assembly.structure, assembly.structure.energy
            assert totals(assembly) == pytest.approx(before, rel=1e-12, abs=1e-9)
            assert structure.dissipated.sum() == pytest.approx(work, rel=1e-12)
            assert structure.plastic_deformation.sum(axis=0) == pytest.approx(plastic, rel=1e-12)
            assert abs(now.gap) <= 1e-12 * now.external
            assert now.plastic == pytest.approx(used.plastic, rel=1e-12)
            locked = used.elastic if law == "fibre" else 0.0  # what fibres store against each other may be lost
            lost = now.numerical - used.numerical
            assert abs(lost) <= 0.01 * (used.kinetic + used.elastic) + locked + 1e-12
        for _ in range(600):
            assembly.step(5e-3)
        residual.append(assembly.nodes["tip"].now())
    assert residual[1] == pytest.approx(residual[0], abs=0.02 * abs(residual[0][1]))


def test_loads_follow_the_refined_members() -> None:
    """Their resultants on the structure stay what they were."""
    nodes = {"A": (0.0, 0.0, "clamped"), "B": (0.0, 3.0, "free"), "C": (4.0, 3.0, "free")}
    loads = [
        f'member = "{name}"\nper_length = [300.0, -1000.0]\nkind = "{kind}"'
        for name in ("A-B", "B-C")
        for kind in ("dead", "step")
    ]
    scene = frame_scene(nodes, [("A", "B"), ("B", "C")], "[motion]\nduration = 0.1", loads)
    assembly = assemble(scene, Model("lobatto", 7, "elastic-plastic", refine_at=math.inf), shapes=False)
    assembly.step(STEP)
    resultants = []
    for members in ((), ("A-B", "B-C")):
        assembly.refine(members)
        for load in (*assembly.dead_loads, *assembly.sudden_loads):
            load.act()
        bodies = dynamic(assembly)
        moment = sum(body.position.cross(body.force) + body.torque for body in bodies)
        resultants.append((sum(b.force.x for b in bodies), sum(b.force.y for b in bodies), moment))
        for body in bodies:
            body.force, body.torque = (0.0, 0.0), 0.0
    assert resultants[0][:2] == pytest.approx((4200.0, -14000.0), rel=1e-12)
    assert resultants[1][:2] == pytest.approx(resultants[0][:2], rel=1e-12)
    assert resultants[1][2] == pytest.approx(resultants[0][2], rel=1e-3)


def test_a_member_with_something_else_joined_to_it_stays_coarse() -> None:
    assembly = moving(portal("clamped", "clamped"), Model("lobatto", 7, "elastic-plastic", refine_at=math.inf), 3)
    weight = pymunk.Body(10.0, 1.0)
    assembly.space.add(weight, pymunk.PinJoint(assembly.pieces[0].body, weight))
    assert assembly.refine(["A-B", "B-C"]) == ("B-C",)
    assembly.step(STEP)


def test_a_refined_space_can_be_copied() -> None:
    """The copy goes on like the original, to the last digit."""
    assembly = moving(portal("clamped", "clamped"), Model("lobatto", 7, "elastic-plastic", refine_at=math.inf), 10)
    assembly.refine(["A-B", "C-D"])
    assembly.space.step(STEP)
    copy = assembly.space.copy()
    for space in (copy, assembly.space):
        for _ in range(5):
            space.step(STEP)
    assert [tuple(b.position) for b in copy.bodies] == [tuple(b.position) for b in assembly.space.bodies]


@pytest.mark.parametrize("line", ["refine_at = 0", "refine_at = -1", "coarse_joints = 1"])
def test_bad_settings_are_refused(line: str) -> None:
    text = frame_text(
        {"A": (0.0, 0.0, "clamped"), "B": (1.0, 0.0, "free")}, [("A", "B")], f"[simulation]\nduration = 1.0\n{line}"
    )
    with pytest.raises(InputError, match=r"simulation\." + line.split()[0]):
        parse_scene(text, "test")
