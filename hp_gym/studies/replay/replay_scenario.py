"""A measured trip as a scenario: what the trace says, and what stands in for what it does not say."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

from hp_gym.studies import car_settings
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

_HUMID_BELOW_DEGC: Final = 25.0


def changes(
    trace: MeasuredTrace, vehicle: str, layout: Mapping[str, Any], *, own_scenario: bool
) -> dict[str, bool | float | str]:
    """What of a scenario differs on a measured trip.

    Args:
        trace: What was measured.
        vehicle: Name or path of the car.
        layout: What it is made of.
        own_scenario: Whether the user gave a scenario: nothing but what the trace says is changed then.
    """
    path = str(trace.path)
    found: dict[str, bool | float | str] = {} if own_scenario else _usual(trace, vehicle)
    found["scenario.cycle"] = path
    if CLIMATE.keys() & set(trace.columns):
        found["scenario.climate.series"] = path
    if SETTINGS.keys() & set(trace.columns):
        found["scenario.settings.series"] = path
    return found | _first_temperatures(trace, layout)


def _usual(trace: MeasuredTrace, vehicle: str) -> dict[str, bool | float | str]:
    """What stands for a scenario where the user gave none, as for the cars of `hp-gym validate`."""
    usual = car_settings.used(vehicle, {"climate_control": "auto"})
    usual["scenario.initial.state_of_charge_pct"] = STATE_OF_CHARGE_PCT
    if trace.first_ambient_degc is not None and trace.first_ambient_degc >= _HUMID_BELOW_DEGC:
        usual["scenario.climate.relative_humidity"] = 0.4
    return usual


def _first_temperatures(trace: MeasuredTrace, layout: Mapping[str, Any]) -> dict[str, float]:
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
