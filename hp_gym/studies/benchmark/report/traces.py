"""Trajectories as the page's drop-downs need them: few columns, few rows, few digits."""

from __future__ import annotations

import math
import string
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from hp_gym.studies.benchmark.report.energy_flows import JOULE_PER_KWH, electricity, heat, links
from hp_gym.vehicle_layout import in_order, of_table, spelled

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pandas as pd
    from numpy.typing import NDArray

    from hp_gym.studies.benchmark.report.energy_flows import Link
    from hp_gym.vehicle_layout import Layout

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


CURVES: Final[dict[str, Curve]] = {
    "speed_km_h": Curve("speed_m_s", 3.6, 1),
    "ambient_degc": Curve("ambient_temperature_degc", 1.0, 1),
    "soc_pct": Curve("soc", 100.0, 2),
}
"""What is drawn of every vehicle; `curves` adds what a vehicle has."""

DIGITS: Final = string.digits + string.ascii_lowercase
NOT_THERE: Final = "-"
"""In place of a digit for a member that a vehicle lacks."""


@dataclass(frozen=True)
class Timelines:
    """Members and loops of all vehicles of a page together, by name.

    Attributes:
        members: Labels of what can be connected to a coolant loop, in the order of the timelines.
        loops: Labels and sides of the loops, in the order of their digits.
    """

    members: Mapping[str, str]
    loops: Mapping[str, tuple[str, str]]

    @classmethod
    def of(cls, layouts: Sequence[Layout]) -> Timelines:
        """Returns those of some vehicles."""
        return cls(
            {
                member["name"]: spelled(member["name"])
                for layout in layouts
                for member in in_order(layout)
                if member["connection"] is not None
            },
            {loop["name"]: (loop["label"], loop["side"]) for layout in layouts for loop in layout["loops"]},
        )

    def packed(self, table: pd.DataFrame, layout: Layout, rows: NDArray[np.int64]) -> list[str]:
        """Returns a text of digits for each member: 0 isolated, or the place of its loop, counted from 1."""
        places = list(self.loops)
        digits = ["0", *(DIGITS[places.index(loop["name"]) + 1] for loop in layout["loops"])]
        columns = {member["name"]: member["connection"] for member in layout["members"]}
        return [
            NOT_THERE * len(rows)
            if columns.get(member) is None
            else "".join(digits[int(value)] for value in table[columns[member]].to_numpy()[rows])
            for member in self.members
        ]


def curves(layout: Layout) -> dict[str, dict[str, tuple[str, Curve]]]:
    """Returns label and curve by key, for each panel of curves that depend on the vehicle."""
    tempered = [
        member
        for member in layout["members"]
        if member["kind"] in {"cabin", "battery"} and member["temperature"]
    ]
    powers = {
        _key(heater["power"], "_power_w", "kw"): (heater["label"], _power(heater["power"]))
        for heater in layout["heaters"]
    }
    if layout["refrigerates"]:
        powers = {"compressor_kw": ("compressor", _power("compressor_power_w")), **powers}
    return {
        "temperature": {
            _key(str(member["temperature"]), "_temperature_degc", "degc"): (
                member["label"],
                Curve(str(member["temperature"]), 1.0, 2),
            )
            for member in sorted(tempered, key=lambda member: member["kind"] != "cabin")
        },
        "supply": {
            _key(loop["supply"], "_temperature_degc", "degc"): (loop["label"], Curve(loop["supply"], 1.0, 2))
            for loop in layout["loops"]
        },
        "power": powers,
    }


def _power(column: str) -> Curve:
    return Curve(column, 1e-3, 3, mean=True)


def _key(column: str, ending: str, unit: str) -> str:
    return f"{column.removesuffix(ending)}_{unit}"


def pack(trajectories: Mapping[str, Mapping[str, pd.DataFrame]]) -> dict[str, Any]:
    """Returns all trajectories as data for the page.

    Args:
        trajectories: Signals second by second, by scenario, then by controller. Each table knows its vehicle
            (`hp_gym.vehicle_layout.keep`); without, it is taken for the default one.

    Returns:
        `step_s`; `members`, `loops` (label and side) and `curves` (key and label by panel) of all vehicles
        together; and `scenarios`: by scenario and controller the curves (`CURVES`, those of `curves` that the
        vehicle has, and the energy drawn from the cells so far, `cells_kwh`), a text of digits for each
        member (0 isolated, or the number of a loop; `-` where the vehicle has no such member), and the links
        of the two Sankey diagrams.
    """
    tables = [table for runs in trajectories.values() for table in runs.values()]
    layouts = list({text: of_table(table) for table in tables for text in [str(table.attrs)]}.values())
    timelines = Timelines.of(layouts)
    step_s = thinning([len(table) for table in tables])
    labels: dict[str, dict[str, str]] = {}
    for layout in layouts:
        for panel, some in curves(layout).items():
            labels.setdefault(panel, {}).update({key: label for key, (label, _) in some.items()})
    return {
        "step_s": step_s,
        "members": list(timelines.members.values()),
        "loops": list(timelines.loops.values()),
        "curves": {panel: list(some.items()) for panel, some in labels.items()},
        "scenarios": {
            scenario: {controller: _run(table, timelines, step_s) for controller, table in runs.items()}
            for scenario, runs in trajectories.items()
        },
    }


def thinning(lengths_s: Sequence[int]) -> int:
    """Returns the seconds between points that keep trajectories of these lengths within `POINTS`."""
    return next((step_s for step_s in STEPS_S if sum(lengths_s) <= step_s * POINTS), STEPS_S[-1])


def _run(table: pd.DataFrame, timelines: Timelines, step_s: int) -> dict[str, Any]:
    layout = of_table(table)
    rows = np.unique(np.append(np.arange(0, len(table), step_s), len(table) - 1))
    own = {key: curve for some in curves(layout).values() for key, (_, curve) in some.items()}
    drawn = {
        name: _rounded(_values(table, curve, rows), curve.decimals) for name, curve in (CURVES | own).items()
    }
    cells_kwh = np.cumsum(table["battery_chemical_power_w"].to_numpy(float)) / JOULE_PER_KWH
    return {
        "time_min": _rounded(table["time_s"].to_numpy(float)[rows] / 60.0, 3),
        **drawn,
        "cells_kwh": _rounded(cells_kwh[rows], 4),
        "connections": timelines.packed(table, layout, rows),
        "electricity": _rounded_links(links(table, electricity(layout))),
        "heat": _rounded_links(links(table, heat(layout))),
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


def _rounded_links(some: Sequence[Link]) -> list[list[str | float]]:
    return [[source, target, round(kwh, 4)] for source, target, kwh in some]
