"""The search: values drawn in batches, driven on native threads, noted in the shared file."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import optuna
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from hp_gym.build_identity import build
from hp_gym.json_text import plain
from hp_gym.overrides import Overrides, Value, assignments
from hp_gym.studies import planned_runs
from hp_gym.studies.axes import Axis, Base, Between, axes_of, require_accepted
from hp_gym.studies.optimise import goals, search_loop, trial_store
from hp_gym.studies.optimise.found import Found
from hp_gym.studies.optimise.goals import Goal, Limit
from hp_gym.studies.optimise.search_loop import Outcome
from hp_gym.studies.optimise.trial_store import OptimiseError
from hp_gym.studies.planned_runs import REFUSED, Totals
from hp_gym.terminal import progress_console

_BATCH: Final = 8
"""Trials that are driven at a time; those of a killed process are lost."""


def optimise(
    axes: Mapping[str, Any],
    goal: str | Sequence[str] = "energy_kwh",
    scenario: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = "jeffs2019/case1-1",
    *,
    constraints: Sequence[str] = (),
    controller: str | os.PathLike[str] | None = None,
    vehicle: str | os.PathLike[str] | None = None,
    overrides: Overrides | None = None,
    trials: int = 300,
    seed: int = 0,
    out: str | os.PathLike[str] = "out/optimise",
    threads: int | None = None,
) -> Found:
    """Searches values for one goal, or the front of several.

    The same call goes on with the trials in the folder, and several processes may make it side by side.

    Args:
        axes: What may vary, by key: a `Between`, two numbers in a tuple, or a list of choices; see
            `hp_gym.studies.axes.axes_of`.
        goal: Totals, one or several: `KPI` (made small) or `max:KPI`.
        scenario: Name or path of a scenario, or several: totals are means over their trips.
        constraints: `KPI<=VALUE` or `KPI>=VALUE`. All trips must arrive in any case.
        controller: Name or path of a controller; the scenario's own by default.
        vehicle: Name or path of a vehicle; the scenario's own by default.
        overrides: Changes for all runs.
        trials: Trials of all processes together, those that are in the folder included.
        seed: Seed of the search.
        out: Folder for the trials.
        threads: Native threads; one a processor by default.

    Raises:
        ValueError: A key, range, goal or constraint is not accepted, or the folder holds another search.
        OSError: The folder cannot be written to.
    """
    task = _task(axes, goal, scenario, constraints, (controller, vehicle, overrides, seed))
    if trials < 1 or (threads is not None and threads < 1):
        raise OptimiseError("trials and threads must be at least 1")
    folder = Path(out)
    directions = [each.direction for each in task.goals]
    study, number = trial_store.join(folder, task.definition(), directions)
    study.sampler = task.sampler(number)
    # What the files say is tried first.
    if number == 0 and (present := search_loop.as_drawn(task.axes, task.bases[0].values())) is not None:
        study.enqueue_trial(present)
    _search(study, task, trials, threads or planned_runs.processors())
    return Found(folder)


@dataclass(frozen=True)
class Task:
    """A search: what may vary, what is driven, what is wanted."""

    bases: tuple[Base, ...]
    axes: tuple[Axis, ...]
    goals: tuple[Goal, ...]
    limits: tuple[Limit, ...]
    seed: int

    def definition(self) -> dict[str, Any]:
        """All that the trials depend on, as JSON can hold it."""
        first = self.bases[0]
        axes = [
            {
                "name": axis.name,
                "keys": axis.keys,
                "unit": axis.unit,
                "values": [axis.values.low, axis.values.high]
                if isinstance(axis.values, Between)
                else {"choices": axis.values},
            }
            for axis in self.axes
        ]
        described: dict[str, Any] = plain(
            {
                "scenarios": [base.scenario for base in self.bases],
                "controller": first.controller,
                "vehicle": first.vehicle,
                "overrides": first.overrides,
                "axes": axes,
                "goals": [{"kpi": goal.kpi, "larger": goal.larger} for goal in self.goals],
                "constraints": [
                    {"kpi": limit.kpi, "bound": limit.bound, "most": limit.most} for limit in self.limits
                ],
                "seed": self.seed,
                "build": build(),
            }
        )
        return described

    def sampler(self, number: int) -> optuna.samplers.BaseSampler:
        """TPE for one goal, NSGA-II for several; every process draws its own numbers."""
        seed = int(np.random.SeedSequence([self.seed, number]).generate_state(1)[0])
        told: dict[str, Any] = trial_store.constraints_argument()
        if len(self.goals) > 1:
            return optuna.samplers.NSGAIISampler(population_size=32, seed=seed, **told)
        return optuna.samplers.TPESampler(seed=seed, multivariate=True, n_startup_trials=24, **told)

    @property
    def kpis(self) -> list[str]:
        """Totals of goals and constraints."""
        return list(dict.fromkeys([*(goal.kpi for goal in self.goals), *(lim.kpi for lim in self.limits)]))


def _task(
    axes: Mapping[str, Any],
    goal: str | Sequence[str],
    scenario: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    constraints: Sequence[str],
    others: tuple[str | os.PathLike[str] | None, str | os.PathLike[str] | None, Overrides | None, int],
) -> Task:
    """Checks what was asked for, before anything is written."""
    controller, vehicle = (None if name is None else os.fspath(name) for name in others[:2])
    scenarios = [scenario] if isinstance(scenario, str | os.PathLike) else list(scenario)
    if not scenarios:
        raise OptimiseError("there is no scenario")
    changes = tuple(assignments(others[2]))
    bases = tuple(Base(os.fspath(name), controller, vehicle, changes) for name in scenarios)
    described = {
        key: Between(float(values[0]), float(values[1])) if _is_pair(values) else values
        for key, values in axes.items()
    }
    found = axes_of(described, bases[0])
    wanted = tuple(goals.goal(text) for text in ([goal] if isinstance(goal, str) else goal))
    if not wanted:
        raise OptimiseError("there is no goal")
    if len({each.kpi for each in wanted}) < len(wanted):
        raise OptimiseError("a goal appears twice")
    task = Task(bases, found, wanted, tuple(goals.limit(text) for text in constraints), others[3])
    first: dict[str, Value] = {}
    for axis in found:
        first |= axis.changes(axis.probes()[0])
    for base in bases:
        require_accepted(found, base)
        planned_runs.require_kpis(task.kpis, base, first)
    return task


def _is_pair(values: object) -> bool:
    numbers = isinstance(values, tuple) and all(isinstance(value, int | float) for value in values)
    return numbers and isinstance(values, tuple) and len(values) == 2


def _search(study: optuna.Study, task: Task, trials: int, threads: int) -> None:
    columns = (
        TextColumn("searching"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    shown = progress_console.is_terminal
    with Progress(*columns, console=progress_console, transient=True, disable=not shown) as progress:
        bar = progress.add_task("trials", total=trials)
        search_loop.search(
            study,
            task.axes,
            lambda batch: _drive(task, batch, threads),
            trials,
            batch=_BATCH,
            seen=lambda done: progress.update(bar, completed=done),
        )


def _drive(task: Task, batch: Sequence[Mapping[str, Value]], threads: int) -> list[Outcome]:
    runs = [base.run(changes) for changes in batch for base in task.bases]
    totals = planned_runs.drive(runs, threads, task.bases[0].substeps)
    count = len(task.bases)
    return [_outcome(task, totals, range(place, place + count)) for place in range(0, len(runs), count)]


def _outcome(task: Task, totals: Totals, rows: range) -> Outcome:
    """Values of the goals, and by how much each constraint is broken, trips that did not arrive first."""
    for row in rows:
        if totals.ends[row] == REFUSED:
            return Outcome(refusal=totals.refusals[row])
    beyond = [float(goals.stranded(totals, rows))]
    beyond += [limit.excess(goals.over_trips(limit.kpi, totals, rows)) for limit in task.limits]
    values = [goals.over_trips(goal.kpi, totals, rows) for goal in task.goals]
    for place, value in enumerate(values):
        if not np.isfinite(value):
            # Worse than anything, in numbers that a database takes; and not allowed.
            values[place] = -1e12 if task.goals[place].larger else 1e12
            beyond[0] = max(beyond[0], 1.0)
    return Outcome(values, [min(excess, 1e12) for excess in beyond])
