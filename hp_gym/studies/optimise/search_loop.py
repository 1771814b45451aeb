"""The engine of searches, for `optimise` and `tune`: values drawn by Optuna in batches, driven, told."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import optuna
from optuna.distributions import BaseDistribution, CategoricalDistribution, FloatDistribution
from optuna.trial import TrialState

from hp_gym.overrides import Value
from hp_gym.studies.axes import Axis, Between, is_number
from hp_gym.studies.optimise import trial_store

Changes: TypeAlias = dict[str, Value]
"""Values by key."""


@dataclass(frozen=True)
class Outcome:
    """What a trial gave.

    Attributes:
        values: Of the goals.
        beyond: By how much each constraint is broken.
        refusal: Why its values are not accepted, if they are not; then there is nothing else.
    """

    values: Sequence[float] = ()
    beyond: Sequence[float] = ()
    refusal: str | None = None


Drive: TypeAlias = Callable[[Sequence[Changes]], Sequence[Outcome]]
"""Drives what was drawn; an outcome each."""


def of_one_process(seed: int, startup: int) -> optuna.Study:
    """Returns a search in memory for one goal that is made large, whose first trials are drawn at random."""
    # Its warnings are tracebacks of trials that Ctrl-C ended.
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    sampler = optuna.samplers.TPESampler(seed=seed, multivariate=True, n_startup_trials=startup)
    return optuna.create_study(sampler=sampler, direction="maximize")


def search(
    study: optuna.Study,
    axes: Sequence[Axis],
    drive: Drive,
    trials: int,
    *,
    batch: int = 1,
    seen: Callable[[int], None] = lambda _: None,
) -> None:
    """Draws, drives and notes until a search has its trials.

    Args:
        study: The search; other processes may work on it, too.
        axes: What may vary.
        drive: Who drives.
        trials: Trials, those that it has included.
        batch: Trials that are drawn and driven at a time.
        seen: Told of the trials that there are, after each batch.
    """
    ended = (TrialState.COMPLETE, TrialState.FAIL)
    while (done := len(study.get_trials(deepcopy=False, states=ended))) < trials:
        asked = [study.ask(distributions(axes)) for _ in range(min(batch, trials - done))]
        outcomes = drive([changes(axes, trial.params) for trial in asked])
        for trial, outcome in zip(asked, outcomes, strict=True):
            if outcome.refusal is not None:
                # Values that are right one by one need not be so together: others are tried.
                trial.set_user_attr(trial_store.REFUSED, outcome.refusal)
                study.tell(trial, state=TrialState.FAIL)
                continue
            trial_store.note_excesses(trial, list(outcome.beyond))
            study.tell(trial, outcome.values)
        seen(done + len(asked))


def distributions(axes: Sequence[Axis]) -> dict[str, BaseDistribution]:
    """What Optuna draws from; of choices their places."""
    return {
        axis.name: FloatDistribution(axis.values.low, axis.values.high)
        if isinstance(axis.values, Between)
        else CategoricalDistribution(range(len(axis.values)))
        for axis in axes
    }


def as_drawn(axes: Sequence[Axis], values: Mapping[str, Any]) -> dict[str, float | int] | None:
    """Values by key as a trial has them; None where one is missing or out of range."""
    drawn: dict[str, float | int] = {}
    for axis in axes:
        value = values.get(axis.keys[0])
        if not isinstance(axis.values, Between):
            if value not in axis.values:
                return None
            drawn[axis.name] = axis.values.index(value)
        elif is_number(value) and axis.values.low <= value <= axis.values.high:
            drawn[axis.name] = float(value)
        else:
            return None
    return drawn


def changes(axes: Sequence[Axis], drawn: Mapping[str, Any]) -> Changes:
    """Values by key of what was drawn."""
    found: Changes = {}
    for axis in axes:
        value = drawn[axis.name]
        found |= axis.changes(value if isinstance(axis.values, Between) else axis.values[value])
    return found
