"""What a person sees while the work goes on, on standard error."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

_PATIENCE = 2.0


@contextmanager
def progress_bar(console: Console) -> Iterator[Callable[[str, float], None]]:
    """A bar on ``console``; yields the function that moves it, called with what is being done and its share done."""
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TextColumn("left:"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting", total=1.0)

        def watch(what: str, share: float) -> None:
            bar.update(task, description=what, completed=share)

        yield watch


@contextmanager
def explained_compilation(console: Console) -> Iterator[None]:
    """Compile the joint kernels after what is done within, and say why that takes so long, if it does."""
    timer = threading.Timer(
        _PATIENCE,
        console.print,
        args=["Compiling the joint kernels for this machine: up to a minute, once. Later runs load a cache."],
    )
    timer.daemon = True
    timer.start()
    try:
        yield
        from sim.kernels import compiled_callbacks

        compiled_callbacks()
    finally:
        timer.cancel()
