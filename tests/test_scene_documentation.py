"""docs/scene-file.md names every key of the schema, with an example."""

import re
from pathlib import Path

import msgspec
import pytest

from scene import Scene
from scene.actions import Load, Motion, Push
from scene.bodies import Body, Box, Circle, Ground, Joint, Polygon
from scene.model import Grid, Member, Node
from scene.plane import Plane
from scene.programme import Measure, Simulation
from scene.vehicles import Drive, Lap, Vehicle, Wheel

TEXT = (Path(__file__).parent.parent / "docs" / "scene-file.md").read_text(encoding="utf-8")
SECTIONS = {
    "nodes": [Node],
    "members": [Member],
    "grids": [Grid],
    "loads": [Load],
    "push": [Push],
    "plane": [Plane],
    "motion": [Motion],
    "simulation": [Simulation],
    "grounds": [Ground],
    "bodies": [Body, Circle, Box, Polygon],
    "joints": [Joint],
    "vehicles": [Vehicle, Wheel, Drive, Lap],
    "measures": [Measure],
}


def keys(struct: type[msgspec.Struct]) -> list[str]:
    return [field.encode_name for field in msgspec.structs.fields(struct)]


def section(name: str) -> str:
    """What stands under the heading of a table; under none, before all headings."""
    parts = re.split(r"^## `\[+(\w+)[^`]*`\n", TEXT, flags=re.M)
    return parts[0] if not name else dict(zip(parts[1::2], parts[2::2], strict=True))[name]


def test_every_table_of_a_scene_has_a_section_or_a_row() -> None:
    for key in keys(Scene):
        assert key in SECTIONS or f"| `{key}` |" in section(""), key


@pytest.mark.parametrize("name", SECTIONS)
def test_every_key_is_documented_under_its_table(name: str) -> None:
    text = section(name)
    named = set(re.findall(r"`(\w+)`", text))
    for struct in SECTIONS[name]:
        assert not set(keys(struct)) - named, (
            f"[{name}] of docs/scene-file.md does not name {set(keys(struct)) - named}"
        )


@pytest.mark.parametrize("name", ["", *SECTIONS])
def test_every_row_has_an_example(name: str) -> None:
    rows = [row for row in section(name).splitlines() if row.startswith("| `")]
    assert rows
    for row in rows:
        example = row.rstrip("| ").rsplit("|", 1)[1]
        assert "`" in example or "see below" in row, row


def test_no_row_names_a_key_that_does_not_exist() -> None:
    for name, structs in SECTIONS.items():
        known = {key for struct in structs for key in keys(struct)} | {"kind"}
        for row in section(name).splitlines():
            if row.startswith("| `"):
                assert set(re.findall(r"`(\w+)`", row.split("|")[1])) <= known, row
