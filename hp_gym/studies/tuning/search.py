"""The two searches: every combination of modes; and modes, set points and thresholds, as `optimise` does."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

from hp_gym.studies.axes import Axis
from hp_gym.studies.optimise import search_loop
from hp_gym.studies.tuning.objective import Objective
from hp_gym.studies.tuning.rule_choices import PAPER, Choices
from hp_gym.studies.tuning.rule_families import BATTERY, SWITCHES, RuleFamily

Advance = Callable[[], None]
"""Called after each trial."""


@dataclass(frozen=True)
class Effort:
    """How much is searched.

    Attributes:
        trials: Evaluations of each search in each band.
        trips: Training trips of an evaluation.
        seed: Seed of trips and search.
    """

    trials: int
    trips: int
    seed: int


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
        PAPER.changed({key: value for axis, value in zip(axes, values, strict=True) for key in axis.keys})
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


def tuned(
    objective: Objective, family: RuleFamily, known: Sequence[Choices], effort: Effort, advance: Advance
) -> Result:
    """Searches modes, set points and thresholds with Optuna's multivariate TPE, one trial after the other.

    Args:
        objective: What to make large.
        family: Rules, and what of them is searched.
        known: Choices that were good elsewhere, such as the best of a colder band. They are tried after the
            rules as they are, and those with the battery heated; what they do not say stays as it is.
        effort: Number of evaluations, and seed of the sampler.
        advance: Called after each trial.
    """
    axes, start = family.axes_in(objective.band), family.start(objective.band)
    study = search_loop.of_one_process(effort.seed, max(10, effort.trials // 8))
    for told in ({}, {"strategy.battery": "heat"}, *(choices.values for choices in known)):
        values = {**start.values, **{key: value for key, value in told.items() if key in start.values}}
        study.enqueue_trial(search_loop.as_drawn(axes, values) or {}, skip_if_exists=True)
    search_loop.search(
        study,
        axes,
        lambda batch: [search_loop.Outcome([objective.score(start.changed(drawn))]) for drawn in batch],
        effort.trials,
        seen=lambda _: advance(),
    )
    choices = start.changed(search_loop.changes(axes, study.best_params))
    return Result(choices, study.best_value, objective.score(PAPER), len(study.trials))
