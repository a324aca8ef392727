from pathlib import Path

import pytest

from capacity import InputError
from scene import builtin_names, builtin_text, load_scene, parse_scene


@pytest.mark.parametrize("name", builtin_names())
def test_built_in_scenes_load(name: str) -> None:
    scene = load_scene(name)
    assert scene.members or scene.bodies


def test_cantilever() -> None:
    scene = load_scene("cantilever")
    assert scene.axis("beam") == (1.0, 0.0, 1.0)
    assert scene.push_direction() == (0.0, -1.0)
    assert scene.capacity("beam").M_max == pytest.approx(29375.0)


def test_written_out_scene_is_the_same(tmp_path: Path) -> None:
    file = tmp_path / "my.toml"
    file.write_text(builtin_text("cantilever"), encoding="utf-8-sig")  # a byte order mark does no harm
    assert load_scene(str(file)).push == load_scene("cantilever").push


@pytest.mark.parametrize(
    ("old", "new", "place", "fault"),
    [
        ("distance =", "distanc =", "push", 'did you mean "distance"'),
        ('["1 m"', '["1 k"', "nodes.tip.at[0]", "unknown unit"),
        ('["1 m"', '["1e200 m"', "nodes.tip.at[0]", "out of all proportion"),
        ('["1 m"', '["1e-200 m"', "nodes.tip.at[0]", "out of all proportion"),
        ('["1 m"', f"[1{400 * '0'}", "nodes.tip.at[0]", "out of all proportion"),
        ("[push]", "[simulation]\njoints = 1000000\n[push]", "simulation.joints", "<= 1000"),
        ('["1 m"', '["1 kg"', "nodes.tip.at[0]", "does not fit"),
        ('["1 m"', '["0 m"', "members.beam", "same point"),
        ("rectangle 50x100 mm", "rectangle 50x-100 mm", "members.beam.section", "not greater than zero"),
        ("rectangle 50x100 mm", "IPE 305", "members.beam.section", "did you mean"),
        ("fy=235 MPa", "fy=235 mm", "members.beam.material > fy", "does not fit"),
        ("gravity =", 'yielding = "ideal"\ngravity =', "yielding", "ideal"),
        ('"clamped"', '"clampd"', "nodes.root.support", "clampd"),
        ('node = "tip"', 'node = "tp"', "push.node", "the nodes are root, tip"),
        ('to = "tip"', "", "members.beam", "required field `to`"),
        ('from = "root"', 'from = "rot"', "members.beam.from", "the nodes are root, tip"),
        ("74.6031746031746 mm", "-3 mm", "push.distance", "greater than zero"),
        ("[0, -1]", "[0, 0]", "push.direction", "no direction"),
        ("[push]\n", "[push\n", "my.toml", "not valid TOML"),
        ('support = "clamped"', 'support = "free"', "nodes", "nothing is supported"),
        ("title =", "titel =", "top level", 'did you mean "title"'),
    ],
)
def test_faults_are_named_by_place(old: str, new: str, place: str, fault: str) -> None:
    text = builtin_text("cantilever")
    assert old in text
    with pytest.raises(InputError) as caught:
        parse_scene(text.replace(old, new, 1), "my.toml")
    message = str(caught.value)
    assert message.startswith("my.toml")
    assert place in message
    assert fault in message
    assert "\n" not in message


def test_missing_file_and_unknown_name() -> None:
    with pytest.raises(InputError, match="no such file"):
        load_scene("nowhere/my.toml")
    with pytest.raises(InputError, match="did you mean cantilever"):
        load_scene("cantilevr")
