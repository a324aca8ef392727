"""What rigid bodies with joints do not follow is refused by its place, not followed wrongly."""

import pytest

from capacity import InputError
from scene import builtin_text, parse_scene
from sim.followed import check_followed


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("direction = [0, -1]", 'direction = [0, -1]\ncontrol = "arc-length"', "push.control"),
    ],
)
def test_what_only_the_reference_follows(old: str, new: str, place: str) -> None:
    text = builtin_text("cantilever")
    check_followed(parse_scene(text, "test"))
    assert old in text
    with pytest.raises(InputError, match=place):
        check_followed(parse_scene(text.replace(old, new, 1), "test"))
