"""How far a set of values is from the targets, the soft claims and the priors."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.studies.calibration.calibration_file import Parameter
from hp_gym.studies.calibration.measurements import Driven
from hp_gym.studies.calibration.problem import CalibrationError, Problem
from hp_gym.studies.reproduction.claims import CLAIMS, by_label
from hp_gym.studies.reproduction.paper import LABELS
from hp_gym.studies.reproduction.runs import simulate_all

UNFINISHED_RESIDUAL: Final = 100.0
"""Added where a run ends early, as its totals mean little."""


@dataclass(frozen=True)
class Totals:
    """What a fit looks at in a run."""

    energy_kwh: float
    final_soc_pct: float
    arrived: bool


def overrides(parameters: Sequence[Parameter], values: Sequence[float]) -> list[str]:
    """Assignments that give the parameters their values."""
    return [
        f"{key}={float(value)!r}"
        for parameter, value in zip(parameters, values, strict=True)
        for key in parameter.keys
    ]


class Residuals:
    """Weighted residuals of a calibration as a function of positions in the ranges (0 to 1)."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.evaluations = 0
        self._scenarios = [target.scenario for target in problem.targets]
        self._prior = np.array([p.to_share(p.prior) for p in problem.parameters])
        weights = np.array([p.prior_weight for p in problem.parameters])
        self.prior_scale = np.sqrt(weights) / problem.prior_sigma_share
        fitted = [one for one in problem.measurements if one.role == "fit"]
        self._driven = Driven(fitted, problem.vehicle, problem.controller)
        self._claims = [claim for claim in CLAIMS if claim.id in problem.soft_claims]
        if len(self._claims) < len(problem.soft_claims):
            raise CalibrationError(f"a [[soft_claim]] has an id that is not one of 1 to {len(CLAIMS)}")
        if self._claims and set(self._scenarios) != set(LABELS):
            raise CalibrationError("soft claims need all nine scenarios of the paper as targets")

    def values(self, shares: NDArray[np.float64]) -> list[float]:
        """Values at positions in the ranges."""
        pairs = zip(self.problem.parameters, shares, strict=True)
        return [parameter.from_share(float(share)) for parameter, share in pairs]

    def shares(self, values: Mapping[str, float]) -> NDArray[np.float64]:
        """Positions in the ranges of values by name; outside values go to the nearer bound."""
        shares = [
            parameter.to_share(min(max(values[parameter.name], parameter.low), parameter.high))
            for parameter in self.problem.parameters
        ]
        return np.array(shares)

    def totals(self, values: Sequence[float]) -> dict[str, Totals]:
        """Totals of every scenario."""
        if not self._scenarios:
            return {}
        results = _core.totals(self._scenarios, overrides(self.problem.parameters, values))
        return {
            scenario: Totals(summary["energy_kwh"], summary["final_soc_pct"], end == "arrived")
            for scenario, (summary, end) in zip(self._scenarios, results, strict=True)
        }

    def __call__(self, shares: NDArray[np.float64]) -> NDArray[np.float64]:
        """All residuals: targets, soft claims, measurements, and priors, one a parameter, last."""
        self.evaluations += 1
        values = self.values(shares)
        if self._claims:
            runs, _ = simulate_all(self._scenarios, overrides(self.problem.parameters, values))
            totals = {
                run.scenario: Totals(
                    run.summary["energy_kwh"], run.summary["final_soc_pct"], run.end_reason == "arrived"
                )
                for run in runs
            }
            labelled = by_label(runs)
            claims = [
                self.problem.soft_claims[claim.id]
                * float(np.linalg.norm(claim.judge(labelled).shortfalls(self.problem.soft_claim_margin)))
                for claim in self._claims
            ]
        else:
            totals, claims = self.totals(values), []
        priors = self.prior_scale * (shares - self._prior)
        return np.concatenate([self._targets(totals), claims, *self._measured(values), priors])

    def _measured(self, values: Sequence[float]) -> list[NDArray[np.float64]]:
        if not self._driven.measurements:
            return []
        found = self._driven.deviations(overrides(self.problem.parameters, values))
        return [deviation for one in found.values() for deviation in one.values()]

    def _targets(self, totals: Mapping[str, Totals]) -> list[float]:
        residuals = []
        for target in self.problem.targets:
            found = totals[target.scenario]
            late = 0.0 if found.arrived else UNFINISHED_RESIDUAL
            if target.energy_kwh is not None:
                sigma_kwh = self.problem.energy_sigma_share * target.energy_kwh
                residuals.append((found.energy_kwh - target.energy_kwh) / sigma_kwh + late)
            if target.final_soc_pct is not None:
                error_pct = found.final_soc_pct - target.final_soc_pct
                residuals.append(error_pct / self.problem.final_soc_sigma_pct + late)
        return residuals
