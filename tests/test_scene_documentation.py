"""docs/scene-file.md names every key of the schema, with an example that can be read; the schema fits the scenes."""

import re
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import msgspec
import pytest

from scene import Scene, builtin_names, builtin_text, json_schema, parse_scene
from scene.actions import Load, Motion, Push
from scene.bodies import Body, Box, Circle, Ground, Joint, Polygon
from scene.model import Grid, Member, Node
from scene.plane import Plane
from scene.programme import Measure, Simulation
from scene.reading import _read
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


def documented() -> list[tuple[str, str, str]]:
    """Table, key and example of each row."""
    found = []
    for name in ["", *SECTIONS]:
        for row in (row for row in section(name).splitlines() if row.startswith("| `")):
            keys_of_row, example = row.split("|")[1], re.search(r"\| `([^`]*)` \|$", row)
            found += [(name, key, example[1]) for key in re.findall(r"`(\w+)`", keys_of_row) if example]
    return found


@pytest.mark.parametrize(("name", "key", "example"), documented())
def test_every_example_is_a_value_that_its_key_takes(name: str, key: str, example: str) -> None:
    value = tomllib.loads(f"value = {example}")["value"]
    structs = SECTIONS[name] if name else [Scene]
    fields = [field for struct in structs for field in msgspec.structs.fields(struct) if field.encode_name == key]
    if key == "kind" and name == "bodies":
        assert value in {struct.__struct_config__.tag for struct in structs}
        return
    assert fields
    for field in fields:
        msgspec.convert(value, field.type, dec_hook=_read)


@pytest.mark.parametrize("page", sorted(Path(__file__).parent.parent.glob("**/*.md")), ids=lambda path: path.name)
def test_every_scene_in_the_documentation_can_be_read(page: Path) -> None:
    """Whole ones with all their names; of those without a title, some tables of a scene, every key."""
    for text in re.findall(r"^```toml\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S):
        tables = tomllib.loads(text)
        if "title" in tables:
            assert parse_scene(text, page.name).title == tables["title"]
        else:
            msgspec.convert({"title": page.name, **tables}, Scene, dec_hook=_read)


@pytest.fixture(scope="module")
def schema() -> Any:
    jsonschema.Draft202012Validator.check_schema(json_schema())
    return jsonschema.Draft202012Validator(json_schema())


@pytest.mark.parametrize("name", builtin_names())
def test_every_built_in_scene_fits_the_schema(name: str, schema: Any) -> None:
    assert [error.message for error in schema.iter_errors(tomllib.loads(builtin_text(name)))] == []


@pytest.mark.parametrize(
    ("old", "new"),
    [("duration", "duraton"), ('"36 kg"', "[36]"), ('kind = "circle"', 'kind = "disc"'), ('of = "foot"', "")],
)
def test_the_schema_finds_faults(old: str, new: str, schema: Any) -> None:
    text = builtin_text("post-impact")
    assert old in text
    assert list(schema.iter_errors(tomllib.loads(text.replace(old, new, 1))))
