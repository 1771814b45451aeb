"""What the benchmark claims: the best rule, and gains that stand where comfort holds in every band."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from hp_gym.studies.benchmark import verdicts
from hp_gym.studies.benchmark.gains import CREDITS
from hp_gym.studies.benchmark.paired_gain import JudgedTrips, dearest_kwh, judged_trips, paired_gain

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pandas as pd
    from numpy.typing import NDArray

    from hp_gym.studies.benchmark.grid import Grid
    from hp_gym.studies.benchmark.statistics import Resamples

CLAIMED: Final = ("attributable_energy_pct", "ci95", "passed_pct")
"""Figures of a claim."""


@dataclass(frozen=True, eq=False)
class Claims:
    """Judged runs of a benchmark, ready to compare.

    Attributes:
        grid: What was driven.
        runs: Judged runs of all controllers.
        resamples: Resamples of the grid's scenarios in clusters.
        rules: Names of the controllers that are rules.
        learned: Names of those that are judged against rules, ablations left out.
        shipped: Name of the shipped policies, which are claimed for where they took part.
        paper: Name of the paper's rules.
    """

    grid: Grid
    runs: pd.DataFrame
    resamples: Resamples
    rules: Sequence[str]
    learned: Sequence[str]
    shipped: str
    paper: str

    def figures(self) -> dict[str, Any]:
        """What the summary gets: `comfort`, `paired_gains` and `headline`."""
        rates = verdicts.rates(self.runs, self.grid.bands)
        best, none_best = self._best_rule(rates)
        rivals = list(dict.fromkeys(name for name in (best, self.paper) if name))
        gains = {
            f"{controller}_vs_{rival}": self._gain(str(controller), rival, rates)
            for controller in rates
            for rival in rivals
            if controller != rival
        }
        return {
            "comfort": {**verdicts.standard(), "controllers": rates},
            "paired_gains": gains,
            "headline": self._headline(best, none_best, gains),
        }

    def _headline(self, best: str | None, none_best: str | None, gains: Mapping[str, Any]) -> dict[str, Any]:
        learned, none_learned = self._learned()
        pairs = {
            "learned_vs_best_rule": (learned, best, none_learned or none_best),
            "best_rule_vs_hpcu": (best, self.paper, none_best),
        }
        told: dict[str, Any] = {"best_rule": best, "learned": learned}
        reasons: dict[str, str | None] = {}
        rests_on: dict[str, dict[str, Any] | None] = {}
        for name, (controller, rival, missing) in pairs.items():
            same = f"the best rule is `{rival}` itself" if controller == rival else None
            gain = gains.get(f"{controller}_vs_{rival}", {"objections": []})
            reasons[name] = missing or same or "; ".join(gain["objections"]) or None
            stands = reasons[name] is None
            told[name] = {figure: gain[figure] for figure in CLAIMED} if stands else None
            rests_on[name] = _evidence(gain) if stands else None
        return {**told, "reasons": reasons, "rests_on": rests_on}

    def _learned(self) -> tuple[str | None, str | None]:
        """Who is claimed for, or why nobody is: the best must not be chosen on held-out trips."""
        if self.shipped in self.learned:
            return self.shipped, None
        if len(self.learned) == 1:
            return self.learned[0], None
        if not self.learned:
            return None, "no learned controller took part"
        names = ", ".join(f"`{name}`" for name in self.learned)
        return None, f"the best of {names} must be chosen on validation trips, not here"

    def _best_rule(self, rates: Mapping[str, Any]) -> tuple[str | None, str | None]:
        """The rules that pass in every band and need least, failed trips charged, or why there are none."""
        energies_kwh = {}
        failing = []
        dearest = self._dearest[0.0]
        charged = ~np.isnan(dearest)
        for name in self.rules:
            short = verdicts.failing_bands(rates[name])
            if short:
                failing.append(f"`{name}` passes {_list(short)}")
            else:
                energy_kwh = self._judged(name).charged_kwh(0.0, dearest)[:, charged]
                energies_kwh[name] = float(energy_kwh.mean(axis=0).sum())
        if energies_kwh:
            return min(energies_kwh, key=lambda name: energies_kwh[name]), None
        least = f"{verdicts.LEAST_PASSED_PCT:g} %"
        return None, f"no rules pass at least {least} of the trips in every band: {'; '.join(failing)}"

    def _gain(self, controller: str, rival: str, rates: Mapping[str, Any]) -> dict[str, Any]:
        gain = paired_gain(
            self._judged(controller), self._judged(rival), self._dearest, self._bands, self.resamples
        )
        short = verdicts.failing_bands(rates[controller])
        objections = [f"`{controller}` passes too few trips: {_list(short)}"] if short else []
        if gain["attributable_energy_pct"] is None:
            objections.append(f"there is no trip that both `{controller}` and `{rival}` pass")
        dearer = [
            name
            for name, band in gain["bands"].items()
            if (low := band["difference_ci95"][0]) is not None and low > 0.0
        ]
        if dearer:
            objections.append(f"`{controller}` needs more energy than `{rival}` in {', '.join(dearer)}")
        return {**gain, "objections": objections}

    def _judged(self, controller: str) -> JudgedTrips:
        return judged_trips(self.runs[self.runs["controller"] == controller], self._names)

    @cached_property
    def _names(self) -> list[str]:
        return [scenario.name for scenario in self.grid.scenarios]

    @cached_property
    def _dearest(self) -> dict[float, NDArray[np.float64]]:
        return {credit: dearest_kwh(self.runs, self._names, credit) for credit in CREDITS}

    @cached_property
    def _bands(self) -> dict[str, NDArray[np.bool_]]:
        scenarios = self.grid.scenarios
        return {
            band.name: np.array([scenario.band == band for scenario in scenarios]) for band in self.grid.bands
        }


def _evidence(gain: Mapping[str, Any]) -> dict[str, Any]:
    """What a claim rests on: pairs, and the bands without any, of which it says nothing."""
    empty = [name for name, band in gain["bands"].items() if not band["pairs"]]
    return {"pairs": gain["pairs"], "bands_without_pairs": empty}


def _list(shares: Mapping[str, float]) -> str:
    return ", ".join(f"{share:.0f} % in {name}" for name, share in shares.items())
