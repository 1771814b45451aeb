"""What a fit predicts of scenarios that it did not see."""

from hp_gym.studies.calibration.calibration_report import HeldOut, errors
from hp_gym.studies.calibration.fit import Fit, Options, Progress, fit
from hp_gym.studies.calibration.problem import Problem


def leave_out(
    problem: Problem,
    scenario: str,
    start: dict[str, float],
    options: Options,
    progress: Progress | None = None,
) -> HeldOut:
    """Refits without a scenario and predicts it.

    The start matters where the remaining targets leave values open: from a fit to all scenarios some of
    the held-out one lives on in them, from the priors nothing does.
    """
    result = fit(problem.without(scenario), start, options, progress)
    return _held_out(problem, result, {scenario})


def subset(
    problem: Problem, start: dict[str, float], options: Options, progress: Progress | None = None
) -> HeldOut:
    """Fits the problem's subset and predicts the rest."""
    result = fit(problem.subset(), start, options, progress)
    unseen = {target.scenario for target in problem.targets} - set(problem.subset_energy)
    return _held_out(problem, result, unseen)


def _held_out(problem: Problem, result: Fit, scenarios: set[str]) -> HeldOut:
    shown = [item for item in errors(problem, result) if item.scenario in scenarios]
    return HeldOut(shown, result.evaluations)
