"""Compiled once, kept on disk, and the first time by two processes; what goes wrong there only costs time."""

import subprocess
import sys
from pathlib import Path

import pytest
from numba import types

from sim import compiling
from sim.compiling import Ahead, compiled

ROOT = Path(__file__).parent.parent


def test_nothing_is_compiled_twice() -> None:
    """A second process takes every callback, and the law it uses, from the cache."""
    code = (
        "import pymunk, sim\n"
        "from sim.kernels import compiled_callbacks\n"
        "from sim.laws import elastic_plastic\n"
        "space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)\n"
        "law = sim.ElasticPlastic((1e6, 1e6, 1e4), (1e4, 1e4, 1e3))\n"
        "space.add(body, sim.DuctileJoint(space.static_body, body, (0.0, 0.0), law))\n"
        "space.step(0.01)\n"
        "laws = elastic_plastic.respond.compiled, elastic_plastic.commit.compiled\n"
        "assert [own.cache_hits for own in (*compiled_callbacks().owners, *laws)] == [1] * 8\n"
        "assert 'compiled' not in vars(sim.laws.fibre.respond), 'a law that is not used'\n"
    )
    for _ in range(2):  # the first may have to fill the cache
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=False)
        if done.returncode == 0:
            break
    assert done.returncode == 0, done.stderr


def test_without_a_folder_to_write_to_it_compiles_and_says_so() -> None:
    names: dict[str, object] = {}
    exec("def twice(x):\n    return 2 * x", names)  # Numba finds no file that it could keep a cache beside
    with pytest.warns(UserWarning, match="set NUMBA_CACHE_DIR"):
        twice = compiled(types.int64(types.int64), names["twice"])
    assert twice.ctypes(21) == 42


@pytest.fixture
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiling, "_cores", lambda: 2)


@pytest.mark.usefixtures("two_cores")
def test_another_process_works_ahead_and_starts_none_itself(tmp_path: Path) -> None:
    """It finds the same packages, and is told that it is one."""
    out = tmp_path / "out"
    ahead = Ahead(
        f"import os; from sim import compiling; open({str(out)!r}, 'w').write(os.environ[compiling._HELPING])"
    )
    ahead.wait()
    assert out.read_text() == "1"


@pytest.mark.usefixtures("two_cores")
@pytest.mark.parametrize("why", ["one core", "helping", "frozen", "no python", "gone"])
def test_no_process_where_it_is_no_use(why: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    match why:
        case "one core":
            monkeypatch.setattr(compiling, "_cores", lambda: 1)
        case "helping":
            monkeypatch.setenv(compiling._HELPING, "1")
        case "frozen":
            monkeypatch.setattr(sys, "frozen", True, raising=False)
        case "no python":
            monkeypatch.setattr(sys, "executable", str(tmp_path / "game"))
        case _:
            monkeypatch.setattr(sys, "executable", str(tmp_path / "python3"))
    ahead = Ahead("raise SystemExit")
    assert ahead._process is None
    ahead.wait()


@pytest.mark.usefixtures("two_cores")
def test_a_process_that_fails_or_hangs_is_left_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    Ahead("raise RuntimeError").wait()
    monkeypatch.setattr(compiling, "_AT_LEAST", 0.1)
    monkeypatch.setattr(compiling, "_PATIENCE", 0.0)
    ahead = Ahead("import time; time.sleep(600)")
    ahead.wait()
    assert ahead._process is not None
    assert ahead._process.returncode != 0
