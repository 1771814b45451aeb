"""From runs to `summary.json`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from hp_gym.studies.benchmark import gains, statistics
from hp_gym.studies.benchmark.fronts import OFFSETS
from hp_gym.studies.benchmark.results import FRONT_COLUMNS, KPIS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pandas as pd

    from hp_gym.studies.benchmark.grid import Grid
    from hp_gym.studies.benchmark.statistics import Resamples

PAPER: Final = "hpcu"
"""Rules that every other controller is compared with."""

# Ratios and counts that are not plain means over trips.
_SUMS: Final = ("limit_breaches", "stranded")


@dataclass(frozen=True, eq=False)
class Evidence:
    """Runs of a benchmark, arranged for comparison.

    Attributes:
        grid: What was driven.
        runs: A row for each controller, seed and scenario.
        front_runs: A row for each setting of the rules and scenario, with `family` and the offsets of
            `fronts.OFFSETS`; it may be empty.
        resamples: Resamples of the grid's scenarios.
    """

    grid: Grid
    runs: pd.DataFrame
    front_runs: pd.DataFrame
    resamples: Resamples

    def trips(self, controller: str) -> statistics.Trips:
        """Runs of a controller over all scenarios, one row a seed."""
        return statistics.trips(self.runs[self.runs["controller"] == controller], ["seed"], self.names)

    def seeds(self, controller: str) -> list[int]:
        """Seeds of a controller."""
        return [int(seed) for seed in np.unique(self.runs.loc[self.runs["controller"] == controller, "seed"])]

    @property
    def names(self) -> list[str]:
        """Names of all scenarios."""
        return [scenario.name for scenario in self.grid.scenarios]

    @property
    def headline(self) -> np.ndarray[Any, np.dtype[np.bool_]]:
        """Marks the scenarios that headline figures are of."""
        return np.array([scenario.band.headline for scenario in self.grid.scenarios])


def all_gains(evidence: Evidence, learned: Sequence[str]) -> dict[str, Any]:
    """Gains of learned controllers over each family of rules, `<controller>_vs_<rules>`.

    `_vs_hpcu` is the paper's controller, whose user moves the cabin set point only; `_vs_hpcu_any_htc` lets
    its HTC set point be moved too, which the paper's controller cannot.
    """
    found = {}
    fronts = evidence.front_runs
    for controller in learned:
        for family in dict.fromkeys(fronts["family"]):
            own = fronts[fronts["family"] == family]
            rivals = {_key(family): own}
            if family == PAPER:
                rivals = {"hpcu": own[own["htc_offset_k"] == 0.0], "hpcu_any_htc": own}
            for rival, runs in rivals.items():
                found[f"{_key(controller)}_vs_{rival}"] = _gain(evidence, controller, family, runs)
    return found


def _key(name: str) -> str:
    return name.replace("-", "_")


def _gain(evidence: Evidence, controller: str, family: str, front_runs: pd.DataFrame) -> dict[str, Any]:
    headline = evidence.headline
    names = [name for name, counts in zip(evidence.names, headline, strict=True) if counts]
    front = statistics.trips(front_runs, list(OFFSETS), names)
    agent, rules = evidence.trips(controller).of(headline), evidence.trips(family).of(headline)
    return gains.gain(agent, rules, front, evidence.resamples.of(headline), evidence.seeds(controller))


def controllers(evidence: Evidence) -> dict[str, Any]:
    """KPIs of every controller over the headline's trips and in each band, there also against the paper's."""
    reference = evidence.trips(PAPER)
    told = {}
    for controller, runs in evidence.runs.groupby("controller", sort=False):
        trips = evidence.trips(str(controller))
        bands = {}
        for band in evidence.grid.bands:
            chosen = np.array([scenario.band == band for scenario in evidence.grid.scenarios])
            if not chosen.any():
                continue
            bands[band.name] = kpis(runs[runs["band"] == band.name])
            if controller != PAPER:
                bands[band.name]["vs_hpcu"] = gains.paired(
                    trips.of(chosen), reference.of(chosen), evidence.resamples.of(chosen)
                )
        in_headline = runs["band"].isin([band.name for band in evidence.grid.bands if band.headline])
        told[str(controller)] = {
            "seeds": evidence.seeds(str(controller)),
            **kpis(runs[in_headline]),
            "bands": bands,
        }
    return told


def kpis(runs: pd.DataFrame) -> dict[str, Any]:
    """KPIs of a set of runs: means over trips but where docs/benchmark.md says otherwise."""
    values: dict[str, Any] = {"trips": len(runs)}
    if runs.empty:
        return values
    # A cabin that is never comfortable counts with the whole trip.
    times = [name for name in KPIS if name.endswith("comfort_s")]
    filled = runs.assign(**{name: runs[name].fillna(runs["duration_s"]) for name in times})
    values |= {name: float(filled[name].mean()) for name in KPIS if name not in _SUMS}
    values |= {name: int(filled[name].sum()) for name in _SUMS}
    values["attributable_energy_kwh_per_100_km"] = float(
        100.0 * runs["attributable_energy_kwh"].sum() / runs["distance_km"].sum()
    )
    values["discomfort_k"] = float(
        (runs["discomfort_k"] * runs["duration_s"]).sum() / runs["duration_s"].sum()
    )
    return values


def front_table(evidence: Evidence) -> pd.DataFrame:
    """Means of every setting of the rules over the headline's trips; columns as in `FRONT_COLUMNS`."""
    import pandas as pd

    rows = []
    keys = ["family", *OFFSETS]
    for values, runs in evidence.front_runs.groupby(keys, sort=False):
        means = kpis(runs)
        wanted = ("attributable_energy_kwh", "discomfort_k", "heat_left_kwh")
        row = dict(zip(keys, values, strict=True)) | {name: means[name] for name in wanted}
        rows.append(row | {"stranded_trips": means["stranded"]})
    return pd.DataFrame(rows, columns=list(FRONT_COLUMNS))


def counts(runs: pd.DataFrame, kpi: str) -> dict[str, int]:
    """Sum of a count over all runs of each controller, cooling included."""
    return {str(name): int(group[kpi].sum()) for name, group in runs.groupby("controller", sort=False)}


def grid_facts(grid: Grid) -> dict[str, Any]:
    """What was driven."""
    highs: list[float | None] = [band.low_degc for band in grid.bands[1:]]
    bands: Mapping[str, Any] = {
        band.name: {
            "from_degc": band.low_degc,
            "to_degc": high,
            "headline": band.headline,
            "scenarios": sum(scenario.band == band for scenario in grid.scenarios),
        }
        for band, high in zip(grid.bands, [*highs, None], strict=True)
    }
    return {
        "name": grid.name,
        "description": grid.description,
        "scenarios": len(grid.scenarios),
        "headline_scenarios": sum(scenario.band.headline for scenario in grid.scenarios),
        "bands": dict(bands),
    }
