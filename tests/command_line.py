"""The command line, called from within."""

import pytest

from calibration.cli import main


def ductile(*tokens: str) -> int:
    """The status that `ductile` ends with."""
    with pytest.raises(SystemExit) as end:
        main(tokens)
    return int(end.value.code or 0)
