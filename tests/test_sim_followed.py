"""What rigid bodies with joints do not follow is refused by its place, not followed wrongly."""

import pytest

from capacity import InputError
from scene import builtin_text, parse_scene
from sim.followed import check_followed


def test_a_push_led_by_its_arc_is_the_references_alone() -> None:
    text = builtin_text("cantilever")
    check_followed(parse_scene(text, "test"))
    led = text.replace("direction = [0, -1]", 'direction = [0, -1]\ncontrol = "arc-length"')
    with pytest.raises(InputError, match=r"push\.control"):
        check_followed(parse_scene(led, "test"))


def test_members_of_several_materials_are_the_references_alone() -> None:
    text = builtin_text("cantilever").replace(
        "rectangle 50x100 mm", "rectangle 50x99 mm + rectangle 50x1 mm at 0,99 mm of S355"
    )
    with pytest.raises(InputError, match=r"members\.beam\.section"):
        check_followed(parse_scene(text, "test"))
