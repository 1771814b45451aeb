"""Which trips pass: every run of a benchmark beside the reference's on the same trip."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from hp_gym import comfort_standard
from hp_gym.comfort_standard import TripComfort
from hp_gym.studies.benchmark.results import VERDICTS

if TYPE_CHECKING:
    from collections.abc import Iterable

    import pandas as pd

    from hp_gym.comfort_standard import Reading
    from hp_gym.studies.benchmark.grid import Band

LEAST_PASSED_PCT: Final = 95.0
"""Share of trips that must pass in every band."""


def judged(runs: pd.DataFrame) -> pd.DataFrame:
    """Returns runs with the columns `VERDICTS`.

    Args:
        runs: A row for each controller, seed and scenario; those of the reference must be among them.
    """
    reference = runs[runs["controller"] == comfort_standard.REFERENCE].set_index("scenario")
    same_trips = reference.loc[runs["scenario"]]

    def verdict(reading: Reading) -> comfort_standard.Verdict:
        return comfort_standard.judge(*(TripComfort.of(_columns(of), of["stranded"], reading) for of in both))

    both = (runs, same_trips)
    air = verdict("air")
    columns = {
        "in_time": air.in_time,
        "comfortable": air.comfortable,
        "in_good_air": air.in_good_air,
        "passes": air.passes,
        "passes_equivalent": verdict("equivalent").passes,
    }
    return runs.assign(**{name: columns[name] for name in VERDICTS})


def _columns(runs: pd.DataFrame) -> dict[str, Any]:
    return {name: runs[name].to_numpy() for name in comfort_standard.FIGURES}


def rates(runs: pd.DataFrame, bands: Iterable[Band]) -> dict[str, Any]:
    """Shares of the trips that pass [%], by controller: over all trips, and in each band.

    Args:
        runs: Judged runs.
        bands: Bands; those without a trip are left out.
    """
    told = {}
    for controller, own in runs.groupby("controller", sort=False):
        by_band = {band.name: own[own["band"] == band.name] for band in bands}
        told[str(controller)] = {
            **_shares(own),
            "bands": {name: _shares(part) for name, part in by_band.items() if len(part)},
        }
    return told


def _shares(runs: pd.DataFrame) -> dict[str, float]:
    names = {name: "passed" if name == "passes" else name.replace("passes_", "passed_") for name in VERDICTS}
    return {f"{title}_pct": 100.0 * float(runs[name].mean()) for name, title in names.items()}


def failing_bands(rates: dict[str, Any]) -> dict[str, float]:
    """Bands in which too few trips of a controller pass, and how many do [%]."""
    passed = {name: shares["passed_pct"] for name, shares in rates["bands"].items()}
    return {name: share for name, share in passed.items() if share < LEAST_PASSED_PCT}


def standard() -> dict[str, Any]:
    """The numbers that trips are judged by."""
    return {
        "reference": comfort_standard.REFERENCE,
        "later_s": comfort_standard.LATER_S,
        "later_share": comfort_standard.LATER_SHARE,
        "outside_share": comfort_standard.OUTSIDE_SHARE,
        "discomfort_k": comfort_standard.DISCOMFORT_K,
        "least_passed_pct": LEAST_PASSED_PCT,
    }
