"""The recipe for a law: what the page shows is a module outside the package, and a joint takes it."""

import importlib.util
import re
from pathlib import Path

import pymunk
import pytest

from sim import DuctileJoint

PAGE = Path(__file__).parent.parent / "docs" / "extending.md"


@pytest.mark.parametrize(("speed", "force"), [(1.0, 1000.0), (-1.0, 0.0)])
def test_the_law_on_the_page_pulls_and_does_not_push(tmp_path: Path, speed: float, force: float) -> None:
    """1 kg at 1 m/s on 1e6 N/m stretches it by v √(m / k), and N = v √(k m) at the most."""
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    file = tmp_path / "tendon.py"
    file.write_text(code, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("tendon", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)
    joint = DuctileJoint(space.static_body, body, (0.0, 0.0), module.Tendon(1e6), direction=0.0)
    space.add(body, joint)
    body.velocity = (speed, 0.0)
    most = 0.0
    for _ in range(400):
        space.step(1e-5)
        most = max(most, abs(joint.force[0]))
    assert most == pytest.approx(force, rel=0.02)
    assert joint.dissipated == 0.0
