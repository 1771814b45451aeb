"""The sweep itself: chunk by chunk, resumed where it was stopped."""

import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, Final

import pyarrow as pa
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from hp_gym import locks
from hp_gym.overrides import Overrides, assignments
from hp_gym.studies import planned_runs
from hp_gym.studies.axes import Base, axes_of, require_accepted
from hp_gym.studies.planned_runs import REFUSED, Planned, Totals
from hp_gym.studies.sweep.chunk_files import Folder, to_table
from hp_gym.studies.sweep.sweep_plan import Plan, SweepError
from hp_gym.studies.sweep.swept import Sweep
from hp_gym.terminal import progress_console

CHUNK_RUNS: Final = 500
"""Runs of a chunk: a second of two cores or so, which is lost where a sweep is killed."""

PLACES: Final = ("threads", "ray")
"""Where runs are driven."""

Watch = Callable[[pa.Table], object]
"""Told each chunk as it comes."""


def sweep(
    axes: Mapping[str, Any],
    scenario: str | os.PathLike[str] = "jeffs2019/case1-1",
    *,
    controller: str | os.PathLike[str] | None = None,
    vehicle: str | os.PathLike[str] | None = None,
    overrides: Overrides | None = None,
    substeps: int = 1,
    sample: str | None = None,
    count: int = 1024,
    seed: int = 0,
    out: str | os.PathLike[str] | None = None,
    on: str = "threads",
    threads: int | None = None,
    chunk_runs: int = CHUNK_RUNS,
    keep_refused: bool = False,
    kpis: Sequence[str] = (),
    watch: Watch | None = None,
) -> Sweep:
    """Drives runs over all combinations of values, or over a sample.

    A sweep that was stopped or killed goes on where it was if it is asked for with the same arguments again.

    Args:
        axes: Values by key, see `hp_gym.studies.axes.axes_of`; the last axis varies fastest.
        scenario: Name or path of a scenario.
        controller: Name or path of a controller; the scenario's own by default.
        vehicle: Name or path of a vehicle; the scenario's own by default.
        overrides: Changes for all runs.
        substeps: Steps of the plant in each second.
        sample: `latin-hypercube`, `sobol` or `saltelli`; all combinations by default.
        count: Points of the sample; a power of 2 for the last two. Of `saltelli` those of
            its base sample.
        seed: Seed of the sample.
        out: Folder for the results; by default one that lives as long as what is returned.
        on: `threads` of this machine, or `ray`.
        threads: Native threads; one a processor by default.
        chunk_runs: Runs that are driven and written at a time.
        keep_refused: Note runs that the plant refuses instead of ending the sweep with an error.
        kpis: Totals that will be looked at: checked before anything is driven.
        watch: Told each chunk as it comes.

    Returns:
        The results.

    Raises:
        ValueError: An axis, value or sample is not accepted, the folder holds another sweep or is in use.
        OSError: The folder cannot be written to; what was written before is intact.
        MissingExtraError: Ray is asked for and not installed.
    """
    if on not in PLACES:
        raise SweepError(f"on is `{on}`, but must be one of {', '.join(PLACES)}")
    if chunk_runs < 1 or (threads is not None and threads < 1):
        raise SweepError("chunk_runs and threads must be at least 1")
    base = Base(
        os.fspath(scenario),
        None if controller is None else os.fspath(controller),
        None if vehicle is None else os.fspath(vehicle),
        tuple(assignments(overrides)),
        substeps,
    )
    found = axes_of(axes, base)
    plan = Plan(base, found, sample, count if sample else 0, seed if sample else 0, keep_refused)
    if not keep_refused:
        require_accepted(found, base)
    if kpis:
        planned_runs.require_kpis(kpis, base, plan.changes(plan.point(0)))
    driver = _driver(on, threads or planned_runs.processors(), substeps)
    if out is not None:
        _carry_out(plan, Path(out), driver, chunk_runs, watch)
        return Sweep(out)
    path = Path(mkdtemp(prefix="hp-gym-sweep-"))
    try:
        _carry_out(plan, path, driver, chunk_runs, watch)
    except BaseException:
        shutil.rmtree(path, ignore_errors=True)
        raise
    return Sweep(path, temporary=True)


Driver = Callable[[Iterable[tuple[int, Sequence[Planned]]]], Iterator[tuple[int, Totals]]]
"""Drives numbered chunks and yields them as they come."""


def _driver(on: str, threads: int, substeps: int) -> Driver:
    if on == "ray":
        from hp_gym.studies.sweep.ray_runs import OnRay

        return OnRay(substeps).drive

    def drive(chunks: Iterable[tuple[int, Sequence[Planned]]]) -> Iterator[tuple[int, Totals]]:
        for number, runs in chunks:
            yield number, planned_runs.drive(runs, threads, substeps)

    return drive


def _carry_out(plan: Plan, path: Path, driver: Driver, chunk_runs: int, watch: Watch | None) -> None:
    folder = Folder(path)
    with locks.lock(path):
        definition = plan.definition()
        folder.begin(definition)
        if not folder.complete:
            _drive(plan, folder, driver, chunk_runs, watch)
            folder.finish(definition)


def _drive(plan: Plan, folder: Folder, driver: Driver, chunk_runs: int, watch: Watch | None) -> None:
    """Drives the runs that are in no chunk yet; a chunk is named by its first run."""
    there = folder.chunks()
    done = {run for path in there.values() for run in _runs_in(path)}
    missing = [range(first, last) for first, last in _gaps(done, plan.runs, chunk_runs)]
    columns = (TextColumn("driving"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    shown = progress_console.is_terminal
    if done:
        progress_console.print(f"Going on after {len(done):,} runs that were driven before.", soft_wrap=True)
    with Progress(*columns, console=progress_console, transient=True, disable=not shown) as progress:
        task = progress.add_task("runs", total=plan.runs, completed=len(done))
        chunks = ((runs.start, plan.planned(runs)) for runs in missing)
        lengths = {runs.start: runs for runs in missing}
        for first, totals in driver(chunks):
            runs = lengths[first]
            _require_driven(plan, runs, totals)
            table = to_table(plan, runs, totals)
            folder.write_chunk(first, table)
            progress.advance(task, len(runs))
            if watch is not None:
                watch(table)


def _runs_in(path: Path) -> Iterable[int]:
    from pyarrow import parquet

    runs: list[int] = parquet.read_table(path, columns=["run"]).column("run").to_pylist()
    return runs


def _gaps(done: set[int], runs: int, most: int) -> Iterator[tuple[int, int]]:
    """Stretches of runs that are not done, none longer than `most`."""
    first = 0
    while first < runs:
        if first in done:
            first += 1
            continue
        last = first
        while last < runs and last - first < most and last not in done:
            last += 1
        yield first, last
        first = last


def _require_driven(plan: Plan, runs: range, totals: Totals) -> None:
    """Checks that the plant refused none of the runs.

    Raises:
        SweepError: It did; the message names the values and the reason.
    """
    if plan.keep_refused or REFUSED not in totals.ends:
        return
    place = totals.ends.index(REFUSED)
    point = ", ".join(f"{name} {values[0]}" for name, values in plan.labels([runs[place]]).items())
    message = (
        f"run {runs[place]} ({point}): {totals.refusals[place]}; runs so far are kept, and keep_refused "
        "(--keep-refused) notes such runs instead"
    )
    raise SweepError(message)
