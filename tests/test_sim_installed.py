"""That another layout of Chipmunk's structs is noticed, field by field."""

import pytest

from sim import chipmunk
from sim.installed import IncompatiblePymunk, verify

# All but the lengths of structs, what is no offset, the first word of a struct, which has none before it, and where a
# list's items are, which would be sought at their number; the trees of shapes are looked at by `sim.collision_tree`.
OFFSETS = [
    name
    for name, value in vars(chipmunk).items()
    if name.isupper()
    and not name.startswith("_")
    and isinstance(value, int)
    and not name.endswith(("_WORDS", "_BYTES"))
    if name not in ("FIRST", "CONSTRAINT_CLASS", "SHAPE_CLASS", "LIST_ITEMS", "SPACE_SHAPES")
]


def test_the_installed_pymunk_fits() -> None:
    verify()
    assert len(OFFSETS) > 60


@pytest.mark.parametrize("name", OFFSETS)
def test_a_field_that_lies_a_word_earlier_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chipmunk, name, getattr(chipmunk, name) - 1)
    with pytest.raises(IncompatiblePymunk, match="install version 7"):
        verify()


@pytest.mark.parametrize("kind", range(3))
def test_a_radius_that_lies_a_word_earlier_is_noticed(kind: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """That of a circle, a segment or a polygon."""
    words = tuple(word - (i == kind) for i, word in enumerate(chipmunk.SHAPE_RADIUS))
    monkeypatch.setattr(chipmunk, "SHAPE_RADIUS", words)
    with pytest.raises(IncompatiblePymunk, match="install version 7"):
        verify()
