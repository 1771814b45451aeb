"""Cars on the road: many runs in one native call, and the figures of each."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from hp_gym import _core
from hp_gym.overrides import assignments
from hp_gym.studies import car_settings, planned_runs
from hp_gym.studies.planned_runs import REFUSED, Planned
from hp_gym.studies.published_values import speed_traces
from hp_gym.studies.published_values.published import Published, TripExperiment, ValidationFileError
from hp_gym.studies.published_values.rigs import Figures

EMPTY: Final = "battery_empty"
"""How a trip ends that is driven until nothing is left."""

LONGEST_KM: Final = 700.0
"""No car here goes further; what does, ends the run with an error."""

_COAST_DOWN_K: Final = 297.05
_ZERO_CELSIUS_K: Final = 273.15

_OFF: Final = {"heat_pump": False, "ptc": False}
_NO_AIR: Final = {
    "controller.blower_level": 0.0,
    "controller.cooling_blower_level": 0.0,
    "controller.options.heating_blower_band_k": 0.0,
    "controller.options.cooling_blower_band_k": 0.0,
}


@dataclass(frozen=True)
class Trip:
    """A run of an experiment.

    Attributes:
        experiment: Its name.
        key: Car, and ambient temperature where there are several.
        planned: What is driven.
        until_empty: Whether it is to end with an empty battery.
    """

    experiment: str
    key: str
    planned: Planned
    until_empty: bool


def plan(
    published: Published, experiment: TripExperiment, vehicles: Mapping[str, str], folder: Path
) -> list[Trip]:
    """Plans the runs of an experiment, one for each car and ambient temperature.

    Args:
        published: The file.
        experiment: What is driven.
        vehicles: Names or paths of vehicles by the file's names of cars.
        folder: For traces.
    """
    named = {car: vehicles[car] for car in experiment.cars}
    if experiment.vehicle is not None:
        named[experiment.vehicle] = experiment.vehicle
    ambients = experiment.ambients_degc or (experiment.ambient_degc or 0.0,)
    cycle = _cycle(experiment, folder)
    controller = experiment.controller or published.controller
    trips = []
    for car, vehicle in named.items():
        for ambient_degc in ambients:
            changes = _changes(experiment, vehicle, cycle, ambient_degc)
            if experiment.climate == "off" and controller == published.controller:
                changes |= _NO_AIR
            key = car if len(ambients) == 1 else f"{car} {ambient_degc:g}"
            planned = (published.scenario, controller, vehicle, assignments(changes))
            trips.append(Trip(experiment.name, key, planned, experiment.until_empty))
    return trips


def _cycle(experiment: TripExperiment, folder: Path) -> str:
    if experiment.cruise_km_h is not None:
        speeds = speed_traces.constant(experiment.cruise_km_h, round(60.0 * (experiment.minutes or 0.0)))
        return str(speed_traces.write(folder / f"{experiment.name}.csv", speeds))
    if len(experiment.cycles) == 1 and not experiment.until_empty:
        return experiment.cycles[0]
    path = folder / f"{'-'.join(experiment.cycles)}-{experiment.until_empty}.csv"
    if not path.exists():
        speed_traces.write(
            path, speed_traces.repeated(experiment.cycles, LONGEST_KM if experiment.until_empty else 0.0)
        )
    return str(path)


def _changes(experiment: TripExperiment, vehicle: str, cycle: str, ambient_degc: float) -> dict[str, Any]:
    control = "auto" if experiment.climate == "off" else experiment.climate
    strategy = {"climate_control": control, **experiment.strategy}
    if experiment.climate == "off":
        strategy |= _OFF
    road_load = _fixed_road_load(vehicle, ambient_degc) if experiment.dynamometer else {}
    return {
        **car_settings.climate(ambient_degc, 0.8 if ambient_degc < 25.0 else 0.4, 0.0, occupants=1),
        **car_settings.used(vehicle, strategy),
        "scenario.cycle": cycle,
        "scenario.initial.state_of_charge_pct": 100.0,
        **{f"scenario.initial.{key}": value for key, value in experiment.initial.items()},
        **{f"vehicle.{key}": value for key, value in {**road_load, **experiment.changes}.items()},
    }


def _fixed_road_load(vehicle: str, ambient_degc: float) -> dict[str, float]:
    """Road load of a dynamometer: drag area in inverse proportion to density, tyres as in their test."""
    density = _COAST_DOWN_K / (ambient_degc + _ZERO_CELSIUS_K)
    return {
        "body.drag_area_m2": car_settings.number(vehicle, "body", "drag_area_m2") / density,
        "body.rolling_resistance_rise_per_k": 0.0,
    }


def run(trips: Sequence[Trip], threads: int) -> dict[str, dict[str, Figures]]:
    """Drives trips side by side.

    Returns:
        Figures by experiment and key.

    Raises:
        ValidationFileError: The plant refuses one, or one ends otherwise than it should.
    """
    totals = planned_runs.drive([trip.planned for trip in trips], threads)
    found: dict[str, dict[str, Figures]] = {}
    rows = zip(trips, totals.values, totals.ends, totals.refusals, strict=True)
    for trip, values, end, refusal in rows:
        if end == REFUSED:
            raise ValidationFileError(f"experiment `{trip.experiment}`, {trip.key}: {refusal}")
        if trip.until_empty and end != EMPTY:
            raise ValidationFileError(
                f"experiment `{trip.experiment}`, {trip.key}: ended with `{end}`, but must with `{EMPTY}`"
            )
        known = {name: float(value) for name, value in zip(totals.names, values, strict=True)}
        vehicle = trip.planned[2] or ""
        found.setdefault(trip.experiment, {})[trip.key] = known | _further(known, vehicle)
    return found


def _further(totals: Mapping[str, float], vehicle: str) -> Figures:
    """Energy for heating and cooling, and mean power besides traction."""
    layout = _core.vehicle_layout(vehicle)
    machines = ["compressor_power_w"] if layout["refrigerates"] else []
    machines += [heater["power"] for heater in layout["heaters"]]
    heating = sum(totals[f"{machine.removesuffix('_power_w')}_energy_kwh"] for machine in machines)
    auxiliary = totals["battery_energy_kwh"] - totals["traction_energy_kwh"]
    return {
        "heating_energy_kwh": float(np.float64(heating)),
        "auxiliary_power_kw": auxiliary / totals["duration_s"] * 3600.0,
    }
