"""Trajectories as the page's drop-downs need them: few columns, few rows, few digits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from hp_gym.studies.benchmark.report.energy_flows import ELECTRICITY, HEAT, JOULE_PER_KWH, links

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pandas as pd
    from numpy.typing import NDArray

MEMBERS: Final = ("cabin", "battery", "motor", "transmission", "ambient", "thermal_battery")
"""What can be connected to a coolant loop, in the order of the timelines."""

STEPS_S: Final = (2, 5, 10, 20, 60)
"""Seconds between the points that are drawn."""

POINTS: Final = 60_000
"""Points of time in all trajectories together; each costs some 70 bytes."""


@dataclass(frozen=True)
class Curve:
    """A column as it is drawn.

    Attributes:
        column: Column of a trajectory.
        scale: From the column's unit to the one that is drawn.
        decimals: Digits kept after the point.
        mean: Whether a point is the mean since the last one, as of powers, not the value at that time.
    """

    column: str
    scale: float
    decimals: int
    mean: bool = False


CURVES: Final[Mapping[str, Curve]] = {
    "speed_km_h": Curve("speed_m_s", 3.6, 1),
    "cabin_degc": Curve("cabin_temperature_degc", 1.0, 2),
    "battery_degc": Curve("battery_temperature_degc", 1.0, 2),
    "ambient_degc": Curve("ambient_temperature_degc", 1.0, 1),
    "htc_supply_degc": Curve("htc_supply_temperature_degc", 1.0, 2),
    "chiller_supply_degc": Curve("chiller_supply_temperature_degc", 1.0, 2),
    "compressor_kw": Curve("compressor_power_w", 1e-3, 3, mean=True),
    "ptc_kw": Curve("ptc_power_w", 1e-3, 3, mean=True),
    "soc_pct": Curve("soc", 100.0, 2),
}


def pack(trajectories: Mapping[str, Mapping[str, pd.DataFrame]]) -> dict[str, Any]:
    """Returns all trajectories as data for the page.

    Args:
        trajectories: Signals second by second, by scenario, then by controller.

    Returns:
        `step_s`, `members` and `scenarios`: by scenario and controller the curves (`CURVES` and the energy
        drawn from the cells so far, `cells_kwh`), a text of digits for each member (0 isolated, 1 HTC,
        2 chiller loop), and the links of the two Sankey diagrams.
    """
    step_s = thinning([len(table) for runs in trajectories.values() for table in runs.values()])
    return {
        "step_s": step_s,
        "members": [member.replace("_", " ") for member in MEMBERS],
        "scenarios": {
            scenario: {controller: _run(table, step_s) for controller, table in runs.items()}
            for scenario, runs in trajectories.items()
        },
    }


def thinning(lengths_s: Sequence[int]) -> int:
    """Returns the seconds between points that keep trajectories of these lengths within `POINTS`."""
    return next((step_s for step_s in STEPS_S if sum(lengths_s) <= step_s * POINTS), STEPS_S[-1])


def _run(table: pd.DataFrame, step_s: int) -> dict[str, Any]:
    rows = np.unique(np.append(np.arange(0, len(table), step_s), len(table) - 1))
    curves = {name: _rounded(_values(table, curve, rows), curve.decimals) for name, curve in CURVES.items()}
    cells_kwh = np.cumsum(table["battery_chemical_power_w"].to_numpy(float)) / JOULE_PER_KWH
    return {
        "time_min": _rounded(table["time_s"].to_numpy(float)[rows] / 60.0, 3),
        **curves,
        "cells_kwh": _rounded(cells_kwh[rows], 4),
        "connections": [
            "".join(str(int(loop)) for loop in table[f"{member}_connection"].to_numpy()[rows])
            for member in MEMBERS
        ],
        "electricity": _rounded_links(table, electricity=True),
        "heat": _rounded_links(table, electricity=False),
    }


def _values(table: pd.DataFrame, curve: Curve, rows: NDArray[np.int64]) -> NDArray[np.float64]:
    values = curve.scale * table[curve.column].to_numpy(float)
    if not curve.mean:
        return values[rows]
    # The power of a row is that of the second before it; the first row has none.
    so_far = np.concatenate([[0.0], np.cumsum(values[1:])])[rows]
    return np.concatenate([[0.0], np.diff(so_far) / np.diff(rows)])


def _rounded(values: NDArray[np.float64], decimals: int) -> list[float | int | None]:
    return [_short(value, decimals) for value in values.tolist()]


def _short(value: float, decimals: int) -> float | int | None:
    if not math.isfinite(value):
        return None
    short = round(value, decimals)
    return int(short) if short == int(short) else short


def _rounded_links(table: pd.DataFrame, *, electricity: bool) -> list[list[str | float]]:
    diagram = ELECTRICITY if electricity else HEAT
    return [[source, target, round(kwh, 4)] for source, target, kwh in links(table, diagram)]
