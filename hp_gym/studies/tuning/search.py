"""The two searches: every combination of modes, and Optuna over modes, set points and thresholds."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Final

import optuna

from hp_gym.overrides import Value
from hp_gym.studies.tuning.objective import Objective
from hp_gym.studies.tuning.rule_choices import COOLING, MODERN, PAPER, Choices

TREATMENTS = ("heat", "isolate", "source")

COOLED_ABOVE_DEGC: Final = 20.0
"""A band that reaches beyond is one that is cooled in."""

RANGES: Final[Mapping[str, tuple[float, float]]] = {
    "controller.cabin_set_point_degc": (17.0, 24.0),
    "controller.htc_set_point_degc": (30.0, 90.0),
    "controller.battery.heat_up_to_degc": (-20.0, 20.0),
    "controller.ptc_from_deviation_k": (-20.0, 30.0),
    "controller.blower_level": (0.3, 1.0),
    "controller.heating_recirculation": (0.0, 0.9),
    "controller.options.heating_blower_band_k": (2.0, 25.0),
    "controller.options.least_blower_level": (0.2, 0.5),
    "controller.options.ptc_below_target_k": (0.0, 5.0),
    "controller.options.battery_after_cabin_band_k": (0.5, 5.0),
}
"""Set points and options of the rules, lowest and highest."""

COOLING_RANGES: Final[Mapping[str, tuple[float, float]]] = {
    "controller.cooling_recirculation": (0.0, 0.9),
    "controller.cooling_blower_level": (0.4, 1.0),
    "controller.cooling_chiller_set_point_degc": (0.0, 12.0),
    "controller.options.cooling_blower_band_k": (0.5, 6.0),
}
"""Those that act in a climate that is cooled in."""

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
        start: Choices tried first, after the modern ones and the same with the paper's target for the PTC.
        trials: Number of evaluations.
        seed: Seed of the sampler.
        advance: Called after each trial.
    """
    # Its warnings are tracebacks of trials that Ctrl-C ended.
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    sampler = optuna.samplers.TPESampler(seed=seed, multivariate=True, n_startup_trials=max(10, trials // 8))
    study = optuna.create_study(direction="maximize", sampler=sampler)
    cooled = objective.band.high_degc > COOLED_ABOVE_DEGC
    modern = {**MODERN, **(COOLING if cooled else {})}
    for known in ({}, {"strategy.battery": "heat"}, {k: v for k, v in start.items() if "strategy" in k}):
        study.enqueue_trial({**modern, **known})

    def evaluate(trial: optuna.Trial) -> float:
        choices = suggest(trial, cooled=cooled)
        score = objective.score(choices)
        advance()
        return score

    study.optimize(evaluate, n_trials=trials)
    return Result(dict(study.best_params), study.best_value, objective.score(PAPER), len(study.trials))


def suggest(trial: optuna.Trial, *, cooled: bool) -> dict[str, Value]:
    """Draws choices; the ranges hold those of today's rules and what a heat pump engineer would try."""
    modes: dict[str, Value] = {"strategy.battery": trial.suggest_categorical("strategy.battery", TREATMENTS)}
    for source in ("ptc", "ambient", "motor", "transmission"):
        key = f"strategy.{source}"
        modes[key] = trial.suggest_categorical(key, (True, False))
    ranges = {**RANGES, **(COOLING_RANGES if cooled else {})}
    return {**modes, **{key: trial.suggest_float(key, low, high) for key, (low, high) in ranges.items()}}
