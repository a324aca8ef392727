"""Joints that cannot be: refused where they are made, or out of `space.step`, in one line that says what to write."""

import math
from collections.abc import Callable
from typing import Any

import pymunk
import pytest

from capacity import InputError, parse_material, parse_section
from scene import load_scene
from sim import AVERAGE_ACCELERATION, DuctileJoint, ElasticPlastic, Limits, Model, RigidPlastic, assemble, section_law

STIFFNESS, CAPACITY = (1e6, 1e6, 1e4), (1e3, 1e3, 1e2)
LAW = ElasticPlastic(STIFFNESS, CAPACITY)
CANTILEVER, CUT = load_scene("cantilever"), Model("lobatto", 5, "fibre")


def bodies(count: int) -> list[pymunk.Body]:
    """In a row along x, a metre apart."""
    row = [pymunk.Body(1.0, 1.0) for _ in range(count)]
    for i, body in enumerate(row):
        body.position = (float(i), 0.0)
    return row


def joint(law: Any = LAW, **options: Any) -> DuctileJoint:
    return DuctileJoint(*bodies(2), (0.5, 0.0), law, **options)


def section(length: float) -> object:
    return section_law("fibre", parse_section("IPE 200"), parse_material("S235"), length)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ElasticPlastic((1e6, 1e6), CAPACITY), r"stiffness: \(1000000.0, 1000000.0\) is not three numbers"),  # type: ignore[arg-type]
        (lambda: ElasticPlastic(1e6, CAPACITY), "stiffness: 1000000.0 is not three numbers; write three"),  # type: ignore[arg-type]
        (lambda: ElasticPlastic((-1.0, 1.0, 1.0), CAPACITY), r"stiffness: .*negative.*\[N/m, N/m, N m/rad\]"),
        (lambda: ElasticPlastic(STIFFNESS, (math.nan, 1.0, 1.0)), "capacity: .*no number"),
        (lambda: RigidPlastic((1e3, -1.0, 1e3)), r"capacity: .*negative.*\[N, N, N m\]"),
        (lambda: section(0.0), "length: 0 m is not greater than zero"),
        (lambda: section(-0.2), "length: -0.2 m is not"),
        (lambda: Limits(rotation=-1.0), "limits.rotation: -1.0 is negative"),
        (lambda: Limits(slip=math.nan), "limits.slip: nan is negative or no number"),
        (lambda: joint("fibre"), "law: 'fibre' is no law.*section_law"),
        (lambda: joint(ElasticPlastic((math.inf, 1.0, 1.0), CAPACITY)), "law: its stiffness is not finite"),
        (lambda: joint(damping=(-1.0, 0.0, 0.0)), r"damping: \(-1.0, 0.0, 0.0\) will not do"),
        (lambda: joint(scheme="average"), "scheme: 'average' is no time integration; write IMPLICIT_EULER"),
        (lambda: joint(direction=math.nan), "at, direction: the joint's place is not finite"),
        (lambda: RigidPlastic((math.inf,) * 3), "capacity: of .* none is finite and positive"),
        (lambda: ElasticPlastic(STIFFNESS, ("1", "1", "1")), "capacity: .* is not three numbers"),  # type: ignore[arg-type]
        (lambda: Limits(slip="3"), "limits.slip: 3 is negative or no number"),  # type: ignore[arg-type]
        (lambda: joint(ElasticPlastic), r"law: ElasticPlastic is a kind of law; make one: ElasticPlastic\("),
        (lambda: joint(limits=0.3), r"limits: 0.3 is no Limits; write one such as Limits\("),
        (lambda: joint(on_break="stop"), "on_break: 'stop' cannot be called"),
        (lambda: joint(turn=2.0), "turn: 2.0 is no share of b's rotation"),
        (lambda: joint(length=-1.0), "length: -1.0 is no length"),
        (lambda: joint(scheme=(1 / 12, 0.0)), r"scheme: \(.*\) is not stable at any step"),
        (lambda: DuctileJoint(*bodies(2), (0.5,), LAW), r"at: \(0.5,\) is no point"),  # type: ignore[arg-type]
        (lambda: DuctileJoint(*bodies(2), "here", LAW), "at: 'here' is no point"),  # type: ignore[arg-type]
        (lambda: DuctileJoint(pymunk.Space(), bodies(1)[0], (0.5, 0.0), LAW), "a: .* is no pymunk.Body"),  # type: ignore[arg-type]
        (lambda: Model("lobatto", 5, "fibre", dt=-1.0), "dt: -1.0 s is no step"),
        (lambda: Model("lobatto", 5, "fibre", iterations=0), "iterations: 0 are too few"),
        (lambda: Model("lobatto", 5, "fibre", damping=-1.0), "damping: -1.0 s is no damping"),
        (lambda: assemble(CANTILEVER, CUT, limits={"baem": Limits()}), r"limits\['baem'\]: .*the members are beam"),
        (lambda: DuctileJoint(*bodies(1) * 2, (0.0, 0.0), LAW), "a, b: a joint needs two bodies"),
    ],
)
def test_a_joint_that_cannot_be_is_refused_where_it_is_made(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=f"^{message}"):
        make()


class Broken(ElasticPlastic):
    """A law under construction."""

    def parameters(self) -> Any:
        raise ZeroDivisionError("a law's own fault")


@pytest.mark.parametrize(
    ("second", "error", "message"),
    [
        (LAW, InputError, r"joints at 0\.5, 0 and 1\.5, 0: .*\(0\.25, 0\.0\); give both the same scheme="),
        (Broken(STIFFNESS, CAPACITY), ZeroDivisionError, "a law's own fault"),
    ],
)
def test_joints_that_make_no_structure_are_told_out_of_every_step_until_they_are_gone(
    second: ElasticPlastic, error: type[Exception], message: str
) -> None:
    """And what has no structure does nothing meanwhile; Chipmunk asks joints from C, where nothing can be raised."""
    space = pymunk.Space()
    a, b, c = bodies(3)
    first = DuctileJoint(a, b, (0.5, 0.0), LAW)
    scheme = AVERAGE_ACCELERATION if second is LAW else first.scheme
    odd = DuctileJoint(b, c, (1.5, 0.0), second, scheme=scheme)
    space.add(a, b, c, first, odd)
    for _ in range(2):
        with pytest.raises(error, match=message):
            space.step(1 / 60)
    space.remove(odd)
    b.velocity = (0.0, 1.0)
    space.step(1 / 60)
    assert first.structure is not None
    # They swing against each other, undamped, about half of that.
    assert a.velocity.y > 0.01
    assert a.velocity.y + b.velocity.y == pytest.approx(1.0)
    assert c.velocity.y == 0.0


def test_a_body_that_is_not_in_the_space_is_named() -> None:
    space = pymunk.Space()
    a, b = bodies(2)
    space.add(a, DuctileJoint(a, b, (0.5, 0.0), LAW))
    with pytest.raises(InputError, match=r"joint at 0\.5, 0: a body of it is not in the space; space\.add\(body\)"):
        space.step(1 / 60)
    space.add(b)
    space.step(1 / 60)
