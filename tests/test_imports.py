"""Imports go one way: scene and capacity feed fem_reference and sim, calibration sits on all of them."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = ("capacity", "scene", "fem_reference", "sim", "calibration")
MAY_IMPORT = {
    "capacity": set(),
    "scene": {"capacity"},
    "fem_reference": {"scene", "capacity"},
    "sim": {"scene", "capacity"},
    "calibration": {"scene", "capacity", "fem_reference", "sim"},
}
WORKS_WITHOUT = {
    "capacity": ("pymunk", "skfem", "numba"),
    "scene": ("pymunk", "skfem", "numba"),
    "fem_reference": ("pymunk",),
    "sim": ("skfem",),
}


def imported(path: Path) -> set[str]:
    """Top-level packages that a file imports anywhere in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import hides where it goes"
            names.add((node.module or "").split(".")[0])
    return names


def run(code: str) -> None:
    """In a process of its own, without a fault."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr


def run_without(heavy: tuple[str, ...], code: str) -> None:
    """So that none of these modules is loaded in the end."""
    run(f"{code}import sys; loaded = set({heavy!r}) & set(sys.modules); assert not loaded, loaded")


@pytest.mark.parametrize("package", PACKAGES)
def test_imports_go_downstream_only(package: str) -> None:
    files = list((ROOT / package).rglob("*.py"))
    assert files
    for path in files:
        forbidden = (imported(path) & set(PACKAGES)) - MAY_IMPORT[package] - {package}
        assert not forbidden, f"{path.relative_to(ROOT)} imports {forbidden}"


@pytest.mark.parametrize("package", WORKS_WITHOUT)
def test_package_works_without_what_it_does_not_need(package: str) -> None:
    blocked = WORKS_WITHOUT[package]
    run(f"import sys; sys.modules.update(dict.fromkeys({blocked!r})); import {package}")


def test_only_three_files_know_cffi() -> None:
    for path in (ROOT / "sim").rglob("*.py"):
        if path.name not in ("chipmunk.py", "shape_copies.py", "installed.py"):
            assert "_chipmunk_cffi" not in path.read_text(encoding="utf-8"), path


def test_command_line_starts_without_the_heavy_libraries() -> None:
    run_without(
        ("numba", "skfem", "scipy.linalg", "matplotlib", "pymunk", "shapely", "meshio"),
        "from calibration.cli import main\n"
        "try: main(['capacity', 'IPE 300', '--json'])\n"
        "except SystemExit as end: assert end.code == 0\n",
    )


def test_joints_of_plain_numbers_start_without_what_they_do_not_need() -> None:
    run_without(
        ("skfem", "matplotlib", "pint", "meshio"),
        "import pymunk, sim\n"
        "space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)\n"
        "law = sim.ElasticPlastic((1e6, 1e6, 1e4), (1e3, 1e3, 1e2))\n"
        "space.add(body, sim.DuctileJoint(space.static_body, body, (0.0, 0.0), law))\n"
        "space.step(1 / 60)\n",
    )


@pytest.mark.parametrize(
    ("folder", "table", "name"), [("sim", "README.md", "`{}.py`"), ("sim/kernels", "__init__.py", "``{}``")]
)
def test_every_file_of_the_solver_is_explained(folder: str, table: str, name: str) -> None:
    text = (ROOT / folder / table).read_text(encoding="utf-8")
    files = {path.stem for path in (ROOT / folder).glob("*.py")} - {"__init__"}
    assert not {stem for stem in files if name.format(stem) not in text}
