"""KPIs as people read them: words, unit, digits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Kpi:
    """A KPI in a table.

    Attributes:
        name: Its name in the summary.
        label: Words.
        unit: Unit.
        decimals: Digits after the point.
    """

    name: str
    label: str
    unit: str
    decimals: int


PRIMARY: Final = (
    Kpi("attributable_energy_kwh", "Attributable energy", "kWh per trip", 2),
    Kpi("attributable_energy_kwh_per_100_km", "Attributable energy", "kWh/100 km", 2),
    Kpi("discomfort_k", "Mean discomfort", "K", 2),
    Kpi("heat_left_kwh", "Heat left at arrival", "kWh per trip", 2),
    Kpi("stranded", "Stranded trips", "count", 0),
)

DIAGNOSTICS: Final = (
    Kpi("energy_kwh", "Energy at the battery's terminals", "kWh", 2),
    Kpi("chemical_energy_kwh", "Energy drawn from the cells", "kWh", 2),
    Kpi("reference_energy_kwh", "Cell energy of the reference trip", "kWh", 2),
    Kpi("compressor_energy_kwh", "Compressor", "kWh", 3),
    Kpi("ptc_energy_kwh", "PTC heater", "kWh", 3),
    Kpi("pump_energy_kwh", "Coolant pumps", "kWh", 3),
    Kpi("blower_energy_kwh", "Blower", "kWh", 3),
    Kpi("fan_energy_kwh", "Fan", "kWh", 3),
    Kpi("range_km", "Range of a full battery", "km", 0),
    Kpi("final_soc_pct", "Usable SOC at arrival", "%", 1),
    Kpi("time_to_comfort_s", "Time to comfort (whole trip if never)", "s", 0),
    Kpi("comfortable_share_pct", "Time within 1 K of 22 °C", "%", 1),
    Kpi("battery_window_k_h", "Battery outside its window", "K h", 2),
    Kpi("protection_trips", "Protection events", "per trip", 2),
    Kpi("compressor_starts", "Compressor starts", "per trip", 2),
    Kpi("limit_breaches", "Time beyond a limit, all trips of the headline", "s", 0),
    Kpi("distance_km", "Distance", "km", 1),
    Kpi("duration_s", "Duration", "s", 0),
    Kpi("delay_s", "Delay at arrival", "s", 1),
    Kpi("trips", "Trips driven, headline bands, all seeds", "count", 0),
)
