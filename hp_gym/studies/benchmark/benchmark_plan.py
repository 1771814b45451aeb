"""A benchmark from controllers to results."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from threadpoolctl import threadpool_limits

from hp_gym.agents.controllers import DEFAULTS, ControllerError
from hp_gym.agents.controllers.learned import ABLATION
from hp_gym.agents.controllers.learned import REFERENCE as SHIPPED
from hp_gym.agents.controllers.rule_based import FILES
from hp_gym.comfort_standard import REFERENCE
from hp_gym.studies.benchmark import environment_facts, statistics, summary, verdicts
from hp_gym.studies.benchmark.drive import drive_all, trajectories
from hp_gym.studies.benchmark.fronts import OFFSETS, settings
from hp_gym.studies.benchmark.headline_claim import Claims
from hp_gym.studies.benchmark.results import Benchmark

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

    import pandas as pd

    from hp_gym.agents.controllers import Controller
    from hp_gym.studies.benchmark.drive import Progress, Task
    from hp_gym.studies.benchmark.fronts import Setting
    from hp_gym.studies.benchmark.grid import Grid

RESAMPLES: Final = 2000


@dataclass(frozen=True)
class Plan:
    """What a benchmark does.

    Attributes:
        grid: Trips.
        controllers: Who drives them; the paper's HPCU and the reference of comfort must be among them.
        command: What was asked for, in words of the command line.
        seed: Seed of the resamples (that of the controller `random` is its own).
        resamples: How many.
        overrides: What differs in the car of all trips; the controllers know it.
    """

    grid: Grid
    controllers: Sequence[Controller]
    command: str
    seed: int = 0
    resamples: int = RESAMPLES
    overrides: Sequence[str] = ()


def run(
    plan: Plan, folder: Path, begin: Callable[[int], Progress] = lambda _: lambda _: None
) -> tuple[Benchmark, pd.DataFrame]:
    """Drives all controllers over all trips, and the rules with other set points over the headline's.

    Args:
        plan: What to do.
        folder: Where `scenarios/` and `controllers/` are written.
        begin: Told of the number of trips; returns what is told of those that have ended.

    Returns:
        The results, and the runs of the rules with other set points, one row each.

    Raises:
        ControllerError: Two controllers have the same name and seed, the paper's HPCU or the reference of
            comfort is missing, an environment cannot be made, or actions do not fit.
        OSError: The folder cannot be written to.
    """
    import pandas as pd

    _check(plan.controllers)
    grid = plan.grid
    files = grid.write(folder / "scenarios")
    names = {controller.name for controller in plan.controllers}
    rivals = [
        setting
        for front in grid.fronts
        if front.family in names
        for setting in settings(front, folder / "controllers")
    ]
    heating = [scenario for scenario in grid.scenarios if scenario.band.headline]
    tasks: list[Task] = [(controller, grid.scenarios) for controller in plan.controllers]
    tasks += [(setting.controller.with_overrides(plan.overrides), heating) for setting in rivals]
    progress = begin(sum(len(scenarios) for _, scenarios in tasks))
    # Controllers already share the cores; threads of a linear algebra library would only wait for each other,
    # and its sums would depend on their number.
    with threadpool_limits(1):
        rows = drive_all(tasks, files, progress)
        shown = _trajectories(plan, files)
    runs = verdicts.judged(pd.DataFrame([row for driven in rows[: len(plan.controllers)] for row in driven]))
    front_runs = _front_runs(rivals, rows[len(plan.controllers) :])
    resamples = statistics.resample(
        [scenario.ambient_temperature_degc for scenario in grid.scenarios], plan.resamples, plan.seed
    )
    evidence = summary.Evidence(grid, runs, front_runs, resamples)
    fronts = summary.front_table(evidence)
    learned = list(dict.fromkeys(each.name for each in plan.controllers if each.learned))
    ablations = [name for name in learned if name.startswith(ABLATION)]
    ablation_gains = summary.all_gains(evidence, ablations) or None
    claimed = [name for name in learned if name not in ablations]
    found = _summary(plan, evidence, claimed, ablation_gains)
    return Benchmark(runs, fronts, found, shown, ablation_gains), front_runs


def _summary(
    plan: Plan, evidence: summary.Evidence, learned: Sequence[str], ablations: dict[str, Any] | None
) -> dict[str, Any]:
    return {
        **_claims(plan, evidence.runs, learned).figures(),
        "gains": summary.all_gains(evidence, [*learned, *_own_rules(plan)]),
        "limit_breaches": summary.counts(evidence.runs, "limit_breaches"),
        "stranded_trips": summary.counts(evidence.runs, "stranded"),
        "controllers": summary.controllers(evidence),
        "ablations": ablations,
        "grid": summary.grid_facts(plan.grid),
        "bootstrap": {"resamples": plan.resamples, "seed": plan.seed, "strata": "ambient temperature"},
        "clusters": clusters(plan.grid),
        "command": plan.command,
        "overrides": list(plan.overrides),
        "versions": environment_facts.versions(),
        "hardware": environment_facts.hardware(),
    }


def _own_rules(plan: Plan) -> list[str]:
    """Rules of the user's own: they get the same rows as what has learned."""
    return list(
        dict.fromkeys(each.name for each in plan.controllers if each.rules and each.name not in DEFAULTS)
    )


