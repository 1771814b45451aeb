"""The two searches: every combination of modes; and modes, set points and thresholds, as `optimise` does."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

from hp_gym.studies.axes import Axis
from hp_gym.studies.optimise import search_loop
from hp_gym.studies.tuning.objective import Objective
from hp_gym.studies.tuning.rule_choices import (
    AXES,
    BATTERY,
    COOLED_ABOVE_DEGC,
    COOLING,
    COOLING_AXES,
    MODERN,
    PAPER,
    SWITCHES,
    Choices,
)

Advance = Callable[[], None]
"""Called after each trial."""


@dataclass(frozen=True)
class Result:
    """What a search found.

    Attributes:
        choices: Best choices.
        score: Their mean score [points].
        paper_score: Mean score of the paper's choices on the same trips [points].
        trials: Number of evaluations.
    """

    choices: Choices
    score: float
    paper_score: float
    trials: int


def modes() -> list[Choices]:
    """Every combination of battery treatment, PTC, ambient and drive train as sources; the paper's first."""
    ptc, ambient, motor, transmission = SWITCHES
    drive_train = Axis("drive_train", (*motor.keys, *transmission.keys), motor.values)
    axes = (BATTERY, ptc, ambient, drive_train)
    combinations = product(*(axis.probes() for axis in axes))
    return [
        {**PAPER, **{key: value for axis, value in zip(axes, values, strict=True) for key in axis.keys}}
        for values in combinations
    ]


def best_mode(objective: Objective, advance: Advance) -> Result:
    """Drives every combination of modes with the paper's set points."""
    scores = []
    for choices in modes():
        scores.append(objective.score(choices))
        advance()
    best = max(range(len(scores)), key=scores.__getitem__)
    return Result(modes()[best], scores[best], scores[0], len(scores))


def tuned(objective: Objective, start: Choices, trials: int, seed: int, advance: Advance) -> Result:
    """Searches modes, set points and thresholds with Optuna's multivariate TPE, one trial after the other.

    Args:
        objective: What to make large.
        start: Best modes, tried third: after the modern rules as they are and with the battery heated.
        trials: Number of evaluations.
        seed: Seed of the sampler.
        advance: Called after each trial.
    """
    cooled = objective.band.high_degc > COOLED_ABOVE_DEGC
    axes = AXES + COOLING_AXES if cooled else AXES
    modern = {**MODERN, **(COOLING if cooled else {})}
    best_modes = {key: value for key, value in start.items() if key.startswith("strategy.")}
    study = search_loop.of_one_process(seed, max(10, trials // 8))
    for known in ({}, {"strategy.battery": "heat"}, best_modes):
        study.enqueue_trial(search_loop.as_drawn(axes, {**modern, **known}) or {})
    search_loop.search(
        study,
        axes,
        lambda batch: [search_loop.Outcome([objective.score(choices)]) for choices in batch],
        trials,
        seen=lambda _: advance(),
    )
    choices = search_loop.changes(axes, study.best_params)
    return Result(choices, study.best_value, objective.score(PAPER), len(study.trials))
