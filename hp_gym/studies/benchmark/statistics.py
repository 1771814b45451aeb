"""Sums over trips and their resamples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

    import pandas as pd
    from numpy.typing import NDArray

SECONDS_PER_HOUR: Final = 3600.0
CONFIDENCE_PCT: Final = (2.5, 97.5)
"""Ends of an interval of 95 %; an upper 95 % bound is its upper end."""


@dataclass(frozen=True, eq=False)
class Trips:
    """What trips cost: one row a run (training seed or setting), one column a scenario.

    Attributes:
        energy_kwh: Attributable energy.
        heat_left_kwh: Heat left at arrival.
        discomfort_k_h: Discomfort, integrated over the trip.
        occupied_h: Duration.
        stranded: 1 where a trip ended before arrival.
    """

    energy_kwh: NDArray[np.float64]
    heat_left_kwh: NDArray[np.float64]
    discomfort_k_h: NDArray[np.float64]
    occupied_h: NDArray[np.float64]
    stranded: NDArray[np.float64]

    def of(self, scenarios: NDArray[np.bool_]) -> Trips:
        """The same for some of the scenarios."""
        return Trips(*(getattr(self, name)[:, scenarios] for name in self.__dataclass_fields__))

    def runs(self, rows: NDArray[np.intp]) -> Trips:
        """The same for some of the runs."""
        return Trips(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    def net_kwh(self, credit: float) -> NDArray[np.float64]:
        """Attributable energy less the credit for the heat left."""
        return self.energy_kwh - credit * self.heat_left_kwh


@dataclass(frozen=True, eq=False)
class Resamples:
    """How often scenarios and training seeds are drawn: one row a resample, the first one as they are.

    Attributes:
        scenarios: Times that each scenario is drawn.
        generator_seed: Seed of the draws.
    """

    scenarios: NDArray[np.float64]
    generator_seed: int

    def of(self, chosen: NDArray[np.bool_]) -> Resamples:
        """The same for some of the scenarios: strata are kept whole or left out whole."""
        return Resamples(self.scenarios[:, chosen], self.generator_seed)

    def seeds(self, count: int) -> NDArray[np.float64]:
        """Share of each of so many training seeds, one row a resample."""
        generator = np.random.default_rng([self.generator_seed, count])
        drawn = generator.multinomial(count, np.full(count, 1.0 / count), size=len(self.scenarios) - 1)
        return np.vstack([np.ones(count), drawn]) / count

    def mean_over_runs(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sum over scenarios of the mean over training seeds, one value a resample."""
        shares = self.seeds(len(values))
        means: NDArray[np.float64] = np.einsum("bk,ks->bs", shares, values)
        sums: NDArray[np.float64] = np.einsum("bs,bs->b", self.scenarios, means)
        return sums

    def each_run(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Sum over scenarios of each run, one row a resample, one column a run."""
        sums: NDArray[np.float64] = np.einsum("bs,ps->bp", self.scenarios, values)
        return sums


def trips(runs: pd.DataFrame, keys: Sequence[str], scenarios: Sequence[str]) -> Trips:
    """Arranges runs by what tells them apart and by scenario.

    Args:
        runs: Rows with KPIs.
        keys: Columns that tell runs apart, for example `seed`.
        scenarios: Names in the wanted order.
    """
    discomfort_k_h = runs["discomfort_k"] * runs["duration_s"] / SECONDS_PER_HOUR
    table = runs.assign(discomfort_k_h=discomfort_k_h, occupied_h=runs["duration_s"] / SECONDS_PER_HOUR)
    columns = ("attributable_energy_kwh", "heat_left_kwh", "discomfort_k_h", "occupied_h", "stranded")
    wide = table.pivot(index=list(keys), columns="scenario", values=list(columns)).sort_index()
    return Trips(*(wide[column][list(scenarios)].to_numpy(dtype=np.float64) for column in columns))


def resample(strata: Sequence[object], count: int, seed: int) -> Resamples:
    """Draws scenarios with replacement within strata.

    Args:
        strata: Stratum of each scenario; how many of each there are stays the same.
        count: Number of resamples.
        seed: Seed.
    """
    generator = np.random.default_rng(seed)
    weights = np.ones((count + 1, len(strata)))
    for stratum in dict.fromkeys(strata):
        places = np.flatnonzero([item == stratum for item in strata])
        size = len(places)
        weights[1:, places] = generator.multinomial(size, np.full(size, 1.0 / size), size=count)
    return Resamples(weights, seed)


def resample_clusters(
    clusters: Sequence[Hashable], strata: Sequence[Hashable], count: int, seed: int
) -> Resamples:
    """Draws clusters of scenarios with replacement within strata; a cluster's scenarios come and go together.

    Args:
        clusters: Cluster of each scenario.
        strata: Stratum of each scenario, the same all over a cluster.
        count: Number of resamples.
        seed: Seed.
    """
    stratum_of = dict(zip(clusters, strata, strict=True))
    drawn = resample(list(stratum_of.values()), count, seed)
    place_of = {cluster: place for place, cluster in enumerate(stratum_of)}
    return Resamples(drawn.scenarios[:, [place_of[cluster] for cluster in clusters]], seed)


def interval(resampled: NDArray[np.float64]) -> list[float | None]:
    """Returns the 95 % interval of resamples; an end is None where more than it leaves out is not a number.

    A resample that is not a number counts as the worst there can be.
    """
    worst = np.where(np.isnan(resampled), np.inf, resampled)
    # Without interpolation, so that infinities do not mix with numbers.
    ends = np.percentile(worst, CONFIDENCE_PCT, method="closest_observation")
    return [float(end) if np.isfinite(end) else None for end in ends]
