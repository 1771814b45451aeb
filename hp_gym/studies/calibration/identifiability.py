"""What the data say about each parameter, and which of them they cannot tell apart."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym.studies.calibration.calibration_file import Parameter
from hp_gym.studies.calibration.fit import Fit
from hp_gym.studies.calibration.residuals import Residuals

OPEN_SHARE: Final = 0.25
"""Share of the ranges: what data alone leave open by more than that, they do not determine."""

TAKES_PART: Final = 0.3
"""Least component in such a combination (a vector of length 1) of a parameter that belongs to it."""

_STEPS: Final = (1e-2, 1.7e-2, 2.8e-2, 4.2e-2, 6e-2)
"""Steps of central differences, as shares of the range.

Controllers switch a second earlier or later, which makes single differences rough: the median of several is
taken, and their spread is the roughness that is left.
"""

_ROUGHEST: Final = 0.3
"""Largest roughness of a residual's derivatives, as a share of them: beyond, a controller switches there."""

_SMALLEST: Final = 1e-9

_NORMAL: Final = 1.4826
"""Standard deviation over median absolute deviation of a normal distribution."""


@dataclass(frozen=True)
class Knowledge:
    """What a fit knows of its parameters; all in positions in the ranges (0 to 1) unless said otherwise.

    Attributes:
        names: First keys of the parameters.
        covariance: From data and priors.
        deviations: Standard deviations from data and priors, in the parameters' units.
        gain: Share of the prior's variance that the data have removed, 0 to 1, by parameter.
        open_groups: Parameters that the data cannot tell apart; one alone is not seen by the data.
        reduced_chi2: Mean square of the data's residuals; 1 where model and stated uncertainties are right.
    """

    names: tuple[str, ...]
    covariance: NDArray[np.float64]
    deviations: tuple[float, ...]
    gain: tuple[float, ...]
    open_groups: tuple[tuple[str, ...], ...]
    reduced_chi2: float

    @property
    def correlation(self) -> NDArray[np.float64]:
        """Correlations of the parameters."""
        scale = np.sqrt(np.diag(self.covariance))
        correlation: NDArray[np.float64] = self.covariance / np.outer(scale, scale)
        return correlation


def knowledge(fit: Fit) -> Knowledge:
    """Works out what a fit knows, from differences around it."""
    residuals = Residuals(fit.problem)
    parameters = fit.problem.parameters
    middle = np.array([p.to_share(value) for p, value in zip(parameters, fit.values, strict=True)])
    data = len(residuals(middle)) - len(parameters)
    jacobian, roughness = _differences(residuals, middle, data)
    chi2 = float(np.sum(residuals(middle)[:data] ** 2))
    reduced = chi2 / max(data - len(parameters), 1)
    # Residuals that are larger than their uncertainties allow say that the model is wrong somewhere.
    information: NDArray[np.float64] = jacobian.T @ jacobian / max(reduced, 1.0)
    eigenvalues, vectors = np.linalg.eigh(information)
    noise = np.array([float(vector**2 @ roughness) for vector in vectors.T]) / max(reduced, 1.0)
    is_open = eigenvalues < np.maximum(OPEN_SHARE**-2, noise)
    information = _without(information, vectors[:, eigenvalues < noise])
    prior = residuals.prior_scale**2
    known = information + np.diag(np.maximum(prior, _SMALLEST))
    covariance = np.linalg.inv(known).astype(np.float64)
    shares = np.sqrt(np.diag(covariance))
    names = tuple(parameter.name for parameter in parameters)
    return Knowledge(
        names=names,
        covariance=covariance,
        deviations=tuple(
            _in_units(p, at, share) for p, at, share in zip(parameters, middle, shares, strict=True)
        ),
        gain=tuple(float(max(1.0 - p * c, 0.0)) for p, c in zip(prior, np.diag(covariance), strict=True)),
        open_groups=_open_groups(names, vectors[:, is_open]),
        reduced_chi2=reduced,
    )


def _differences(
    residuals: Residuals, middle: NDArray[np.float64], data: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Derivatives of the data's residuals, and for each parameter the sum of their squared uncertainties.

    A residual at a switch (5 kW of a heater a second earlier) tells of the step more than of the parameter:
    it counts as not seen.
    """
    every = []
    for step in _STEPS:
        columns = []
        for place in range(len(middle)):
            ahead, behind = middle.copy(), middle.copy()
            ahead[place], behind[place] = min(middle[place] + step, 1.0), max(middle[place] - step, 0.0)
            rise = residuals(ahead)[:data] - residuals(behind)[:data]
            columns.append(rise / (ahead[place] - behind[place]))
        every.append(np.stack(columns, axis=1))
    jacobians = np.stack(every)
    jacobian: NDArray[np.float64] = np.median(jacobians, axis=0)
    spread = _NORMAL * np.median(np.abs(jacobians - jacobian), axis=0)
    switches = np.linalg.norm(spread, axis=1) > _ROUGHEST * np.linalg.norm(jacobian, axis=1)
    jacobian[switches], spread[switches] = 0.0, 0.0
    return jacobian, np.sum(spread**2, axis=0) / len(_STEPS)


def _without(information: NDArray[np.float64], directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Takes out of the information what is not more than roughness, in parameters that take part in it."""
    if not directions.size:
        return information
    # Roughness also turns a direction a little towards parameters that are well known.
    plain, _ = np.linalg.qr(np.where(np.abs(directions) >= TAKES_PART, directions, 0.0))
    rest = np.eye(len(information)) - plain @ plain.T
    cleared: NDArray[np.float64] = rest @ information @ rest
    return cleared


def _in_units(parameter: Parameter, at: float, share: float) -> float:
    step = 1e-4
    low, high = max(at - step, 0.0), min(at + step, 1.0)
    slope = (parameter.from_share(high) - parameter.from_share(low)) / (high - low)
    return float(share * slope)


def _open_groups(names: Sequence[str], directions: NDArray[np.float64]) -> tuple[tuple[str, ...], ...]:
    """Directions that the data leave open, as the parameters that take part in each, most first."""
    groups: dict[tuple[str, ...], None] = {}
    for vector in directions.T:
        parts = np.argsort(-np.abs(vector))
        groups[tuple(names[part] for part in parts if abs(vector[part]) >= TAKES_PART)] = None
    return tuple(groups)
