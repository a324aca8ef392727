"""What the page on joints in pymunk shows runs as it stands."""

import re
from pathlib import Path
from typing import Any

import sim

PAGE = Path(__file__).parent.parent / "docs" / "joints-in-pymunk.md"


def test_snippets_run_one_after_the_other() -> None:
    text = PAGE.read_text(encoding="utf-8")
    names: dict[str, Any] = {}
    snippets = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    assert len(snippets) == 5
    for snippet in snippets:
        exec(compile(snippet, str(PAGE), "exec"), names)
    N, Q, M = names["joint"].force
    assert Q < 0.0
    assert M < 0.0
    assert abs(N) < 0.01 * abs(Q)
    assert [law.name for law in names["laws"]] == list(sim.LAWS)
    assert names["sprung"].law.elastic_tangent()[5] > 0.0
    assert len(names["worst"]) == len(names["arrays"].joints) > 10


def test_every_law_and_rule_is_listed() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name in (*sim.LAWS, *sim.RULES):
        assert f'`"{name}"`' in text
    for name in ("active_limit", "utilisation", "elastic_deformation", "plastic_deformation", "capacity_used"):
        assert hasattr(sim.DuctileJoint, name)
        assert f"joint.{name}" in text
