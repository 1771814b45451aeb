"""Progress of a fit on the terminal."""

from collections.abc import Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from hp_gym.studies.calibration import fit


@contextmanager
def bar(name: str, evaluations: int) -> Generator[fit.Progress]:
    """A bar of evaluations with the lowest cost, on standard error.

    Args:
        name: What is fitted.
        evaluations: How many evaluations there can be.
    """
    columns = (
        TextColumn(name),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("cost {task.fields[cost]:.3g}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(name, total=evaluations, cost=float("nan"))
        yield lambda done, cost: progress.update(task, completed=done, cost=cost)
