"""The gain: energy over the trips on which both a controller and its rival pass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hp_gym.studies.benchmark import statistics
from hp_gym.studies.benchmark.gains import CREDITS, change_pct, figure, number

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    from numpy.typing import NDArray

    from hp_gym.studies.benchmark.statistics import Resamples, Trips


@dataclass(frozen=True, eq=False)
class JudgedTrips:
    """Trips of a controller, one row a seed, one column a scenario.

    Attributes:
        trips: What they cost.
        passes: 1 where a trip passes, else 0.
    """

    trips: Trips
    passes: NDArray[np.float64]

    def charged_kwh(self, credit: float, dearest_kwh: NDArray[np.float64]) -> NDArray[np.float64]:
        """Net energy, of a failed trip the dearest passing controller's.

        Args:
            credit: Share of the heat left that is credited.
            dearest_kwh: What `dearest_kwh` returns.
        """
        return np.where(self.passes > 0.0, self.trips.net_kwh(credit), dearest_kwh)


def judged_trips(runs: pd.DataFrame, scenarios: list[str]) -> JudgedTrips:
    """Arranges the judged runs of one controller by seed and scenario."""
    wide = runs.pivot(index="seed", columns="scenario", values="passes").sort_index()
    return JudgedTrips(
        statistics.trips(runs, ["seed"], scenarios), wide[scenarios].to_numpy(dtype=np.float64)
    )


def dearest_kwh(runs: pd.DataFrame, scenarios: list[str], credit: float) -> NDArray[np.float64]:
    """Most that any run needed that passes, by scenario; NaN where none does.

    Args:
        runs: Judged runs of all controllers.
        scenarios: Names in the wanted order.
        credit: Share of the heat left that is credited.
    """
    passed = runs[runs["passes"]]
    net_kwh = passed["attributable_energy_kwh"] - credit * passed["heat_left_kwh"]
    return net_kwh.groupby(passed["scenario"]).max().reindex(scenarios).to_numpy(dtype=np.float64)


def paired_gain(
    agent: JudgedTrips,
    rival: JudgedTrips,
    dearest: Mapping[float, NDArray[np.float64]],
    bands: Mapping[str, NDArray[np.bool_]],
    resamples: Resamples,
) -> dict[str, Any]:
    """Compares a controller with a rival that has one run a trip; negative is less energy.

    Args:
        agent: The controller.
        rival: The rival, one row.
        dearest: `dearest_kwh` by credit.
        bands: Which scenarios are in each band.
        resamples: Resamples of the scenarios.

    Returns:
        The figures that docs/benchmark.md lists under `paired_gains`.
    """
    both = agent.passes * rival.passes
    by_credit = {}
    for credit in CREDITS:
        of_agent, of_rival = (
            resamples.mean_over_runs(both * each.trips.net_kwh(credit)) for each in (agent, rival)
        )
        agent_charged, rival_charged = (
            _charged(each, credit, dearest[credit], resamples) for each in (agent, rival)
        )
        by_credit[f"{credit:g}"] = {
            **figure("attributable_energy_pct", "ci95", change_pct(of_agent, of_rival)),
            **figure("charged_pct", "charged_ci95", change_pct(agent_charged, rival_charged)),
        }
    worse = _worst(by_credit, "attributable_energy_pct")
    charged = _worst(by_credit, "charged_pct")
    return {
        **{name: by_credit[worse][name] for name in ("attributable_energy_pct", "ci95")},
        "credit": float(worse),
        **{name: by_credit[charged][name] for name in ("charged_pct", "charged_ci95")},
        "pairs": int(both.sum()),
        "passed_pct": 100.0 * float(agent.passes.mean()),
        "rival_passed_pct": 100.0 * float(rival.passes.mean()),
        "by_credit": by_credit,
        "bands": {
            name: _of_band(agent, rival, both, inside, resamples)
            for name, inside in bands.items()
            if inside.any()
        },
    }


def _charged(
    judged: JudgedTrips, credit: float, dearest: NDArray[np.float64], resamples: Resamples
) -> NDArray[np.float64]:
    """Energy with failed trips charged; a trip that nobody passes has no charge and is left out."""
    return resamples.mean_over_runs(
        np.where(np.isnan(dearest), 0.0, judged.charged_kwh(credit, np.nan_to_num(dearest)))
    )


def _of_band(
    agent: JudgedTrips,
    rival: JudgedTrips,
    both: NDArray[np.float64],
    inside: NDArray[np.bool_],
    resamples: Resamples,
) -> dict[str, Any]:
    """Difference in a band, a pair, in kWh: a sum near 0 has no percentage."""
    drawn, pairs = resamples.of(inside), both[:, inside]
    by_credit = {}
    for credit in CREDITS:
        more_kwh = pairs * (agent.trips.net_kwh(credit) - rival.trips.net_kwh(credit))[:, inside]
        rival_kwh = drawn.mean_over_runs(pairs * rival.trips.net_kwh(credit)[:, inside])
        counted = drawn.mean_over_runs(pairs)
        mean_kwh = drawn.mean_over_runs(more_kwh) / np.where(counted > 0.0, counted, np.nan)
        by_credit[f"{credit:g}"] = {
            **figure("difference_kwh", "difference_ci95", mean_kwh),
            "attributable_energy_pct": number(
                100.0 * float(mean_kwh[0] * counted[0] / rival_kwh[0]) if rival_kwh[0] > 0.0 else np.nan
            ),
        }
    worse = _worst(by_credit, "difference_kwh")
    return {"pairs": int(pairs.sum()), "credit": float(worse), **by_credit[worse]}


def _worst(by_credit: Mapping[str, Mapping[str, Any]], name: str) -> str:
    """The credit at which a figure is largest; none at all is worse than any."""
    return max(by_credit, key=lambda credit: np.inf if (value := by_credit[credit][name]) is None else value)
