"""Hard cases: finite, converged, within yield, no energy from nowhere, momenta kept (docs/hard-cases.md)."""

import re
from pathlib import Path

import pytest
from hard_case_table import CASES, run

DOCS = Path(__file__).parent.parent / "docs" / "hard-cases.md"


@pytest.mark.parametrize("name", CASES)
def test_hard_case(name: str) -> None:
    case = CASES[name]()
    found = run(case)
    assert found.unconverged == 0
    assert found.outside <= 1e-9
    assert found.gap <= 1e-12
    assert found.created <= 1e-12
    assert found.momentum <= 1e-14
    if name == "N, Q and M at their limits at once":
        assert case.structure.utilisation == pytest.approx(1.0, abs=1e-9)
    if name == "everything breaks in one step":
        assert found.broken == len(case.structure.joints)


def test_contacts_and_joints_agree_in_few_turns() -> None:
    """What sweeps over contacts leave would be found as a change in every turn, one joint solve each."""
    assert run(CASES["a weak bar falls on the ground, e = 0"]()).newton < 7.0


def test_the_table_lists_every_case() -> None:
    rows = re.findall(r"^\| ([^|]+) \| \d+ \|", DOCS.read_text(), re.MULTILINE)
    assert rows == list(CASES)
