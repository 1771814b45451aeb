"""Gains of a controller over rules: ratios of sums over trips, with intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from hp_gym.studies.benchmark import matched, statistics

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from hp_gym.studies.benchmark.statistics import Resamples, Trips

CREDITS: Final = (0.0, 0.5)
"""Shares of the heat left at arrival that are taken off the energy; a gain counts with the worse."""


def gain(
    agent: Trips, rules: Trips, front: Trips, resamples: Resamples, seeds: Sequence[int]
) -> dict[str, Any]:
    """Compares a controller with rules over the same trips; negative is less.

    A stranded trip has neither energy nor discomfort that could be compared. If the controller or the rules
    at their own set points stranded, there is no gain; settings of the front that stranded are left out.

    Args:
        agent: The controller, one row a training seed.
        rules: The rules at their own set points, one row.
        front: The rules with other set points, one row a setting.
        resamples: Resamples of these scenarios.
        seeds: Training seeds of the controller.

    Returns:
        The figures that docs/benchmark.md lists under `gains`.
    """
    stranded = {"controller": int(agent.stranded.sum()), "rules": int(rules.stranded.sum())}
    complete = front.runs(np.flatnonzero(front.stranded.sum(axis=1) == 0.0))
    if any(stranded.values()) or not len(complete.energy_kwh):
        none: dict[str, Any] = dict.fromkeys(("attributable_energy_pct", "ci95", "discomfort_k"))
        return none | {"seeds": list(seeds), "stranded_trips": stranded}
    agent_k = _discomfort_k(agent, resamples)
    rules_k = _discomfort_k(rules, resamples)
    front_k = resamples.each_run(complete.discomfort_k_h) / resamples.each_run(complete.occupied_h)
    by_credit = {}
    for credit in CREDITS:
        agent_kwh = resamples.mean_over_runs(agent.net_kwh(credit))
        front_kwh = resamples.each_run(complete.net_kwh(credit))
        rules_kwh = resamples.mean_over_runs(rules.net_kwh(credit))
        at_comfort_pct = change_pct(agent_kwh, matched.front_energy_kwh(agent_k, front_k, front_kwh))
        by_credit[f"{credit:g}"] = {
            **figure("attributable_energy_pct", "ci95", at_comfort_pct),
            **figure("own_set_points_pct", "own_set_points_ci95", change_pct(agent_kwh, rules_kwh)),
            "by_seed": _by_seed(agent, complete, credit, resamples, seeds),
        }
    worse = max(by_credit, key=lambda credit: _as_worst(by_credit[credit]["attributable_energy_pct"]))
    return {
        "attributable_energy_pct": by_credit[worse]["attributable_energy_pct"],
        "ci95": by_credit[worse]["ci95"],
        **figure("discomfort_k", "discomfort_ci95", agent_k - rules_k),
        "credit": float(worse),
        "matched": matched.how_matched(float(agent_k[0]), front_k[0]),
        "seeds": list(seeds),
        "by_credit": by_credit,
        "stranded_trips": stranded,
    }


def paired(agent: Trips, rules: Trips, resamples: Resamples) -> dict[str, Any]:
    """Compares a controller with rules as they are, over the same trips; negative is less."""
    if agent.stranded.any() or rules.stranded.any():
        return {"energy_difference_pct": None, "discomfort_difference_k": None}
    agent_kwh, rules_kwh = (resamples.mean_over_runs(each.energy_kwh) for each in (agent, rules))
    difference_k = _discomfort_k(agent, resamples) - _discomfort_k(rules, resamples)
    figures = figure("energy_difference_pct", "energy_difference_ci95", change_pct(agent_kwh, rules_kwh))
    figures |= figure("discomfort_difference_k", "discomfort_difference_ci95", difference_k)
    return figures | {"discomfort_difference_upper95_k": figures["discomfort_difference_ci95"][1]}


def change_pct(value: NDArray[np.float64], reference: NDArray[np.float64]) -> NDArray[np.float64]:
    """Change against a reference; not a number where that is not positive."""
    usable = np.where(reference > 0.0, reference, np.nan)
    return 100.0 * (value / usable - 1.0)


def _by_seed(
    agent: Trips, front: Trips, credit: float, resamples: Resamples, seeds: Sequence[int]
) -> dict[str, float | None]:
    """Gain of each training seed over all trips, without an interval."""
    weights = resamples.scenarios[0]
    front_k = (front.discomfort_k_h @ weights) / (front.occupied_h @ weights)
    front_kwh = front.net_kwh(credit) @ weights
    own_k = (agent.discomfort_k_h @ weights) / (agent.occupied_h @ weights)
    count = len(own_k)
    needed = matched.front_energy_kwh(own_k, np.tile(front_k, (count, 1)), np.tile(front_kwh, (count, 1)))
    changes_pct = change_pct(agent.net_kwh(credit) @ weights, needed)
    return {str(seed): number(change) for seed, change in zip(seeds, changes_pct, strict=True)}


def _discomfort_k(trips: Trips, resamples: Resamples) -> NDArray[np.float64]:
    return resamples.mean_over_runs(trips.discomfort_k_h) / resamples.mean_over_runs(trips.occupied_h)


def figure(name: str, interval_name: str, resampled: NDArray[np.float64]) -> dict[str, Any]:
    """A figure and its interval by name, of resamples that begin with the trips as they are."""
    return {name: number(resampled[0]), interval_name: statistics.interval(resampled[1:])}


def number(value: float) -> float | None:
    """The value, or None where there is none."""
    return float(value) if np.isfinite(value) else None


def _as_worst(value: float | None) -> float:
    return np.inf if value is None else value
