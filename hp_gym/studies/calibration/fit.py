"""The fit: bounded non-linear least squares in positions within the ranges."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, least_squares

from hp_gym.studies.calibration.problem import Problem
from hp_gym.studies.calibration.residuals import Residuals, Totals

SIGNIFICANT_DIGITS: Final = 4
AT_BOUND_SHARE: Final = 0.01
"""Distance from a bound, as a share of the range, within which a value counts as being at it."""

DIFFERENCE_STEPS: Final = (1e-2, 3e-3, 1e-3)
"""Steps of the finite differences, as a share of the range: wide ones first, as controllers switch."""

DISTURBANCE_SHARE: Final = 0.1
"""Spread of the disturbed starts, as a share of the range."""

Loss = Literal["linear", "soft_l1"]

Progress = Callable[[int, float], None]
"""Told the evaluations so far and the lowest cost."""


@dataclass(frozen=True)
class Options:
    """How to search.

    Attributes:
        steps: Steps of the finite differences, one round of search for each.
        central: Whether differences are central.
        loss: SciPy loss: `linear` or `soft_l1`.
        restarts: Further searches from disturbed starts.
        maximum_evaluations: Evaluations after which to stop; the problem's own number if None.
    """

    steps: Sequence[float] = DIFFERENCE_STEPS
    central: bool = False
    loss: Loss = "linear"
    restarts: int = 0
    maximum_evaluations: int | None = None


@dataclass(frozen=True)
class Fit:
    """Result of a fit.

    Attributes:
        problem: What was fitted.
        values: Value of each parameter, rounded.
        at_bound: Whether each is at a bound of its range.
        totals: Totals of every scenario at these values.
        cost: Half the sum of squared residuals.
        evaluations: Evaluations of all targets that it took.
    """

    problem: Problem
    values: tuple[float, ...]
    at_bound: tuple[bool, ...]
    totals: dict[str, Totals]
    cost: float
    evaluations: int

    def by_key(self) -> dict[str, float]:
        """Value of every key."""
        pairs = zip(self.problem.parameters, self.values, strict=True)
        return {key: value for parameter, value in pairs for key in parameter.keys}

    def by_name(self) -> dict[str, float]:
        """Value of every parameter by its first key."""
        names = (parameter.name for parameter in self.problem.parameters)
        return dict(zip(names, self.values, strict=True))


class _Search:
    """A search that remembers the best point it saw."""

    def __init__(self, residuals: Residuals, options: Options, limit: int, progress: Progress) -> None:
        self.residuals = residuals
        self.options = options
        self.limit = limit
        self.progress = progress
        self.best = np.empty(0)
        self.best_cost = float("inf")

    def evaluate(self, shares: NDArray[np.float64]) -> NDArray[np.float64]:
        residuals = self.residuals(shares)
        cost = 0.5 * float(residuals @ residuals)
        if cost < self.best_cost:
            self.best, self.best_cost = shares.copy(), cost
        self.progress(self.residuals.evaluations, self.best_cost)
        return residuals

    def jacobian(self, shares: NDArray[np.float64], step: float) -> NDArray[np.float64]:
        """Finite differences that stay within the ranges."""
        columns = []
        middle = np.empty(0) if self.options.central else self.evaluate(shares)
        for row in range(shares.size):
            ahead, behind = shares.copy(), shares.copy()
            if self.options.central:
                ahead[row] = min(shares[row] + step, 1.0)
                behind[row] = max(shares[row] - step, 0.0)
                rise = self.evaluate(ahead) - self.evaluate(behind)
            else:
                ahead[row] += step if shares[row] < 0.5 else -step
                rise = self.evaluate(ahead) - middle
            columns.append(rise / (ahead[row] - behind[row]))
        return np.stack(columns, axis=1)

    def spent(self, parameters: int) -> bool:
        """Whether another set of differences would exceed the limit."""
        return self.residuals.evaluations + (1 + self.options.central) * parameters >= self.limit

    def round(self, start: NDArray[np.float64], step: float) -> None:
        def stop_when_spent(intermediate_result: OptimizeResult) -> None:
            if self.spent(intermediate_result.x.size):
                raise StopIteration

        def differences(shares: NDArray[np.float64]) -> NDArray[np.float64]:
            return self.jacobian(shares, step)

        least_squares(
            self.evaluate,
            np.clip(start, 1e-6, 1.0 - 1e-6),
            jac=differences,
            bounds=(0.0, 1.0),
            method="trf",
            loss=self.options.loss,
            ftol=1e-4,
            xtol=1e-5,
            gtol=1e-6,
            callback=stop_when_spent,
        )


def fit(
    problem: Problem,
    start: dict[str, float],
    options: Options | None = None,
    progress: Progress | None = None,
) -> Fit:
    """Fits the parameters.

    Args:
        problem: What to fit to what.
        start: Value of each parameter, by its first key, to start from.
        options: How to search.
        progress: Told about every evaluation.

    Raises:
        ConfigurationError: A key or a value within a range is not accepted by the plant.
    """
    options = options or Options()
    residuals = Residuals(problem)
    limit = options.maximum_evaluations or problem.maximum_evaluations
    search = _Search(residuals, options, limit, progress or (lambda _evaluations, _cost: None))
    first = residuals.shares(start)
    search.evaluate(first)
    random = np.random.default_rng(problem.seed)
    for number in range(1 + options.restarts):
        around = search.best if number else first
        shift = DISTURBANCE_SHARE * random.standard_normal(first.size) if number else 0.0
        point = np.clip(around + shift, 0.0, 1.0)
        for step in options.steps:
            if search.spent(first.size):
                break
            search.round(point, step)
            point = search.best
    return _result(problem, residuals, search.best)


def _result(problem: Problem, residuals: Residuals, shares: NDArray[np.float64]) -> Fit:
    values = tuple(
        min(max(float(f"{value:.{SIGNIFICANT_DIGITS}g}"), parameter.low), parameter.high)
        for parameter, value in zip(problem.parameters, residuals.values(shares), strict=True)
    )
    rounded = np.array([p.to_share(value) for p, value in zip(problem.parameters, values, strict=True)])
    final = residuals(rounded)
    return Fit(
        problem=problem,
        values=values,
        at_bound=tuple(
            p.at_bound(value, AT_BOUND_SHARE) for p, value in zip(problem.parameters, values, strict=True)
        ),
        totals=residuals.totals(values),
        cost=0.5 * float(final @ final),
        evaluations=residuals.evaluations,
    )
