"""The two searches: every combination of modes; and modes, set points and thresholds, as `optimise` does."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

from hp_gym.studies.axes import Axis
from hp_gym.studies.optimise import search_loop
from hp_gym.studies.tuning.objective import Objective
from hp_gym.studies.tuning.rule_choices import AXES, BATTERY, PAPER, SWITCHES, Choices

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
    places = product(*(range(len(axis.probes())) for axis in axes))
    names = [axis.name for axis in axes]
    return [{**PAPER, **search_loop.changes(axes, dict(zip(names, place, strict=True)))} for place in places]


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
        start: Choices tried first, after the paper's.
        trials: Number of evaluations.
        seed: Seed of the sampler.
        advance: Called after each trial.
    """

    def drive(batch: Sequence[Choices]) -> list[search_loop.Outcome]:
        outcomes = [search_loop.Outcome([objective.score(choices)]) for choices in batch]
        advance()
        return outcomes

    study = search_loop.of_one_process(search_loop.tpe(seed, max(10, trials // 8)), "maximize")
    for known in (PAPER, start):
        study.enqueue_trial(search_loop.as_drawn(AXES, known) or {})
    search_loop.search(study, AXES, drive, trials)
    best = study.best_trial
    return Result(
        search_loop.changes(AXES, best.params), study.best_value, study.trials[0].values[0], len(study.trials)
    )
