"""KPIs of one trip."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from hp_gym import comfort_standard
from hp_gym.studies.benchmark.results import IDENTITY, KPIS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hp_gym import _core
    from hp_gym.agents.controllers import Controller
    from hp_gym.studies.benchmark.grid import Scenario

ARRIVED: Final = "arrived"

# Taken as they are from the totals of a trip.
_TOTALS: Final = (
    "duration_s",
    "delay_s",
    "distance_km",
    "energy_kwh",
    "fan_energy_kwh",
    "final_soc_pct",
    "time_to_comfort_s",
    "compressor_starts",
    "limit_breaches",
    *(name for name in comfort_standard.FIGURES if name != "duration_s"),
)
_REWARD_TERMS: Final = (
    "attributable_energy_kwh",
    "discomfort_k",
    "heat_left_kwh",
    "chemical_energy_kwh",
    "reference_energy_kwh",
    "battery_window_k_h",
    "protection_trips",
)


def measure(
    controller: Controller, scenario: Scenario, trip: _core.FinishedTrip, layout: Mapping[str, Any]
) -> dict[str, Any]:
    """Returns the KPIs of a trip that has ended.

    Args:
        controller: Who drove.
        scenario: What was driven.
        trip: How it went.
        layout: What its vehicle is made of.
    """
    terms, totals = trip.kpis, trip.summary
    distance_km = totals["distance_km"]
    charge_used_pct = scenario.variant.state_of_charge_pct - totals["final_charge_soc_pct"]
    values = {name: terms[name] for name in _REWARD_TERMS} | {name: totals[name] for name in _TOTALS}
    values |= {
        "attributable_energy_kwh_per_100_km": _quotient(
            100.0 * terms["attributable_energy_kwh"], distance_km
        ),
        **energies_kwh(totals, layout),
        # A full battery at this trip's consumption of charge.
        "range_km": _quotient(100.0 * distance_km, charge_used_pct),
        "comfortable_share_pct": 100.0 * totals["comfortable_share"],
        "stranded": 0.0 if trip.end_reason == ARRIVED else 1.0,
    }
    identity = {
        "controller": controller.name,
        "seed": controller.seed,
        "scenario": scenario.name,
        "variant": scenario.variant.name,
        "cycle": scenario.cycle.name,
        "ambient_temperature_degc": scenario.ambient_temperature_degc,
        "band": scenario.band.name,
        "end_reason": trip.end_reason,
    }
    return {name: identity[name] for name in IDENTITY} | {name: values[name] for name in KPIS}


def energies_kwh(totals: Mapping[str, float], layout: Mapping[str, Any]) -> dict[str, float]:
    """Returns the energy of machines that a car may have one, several or none of, added up by kind [kWh].

    The PTC stands for all heaters, the blower for those of all cabins.

    Args:
        totals: Totals of a trip.
        layout: What the car is made of.
    """
    powers = {
        "compressor_energy_kwh": ["compressor_power_w"] if layout["refrigerates"] else [],
        "ptc_energy_kwh": [heater["power"] for heater in layout["heaters"]],
        "blower_energy_kwh": [cabin["blower_power"] for cabin in layout["cabins"]],
        "pump_energy_kwh": [loop["pump_power"] for loop in layout["loops"]],
    }
    return {
        kpi: sum((totals[f"{column.removesuffix('_power_w')}_energy_kwh"] for column in columns), 0.0)
        for kpi, columns in powers.items()
    }


def _quotient(value: float, divisor: float) -> float:
    """What does not exist, for a trip of 0 km or one that used no charge, is NaN."""
    return value / divisor if divisor else float("nan")
