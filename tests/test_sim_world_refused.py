"""Scenes that cannot be stepped, and what is no fault."""

import pytest

from capacity import InputError
from scene import builtin_text, load_scene, parse_scene
from sim.world import World


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [({"dt": 5.0}, "longer than the whole run"), ({"duration": 1e-3}, "longer than the whole run")],
)
def test_a_step_longer_than_the_run_is_refused(arguments: dict[str, float], fault: str) -> None:
    with pytest.raises(InputError, match=fault):
        World(load_scene("block-under-tension"), **arguments)


FLOOR = '[[grounds]]\npoints = [["-9 m", "0 m"], ["40 m", "0 m"]]\n'


@pytest.mark.parametrize(
    ("text", "old", "new", "place", "other"),
    [
        ("post-impact", '["-0.55 m", "1.5 m"]', '["0 m", "1.5 m"]', "bodies.post", "bodies.ball"),
        ("post-impact", '["12 m", "1 m"]', '["12 m", "0.5 m"]', "bodies.stop", "the ground"),
        ("post-impact", '["12 m", "1 m"]', '["0 m", "1 m"]', "bodies.post", "bodies.stop"),
        ("rod", '["-12 m", "2.2 m"]', '["-2 m", "2.2 m"]', "vehicles.lorry", "members.rod"),
        ("own-weight-beam", "[nodes.wall]", FLOOR + "[nodes.wall]", "members.beam", "the ground"),
    ],
)
def test_what_overlaps_from_the_start_is_refused(text: str, old: str, new: str, place: str, other: str) -> None:
    """The beam, with its axis on the ground, would be bent up by 5 m."""
    assert old in builtin_text(text)
    with pytest.raises(InputError, match=f"^{place}: it overlaps with {other} at the start"):
        World(parse_scene(builtin_text(text).replace(old, new, 1), "test"))


def test_what_touches_is_no_overlap() -> None:
    """A beam of 2 m on the ground, and a wheel that stands in it by a sixteenth of its size."""
    beam = builtin_text("own-weight-beam").replace('"0 m"]', '"1 m"]').replace("[nodes.wall]", FLOOR + "[nodes.wall]")
    world = World(parse_scene(beam, "test"))
    while not world.finished:
        world.step()
    assert world.results()["joints that yielded"] == 0.0
    assert World(load_scene("car-on-ramp")).cars["car"].wheels[0].position.y == pytest.approx(0.35)


def test_a_run_of_more_than_a_billion_steps_is_refused() -> None:
    with pytest.raises(InputError, match=r"1e\+09 steps of 1e-10 s"):
        World(load_scene("block-under-tension"), 1e-10)
