"""The two searches: every combination of modes, and Optuna over modes, set points and thresholds."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import optuna

from hp_gym.overrides import Value
from hp_gym.studies.tuning.objective import Objective
from hp_gym.studies.tuning.rule_choices import PAPER, Choices

TREATMENTS = ("heat", "isolate", "source")

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
    combinations: list[Choices] = []
    for battery, ptc, ambient, drive_train in product(
        TREATMENTS, (True, False), (True, False), (True, False)
    ):
        combinations.append(
            {
                **PAPER,
                "strategy.battery": battery,
                "strategy.ptc": ptc,
                "strategy.ambient": ambient,
                "strategy.motor": drive_train,
                "strategy.transmission": drive_train,
            }
        )
    return combinations


def best_mode(objective: Objective, advance: Advance) -> Result:
    """Drives every combination of modes with the paper's set points."""
    scores = []
    for choices in modes():
        scores.append(objective.score(choices))
        advance()
    best = max(range(len(scores)), key=scores.__getitem__)
    return Result(modes()[best], scores[best], scores[0], len(scores))


def tuned(objective: Objective, start: Choices, trials: int, seed: int, advance: Advance) -> Result:
    """Searches modes, set points and thresholds with Optuna's multivariate TPE.

    Args:
        objective: What to make large.
        start: Choices tried first, after the paper's.
        trials: Number of evaluations.
        seed: Seed of the sampler.
        advance: Called after each trial.
    """
    # Its warnings are tracebacks of trials that Ctrl-C ended.
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    sampler = optuna.samplers.TPESampler(seed=seed, multivariate=True, n_startup_trials=max(10, trials // 8))
    study = optuna.create_study(direction="maximize", sampler=sampler)
    for known in (PAPER, start):
        study.enqueue_trial(dict(known))

    def evaluate(trial: optuna.Trial) -> float:
        choices = suggest(trial)
        score = objective.score(choices)
        advance()
        return score

    study.optimize(evaluate, n_trials=trials)
    paper_score = study.trials[0].value
    if paper_score is None:
        message = "the paper's choices could not be driven"
        raise RuntimeError(message)
    return Result(dict(study.best_params), study.best_value, paper_score, len(study.trials))


def suggest(trial: optuna.Trial) -> dict[str, Value]:
    """Draws choices; the ranges hold the paper's and what a heat pump engineer would try."""
    return {
        "strategy.battery": trial.suggest_categorical("strategy.battery", TREATMENTS),
        "strategy.ptc": trial.suggest_categorical("strategy.ptc", (True, False)),
        "strategy.ambient": trial.suggest_categorical("strategy.ambient", (True, False)),
        "strategy.motor": trial.suggest_categorical("strategy.motor", (True, False)),
        "strategy.transmission": trial.suggest_categorical("strategy.transmission", (True, False)),
        "controller.cabin_set_point_degc": trial.suggest_float("controller.cabin_set_point_degc", 17.0, 24.0),
        "controller.htc_set_point_degc": trial.suggest_float("controller.htc_set_point_degc", 30.0, 90.0),
        "controller.battery.heat_up_to_degc": trial.suggest_float(
            "controller.battery.heat_up_to_degc", -20.0, 20.0
        ),
        "controller.ptc_from_deviation_k": trial.suggest_float(
            "controller.ptc_from_deviation_k", -20.0, 30.0
        ),
    }
