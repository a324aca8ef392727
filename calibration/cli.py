"""The command line: ``ductile``. Every command is a file of `calibration.commands`."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

from cyclopts import App, CycloptsError
from rich.console import Console

from calibration.commands.calibrate import calibrate
from calibration.commands.capacity import capacity
from calibration.commands.compare import compare
from calibration.commands.export import export
from calibration.commands.fit import fit
from calibration.commands.reference import reference
from calibration.commands.scenes import scenes
from calibration.commands.simulate import simulate
from calibration.commands.study import study
from capacity.errors import InputError

app = App(
    name="ductile",
    help="Joints for rigid-body simulations that yield and tear as steel does, held against an elastic–plastic FEM.",
    version_flags=["--version"],
    result_action="return_value",
)
for command in (capacity, scenes, reference, simulate, calibrate, fit, compare, study, export):
    app.command(command)


def _run(tokens: Sequence[str] | None) -> int:
    return int(app(tokens, exit_on_error=False, print_error=False) or 0)


def main(tokens: Sequence[str] | None = None, run: Callable[[Sequence[str] | None], int] = _run) -> None:
    """Entry point of the command; exits with 0 (done), 1 (done, but the target was missed) or 2 (bad input)."""
    try:
        status = run(tokens)
    except InputError as error:
        status = _refuse(str(error))
    except CycloptsError as error:
        status = _refuse(f"{error} (see `ductile --help`)")
    except KeyboardInterrupt:
        status = 130
    except RuntimeError as error:
        from fem_reference import NotConverged
        from sim import SolverError

        if not isinstance(error, (NotConverged, SolverError)):
            raise
        status = _refuse(str(error))
    sys.exit(status)


def _refuse(message: str) -> int:
    Console(stderr=True, soft_wrap=True, highlight=False).print(f"ductile: {message}", markup=False)
    return 2


if __name__ == "__main__":
    main()