def _claims(plan: Plan, runs: pd.DataFrame, learned: Sequence[str]) -> Claims:
    scenarios = plan.grid.scenarios
    resamples = statistics.resample_clusters(
        [(scenario.cycle.name, scenario.ambient_temperature_degc) for scenario in scenarios],
        [scenario.band.name for scenario in scenarios],
        plan.resamples,
        plan.seed,
    )
    rules = list(dict.fromkeys(each.name for each in plan.controllers if each.rules and not each.learned))
    return Claims(plan.grid, runs, resamples, rules, learned, shipped=SHIPPED, paper=summary.PAPER)


def clusters(grid: Grid) -> dict[str, int]:
    """Counts the clusters, pairs of cycle and ambient temperature, of each band: intervals rest on them."""
    pairs = {
        (scenario.cycle.name, scenario.ambient_temperature_degc): scenario.band for scenario in grid.scenarios
    }
    counted = {band.name: sum(of == band for of in pairs.values()) for band in grid.bands}
    return {name: count for name, count in counted.items() if count}


def _check(controllers: Iterable[Controller]) -> None:
    seen = set()
    for controller in controllers:
        key = (controller.name, controller.seed)
        if key in seen:
            raise ControllerError(f"controller `{controller.name}` is there twice")
        seen.add(key)
    for rules in (summary.PAPER, REFERENCE):
        if all(name != rules for name, _ in seen):
            raise ControllerError(f"`{rules}` must be among the controllers: others are compared with it")


def _front_runs(rivals: Sequence[Setting], rows: Sequence[Sequence[dict[str, Any]]]) -> pd.DataFrame:
    import pandas as pd

    told = [
        {**setting.columns(), **row} for setting, driven in zip(rivals, rows, strict=True) for row in driven
    ]
    return pd.DataFrame(told) if told else pd.DataFrame(columns=["family", *OFFSETS])


def _trajectories(plan: Plan, files: dict[str, Path]) -> dict[str, dict[str, pd.DataFrame]]:
    shown: dict[str, dict[str, pd.DataFrame]] = {name: {} for name in plan.grid.shown}
    scenarios = [scenario for scenario in plan.grid.scenarios if scenario.name in shown]
    # Of several training seeds the lowest is shown.
    for controller in sorted(plan.controllers, key=lambda each: each.seed):
        if controller.name in next(iter(shown.values()), {}) or controller.name.startswith(ABLATION):
            continue
        for name, table in trajectories(controller, scenarios, files).items():
            shown[name][controller.name] = table
    order = list(dict.fromkeys(controller.name for controller in plan.controllers))
    return {name: {each: told[each] for each in order if each in told} for name, told in shown.items()}


def needed_rules(names: Iterable[str], available: Iterable[str]) -> list[str]:
    """Names of controllers with the rules put first that others are compared with, where there are such."""
    given = list(names)
    compared = [summary.PAPER, REFERENCE, *(name for name in FILES[-2:] if name in available)]
    return [*(name for name in compared if name not in given), *given]
