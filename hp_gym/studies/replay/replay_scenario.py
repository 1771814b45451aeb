"""A measured trip as a scenario: what the trace says, and what stands in for what it does not say."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from hp_gym import toml_files
from hp_gym.overrides import Value
from hp_gym.studies import car_settings
from hp_gym.studies.csv_columns import Columns
from hp_gym.studies.replay import measured_quantities
from hp_gym.studies.replay.measured_trace import MeasuredTrace

SCENARIO: Final = "jeffs2019/case1-1"
"""Gives what neither the trace nor an own scenario says."""

CONTROLLER: Final = "hpcu-modern"
"""Rules of a replay without an own scenario: what cars of today do."""

STATE_OF_CHARGE_PCT: Final = 80.0
"""Start of a replay without an own scenario; a full battery would not recuperate."""

CLIMATE: Final = {
    "ambient_degc": "ambient temperature",
    "relative_humidity_pct": "relative humidity",
    "solar_w_m2": "sun",
    "wind_m_s": "wind",
    "occupants": "occupants",
}
"""Columns of a trace that are weather and people."""

SETTINGS: Final = {
    "cabin_set_point_degc": "cabin set point",
    "blower_level": "blower",
    "recirculation": "recirculation",
}
"""Columns of a trace that a driver sets."""

AMBIENT: Final = "ambient_degc"

_HUMID_BELOW_DEGC: Final = 25.0
_SUMMER_HUMIDITY: Final = 0.4


def roles(columns: Columns, scenario: str) -> dict[str, Value]:
    """What a trace is for a scenario: its cycle, and its climate and settings where it has such columns.

    Args:
        columns: The trace.
        scenario: Name or path of the scenario.
    """
    path = str(columns.path)
    found: dict[str, Value] = {"scenario.cycle": path}
    if CLIMATE.keys() & set(columns.names):
        found["scenario.climate.series"] = path
    if SETTINGS.keys() & set(columns.names):
        # A key of a table that is not there would be refused.
        has_table = any("settings" in tables for _, tables in toml_files.chain("scenario", scenario))
        found |= {"scenario.settings.series": path} if has_table else {"scenario.settings": {"series": path}}
    return found


def usual(columns: Columns, vehicle: str) -> dict[str, Value]:
    """What stands for a scenario where the user gave none: as for the cars of `hp-gym validate`.

    Args:
        columns: The trace.
        vehicle: Name or path of the car.
    """
    found: dict[str, Value] = car_settings.used(vehicle, {"climate_control": "auto"})
    found["scenario.initial.state_of_charge_pct"] = STATE_OF_CHARGE_PCT
    if AMBIENT in columns.names and columns.numbers(AMBIENT)[:1].max(initial=-np.inf) >= _HUMID_BELOW_DEGC:
        found["scenario.climate.relative_humidity"] = _SUMMER_HUMIDITY
    return found


def first_temperatures(trace: MeasuredTrace, layout: Mapping[str, Any]) -> dict[str, float]:
    """Initial temperatures of batteries, and of cabins with their furnishings, where they were measured.

    Args:
        trace: What was measured.
        layout: What the car is made of.
    """
    starts = (
        (measured_quantities.BATTERY_TEMPERATURE, measured_quantities.battery_members(layout)),
        (measured_quantities.CABIN_TEMPERATURE, measured_quantities.cabin_members(layout)),
    )
    return {
        f"scenario.initial.{member}_temperature_degc": trace.first[quantity.name]
        for quantity, members in starts
        if quantity.name in trace.first
        for member in members
    }


def notes(trace: MeasuredTrace, ambient_degc: float, changed: Sequence[str]) -> list[str]:
    """What a reader has to know of where a replay's values come from.

    Args:
        trace: What was measured.
        ambient_degc: Ambient temperature at the start.
        changed: Keys that the user changed.
    """
    told = []
    first = trace.first
    if measured_quantities.CABIN_TEMPERATURE.name in first:
        degc = first[measured_quantities.CABIN_TEMPERATURE.name]
        told.append(f"Cabin air and furnishings start at {degc:g} degC, measured first.")
    if measured_quantities.BATTERY_TEMPERATURE.name in first:
        degc = first[measured_quantities.BATTERY_TEMPERATURE.name]
        told.append(f"The battery starts at {degc:g} degC, measured first.")
    told.append("Every other mass starts at the scenario's soak temperature, by default ambient's first.")
    absent = [label for column, label in CLIMATE.items() if column not in trace.columns]
    if absent:
        told.append(
            f"Not in the trace, so the scenario's: {', '.join(absent)} ({ambient_degc:g} degC ambient)."
        )
    absent = [label for column, label in SETTINGS.items() if column not in trace.columns]
    if absent:
        told.append(f"Not in the trace, so the controller's: {', '.join(absent)}.")
    if changed:
        told.append(f"Changed: {', '.join(changed)}.")
    return told
