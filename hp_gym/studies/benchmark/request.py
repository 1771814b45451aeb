"""What `hp-gym benchmark` does, without the terminal."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

import hp_gym
from hp_gym import comfort_standard, toml_files, transactions
from hp_gym.agents.controllers import DEFAULTS, Controller, ControllerError, learned, resolve
from hp_gym.agents.controllers.registry import RULES_SUFFIX
from hp_gym.agents.controllers.rule_based import FILES
from hp_gym.overrides import assignments
from hp_gym.studies.benchmark import benchmark_plan, drive, grid, results_folder
from hp_gym.studies.benchmark.report import write_report

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.console import Console

    from hp_gym.studies.benchmark.results import Benchmark


@dataclass(frozen=True)
class Request:
    """What was asked for on the command line; see `hp-gym benchmark --help`."""

    controllers: Sequence[str] | None
    grid: str
    seeds: Sequence[int] | None
    seed: int
    out: Path
    allow_code: bool = False
    """Whether zip files of stable-baselines3 are loaded, which can run code."""
    overrides: Path | None = None
    """File of changes to the car, in all trips."""

    def words(self) -> str:
        """The command, without the folder of results: that does not change them."""
        parts = ["hp-gym benchmark", *(self.controllers or [])]
        if self.grid != grid.DEFAULT_GRID:
            parts.append(f"--grid {self.grid}")
        if self.seeds is not None:
            parts.append(f"--seeds {','.join(map(str, self.seeds))}")
        if self.seed:
            parts.append(f"--seed {self.seed}")
        if self.allow_code:
            parts.append("--allow-code")
        if self.overrides is not None:
            parts.append(f"--overrides {self.overrides}")
        return " ".join(parts)


@dataclass(frozen=True)
class Done:
    """A finished benchmark.

    Attributes:
        benchmark: Its results, which are written.
        trips: Trips that were driven, those of the fronts included.
        simulated_s: Time that they took in the plant.
        wall_s: Time that everything took.
    """

    benchmark: Benchmark
    trips: int
    simulated_s: float
    wall_s: float


def carry_out(request: Request, console: Console) -> Done:
    """Runs a benchmark and writes its results.

    Args:
        request: What to do.
        console: Where progress is shown.

    Raises:
        ValueError: A controller, grid or seed is not accepted.
        OSError: The folder of results cannot be written to; earlier results are intact.
    """
    began_s = perf_counter()
    found = grid.load(request.grid)
    changes = _changes(request)
    drivers = [controller.with_overrides(changes) for controller in controllers(request, console)]
    plan = benchmark_plan.Plan(found, drivers, request.words(), request.seed, overrides=changes)
    with transactions.new_contents(request.out) as folder:
        with _bar(console) as bar:
            task = bar.add_task("trips", total=None)

            def begin(total: int) -> drive.Progress:
                bar.update(task, total=total)
                return lambda done: bar.advance(task, done)

            benchmark, front_runs = benchmark_plan.run(plan, folder, begin)
        results_folder.write(benchmark, front_runs, folder)
        write_report(benchmark, folder / results_folder.REPORT)
        simulated_s = sum(
            float(runs["duration_s"].sum()) for runs in (benchmark.runs, front_runs) if len(runs)
        )
        wall_s = perf_counter() - began_s
        results_folder.write_json(
            {
                "finished": datetime.datetime.now(tz=datetime.UTC).isoformat(timespec="seconds"),
                "wall_s": wall_s,
                "simulated_s": simulated_s,
            },
            folder / results_folder.RUN,
        )
    return Done(benchmark, len(benchmark.runs) + len(front_runs), simulated_s, wall_s)


def controllers(request: Request, console: Console) -> list[Controller]:
    """Finds the controllers that were asked for, and the rules that others are compared with.

    Raises:
        ControllerError: One that was asked for is not there. Of the default ones, those are left out with a
            remark whose file has not come yet.
    """
    rules = hp_gym.names("controller")
    names = request.controllers
    if not names:
        names = DEFAULTS
        missing = [name for name in FILES if name not in rules]
        missing += [] if learned.reference_is_shipped() else [learned.REFERENCE]
        for name in missing:
            console.print(f"No `{name}` yet: there is no file of it. The others run without it.")
        names = [name for name in names if name not in missing]
    names = [comfort_standard.REFERENCE if _is_reference(name) else name for name in names]
    chosen = [
        controller
        for name in benchmark_plan.needed_rules(dict.fromkeys(names), rules)
        for controller in resolve(name, seed=request.seed, seeds=request.seeds, allow_code=request.allow_code)
    ]
    return chosen + (learned.ablations() if learned.REFERENCE in names else [])


def _is_reference(name: str) -> bool:
    """Whether a controller file is that of the reference, which always runs.

    Raises:
        ControllerError: It has the reference's name only.
    """
    path, reference = Path(name), comfort_standard.REFERENCE
    if path.suffix != RULES_SUFFIX or path.stem != reference or not path.is_file():
        return False
    theirs, ours = ([tables for _, tables in toml_files.chain("controller", of)] for of in (name, reference))
    if theirs != ours:
        raise ControllerError(
            f"controller `{name}` differs from `{reference}`, which comfort is judged by; "
            "give its file another name"
        )
    return True


def _changes(request: Request) -> list[str]:
    """Changes to the car, `key=value`.

    Raises:
        ControllerError: One would change the trips, which are the grid's.
    """
    changes = assignments(request.overrides)
    for change in changes:
        if change.startswith("scenario."):
            key = change.partition("=")[0]
            raise ControllerError(
                f"{request.overrides}: `{key}` would change the held-out trips; only the car may differ"
            )
    return changes


def _bar(console: Console) -> Progress:
    columns = (TextColumn("driving"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    return Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
