"""Loads, supports, pushes and motions as a scene file gives them, and their faults."""

import pytest

from capacity import InputError
from scene import HELD, parse_scene

FRAME = """
title = "portal"
gravity = 0.0
kinematics = "p-delta"
[nodes.a]
at = [0.0, 0.0]
support = "roller-x"
spring = ["1 MN/m", "0 N/m", "2 MN m/rad"]
settlement = ["0 mm", "-3 mm"]
[nodes.b]
at = [0.0, 4.0]
mass = "500 kg"
[nodes.c]
at = [6.0, 4.0]
support = "clamped"
[members.column]
from = "a"
to = "b"
section = "IPE 300"
material = "S235"
releases = ["to"]
[members.beam]
from = "b"
to = "c"
section = "IPE 300"
material = "S235"
[[loads]]
node = "b"
force = ["1 kN", "0 N"]
[[loads]]
member = "beam"
per_length = ["0 N/m", "-5 kN/m"]
kind = "dead"
[push]
node = "b"
direction = [2, 0]
turning_points = ["15 mm", "-15 mm", "20 mm"]
unload = true
"""

MOTION = FRAME[: FRAME.index("[[loads]]")] + '[motion]\nduration = "0.2 s"\nvelocity = ["0 m/s", "-9.9 m/s"]\n'


def test_everything_is_read_in_si() -> None:
    scene = parse_scene(FRAME, "test")
    node = scene.nodes["a"]
    assert node.spring == (1e6, 0.0, 2e6)
    assert node.settlement == (0.0, -0.003)
    assert node.held == HELD["roller-x"] == (False, True, False)
    assert scene.nodes["b"].mass == 500.0
    assert scene.members["column"].releases == ("to",)
    assert [load.node for load in scene.loads_of("proportional")] == ["b"]
    assert [load.per_length for load in scene.loads_of("dead")] == [(0.0, -5e3)]
    assert scene.push.stops() == (0.015, -0.015, 0.02)
    assert scene.push.way() == pytest.approx(0.015 + 0.03 + 0.035)
    assert scene.push_direction() == (1.0, 0.0)
    assert scene.push.unload


def test_a_motion_needs_no_push() -> None:
    scene = parse_scene(MOTION, "test")
    assert scene.motion is not None
    assert scene.motion.duration == 0.2
    assert scene.motion.velocity == (0.0, -9.9)
    with pytest.raises(InputError, match="no push"):
        _ = scene.push


@pytest.mark.parametrize(
    ("text", "old", "new", "place", "fault"),
    [
        (FRAME, '"roller-x"', '"roler"', "nodes.a.support", "roler"),
        (FRAME, '"1 MN/m"', '"1 MN"', "nodes.a.spring[0]", "does not fit"),
        (FRAME, '"1 MN/m"', '"-1 MN/m"', "nodes.a.spring", "negative"),
        (FRAME, '["0 mm", "-3 mm"]', '["1 mm", "0 mm"]', "nodes.a.settlement", "does not hold x"),
        (FRAME, '"500 kg"', '"-5 kg"', "nodes.b.mass", "negative"),
        (FRAME, 'mass = "500 kg"', 'mass = "5 kg"\nvelocity = [1, 0]', "nodes.b.velocity", "no mass"),
        (FRAME, 'releases = ["to"]', 'releases = ["end"]', "members.column.releases[0]", "end"),
        (FRAME, 'node = "b"\nforce', 'node = "z"\nforce', "loads[0].node", "the nodes are a, b, c"),
        (FRAME, 'node = "b"\nforce', "force", "loads[0]", "a node or a member"),
        (FRAME, '["1 kN", "0 N"]', '["0 kN", "0 N"]', "loads[0]", "zero"),
        (FRAME, 'member = "beam"', 'member = "bem"', "loads[1].member", "the members are column, beam"),
        (FRAME, "per_length =", "per_lenth =", "loads[1]", 'did you mean "per_length"'),
        (FRAME, 'kind = "dead"', 'kind = "step"', "loads[1].kind", "sudden"),
        (FRAME, '"15 mm", "-15 mm"', '"15 mm", "15 mm"', "push.turning_points", "repeats"),
        (FRAME, "unload = true", "unload = true\ndistance = 0.1", "push.distance", "turning_points"),
        (FRAME, "direction = [2, 0]", "direction = [2, 0]\nunlod = true", "push", 'did you mean "unload"'),
        (FRAME, 'node = "b"\ndirection = [2, 0]', 'node = "a"\ndirection = [0, 1]', "push.node", "supported"),
        (FRAME, "[push]", "[nodes.d]\nat = [9.0, 9.0]\n[push]", "nodes.d", "no member"),
        (FRAME, '"p-delta"', '"second"', "kinematics", "second"),
        (MOTION, '"0.2 s"', '"0 s"', "motion.duration", "greater than zero"),
        (MOTION, '["0 m/s", "-9.9 m/s"]', "[0, 0]", "motion", "in motion"),
        (MOTION, "[motion]", '[[loads]]\nnode = "b"\nmoment = 3.0\n[motion]', "loads[0].kind", "no load factor"),
        (MOTION, "duration =", 'watch = "z"\nduration =', "motion.watch", "the nodes are"),
        (MOTION, "[motion]", "[motion]\ndirection = [0, 0]", "motion.direction", "no direction"),
    ],
)
def test_faults_are_named_by_place(text: str, old: str, new: str, place: str, fault: str) -> None:
    assert old in text
    with pytest.raises(InputError) as caught:
        parse_scene(text.replace(old, new, 1), "my.toml")
    message = str(caught.value)
    assert message.startswith(f"my.toml > {place}")
    assert fault in message
    assert "\n" not in message


def test_a_scene_in_which_nothing_happens_is_refused() -> None:
    with pytest.raises(InputError, match="nothing happens"):
        parse_scene(MOTION[: MOTION.index("[motion]")], "test")
    with pytest.raises(InputError, match="keep one"):
        parse_scene(FRAME.replace("[push]", '[motion]\nduration = "1 s"\nvelocity = [0, 1]\n[push]'), "test")
