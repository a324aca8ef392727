"""Reference cases: inputs, results, uncertainties and sources, from closed forms and independent codes."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

# The same examples in every run; no deadline, for the first call of a kernel compiles it.
settings.register_profile("project", deadline=None, derandomize=True)
settings.load_profile("project")

CASES = {
    case["id"]: case
    for case in json.loads((Path(__file__).parent / "data" / "reference_cases.json").read_text(encoding="utf-8"))[
        "cases"
    ]
}


@pytest.fixture
def case() -> Callable[[str], dict[str, Any]]:
    """A reference case by its id."""
    return lambda name: CASES[name]
