"""The gallery has every scene, with a picture and figures, and one command makes it."""

import runpy
from pathlib import Path

import pytest
from PIL import Image

from scene import builtin_names, load_scene

DOCS = Path(__file__).parent.parent / "docs"


def test_every_scene_is_in_the_gallery() -> None:
    page = (DOCS / "gallery.md").read_text(encoding="utf-8")
    for name in builtin_names():
        assert f"## {name}\n\n{load_scene(name).title}." in page, f"python docs/make_gallery.py {name}"
        with Image.open(DOCS / "images" / "gallery" / f"{name}.png") as picture:
            assert picture.width == 800


def test_the_command_makes_a_part_again_and_keeps_the_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gallery = runpy.run_path(str(DOCS / "make_gallery.py"))
    space = gallery["main"].__globals__
    monkeypatch.setitem(space, "PAGE", tmp_path / "gallery.md")
    monkeypatch.setitem(space, "PICTURES", tmp_path)
    (tmp_path / "gallery.md").write_text("# Gallery\n\n## cantilever\n\nkept\n\n## block-under-tension\n\nold\n")
    gallery["main"](["block-under-tension"])
    page = (tmp_path / "gallery.md").read_text(encoding="utf-8")
    assert "## cantilever\n\nkept\n" in page
    assert "old" not in page
    assert "| impulse in the end | 1 kN s |" in page or "| impulse in the end | 1000 N s |" in page
    assert (tmp_path / "block-under-tension.png").exists()
