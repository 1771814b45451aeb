"""Modes driven over ambient temperatures, and compared where they are equally comfortable."""

import os
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.messages import OneLineError
from hp_gym.overrides import Overrides, assignments
from hp_gym.studies import planned_runs
from hp_gym.studies.axes import parse_axis
from hp_gym.studies.heat_modes.enumeration import Mode, modes

AMBIENTS_DEGC: Final = tuple(float(f"{value:.4g}") for value in np.linspace(-20.0, 40.0, 15))
"""Fifteen, evenly from -20 to 40 degC."""

COMFORT_K: Final = 1.0
"""A mode is comfortable where its discomfort is at most this much above the least of all modes."""

_SCENARIO: Final = "jeffs2019/case1-1"
_ARRIVED: Final = "arrived"
_LARGEST_REQUEST_W: Final = 20_000.0
_HUMID_DEGC: Final = 25.0
_SOURCES: Final = ("motor", "transmission", "front-end")


class ModesError(OneLineError):
    """Modes cannot be compared: no such vehicle, or nothing in it that could be combined."""


@dataclass(frozen=True)
class Compared:
    """Modes of a vehicle over ambient temperatures.

    Attributes:
        vehicle: Its name or path.
        cycle: What is driven.
        controller: Rules that set all levels.
        ambients_degc: Ambient temperatures.
        modes: Modes.
        energy_kwh: Energy from the battery, a row a mode; NaN where a trip does not arrive.
        discomfort_k: Mean distance of the cabin from 22 degC, likewise.
    """

    vehicle: str
    cycle: str
    controller: str
    ambients_degc: tuple[float, ...]
    modes: tuple[Mode, ...]
    energy_kwh: NDArray[np.float64]
    discomfort_k: NDArray[np.float64]

    @property
    def comfortable(self) -> NDArray[np.bool_]:
        """Whether each mode arrives and is comfortable at each ambient temperature."""
        least_k = np.nanmin(self.discomfort_k, axis=0)
        return np.asarray(self.discomfort_k <= least_k + COMFORT_K)

    @property
    def energy_at_comfort_kwh(self) -> NDArray[np.float64]:
        """Energy of comfortable modes, NaN of the others."""
        return np.where(self.comfortable, self.energy_kwh, np.nan)

    @property
    def excess_pct(self) -> NDArray[np.float64]:
        """Energy beyond the best comfortable mode's at the same ambient temperature [%]."""
        energy_kwh = self.energy_at_comfort_kwh
        return np.asarray(100.0 * (energy_kwh / np.nanmin(energy_kwh, axis=0) - 1.0))

    def ranking(self, ambient: int) -> list[int]:
        """Modes at an ambient temperature: comfortable ones by energy, then the others by discomfort."""
        energy_kwh = self.energy_at_comfort_kwh[:, ambient]
        discomfort_k = np.nan_to_num(self.discomfort_k[:, ambient], nan=np.inf)
        return [int(mode) for mode in np.lexsort((discomfort_k, np.nan_to_num(energy_kwh, nan=np.inf)))]

    def overall(self) -> list[int]:
        """Modes by the number of ambient temperatures at which they are comfortable, then by mean excess."""
        counts = self.comfortable.sum(axis=1)
        sums = np.nan_to_num(self.excess_pct).sum(axis=1)
        return [int(mode) for mode in np.lexsort((sums / np.maximum(counts, 1), -counts))]

    def to_json(self) -> dict[str, Any]:
        """The comparison as plain data."""
        best = [self.ranking(place)[0] for place in range(len(self.ambients_degc))]
        return {
            "vehicle": self.vehicle,
            "cycle": self.cycle,
            "controller": self.controller,
            "comfort_k": COMFORT_K,
            "ambients_degc": list(self.ambients_degc),
            "modes": [mode.to_json() for mode in self.modes],
            "energy_kwh": self.energy_kwh.tolist(),
            "discomfort_k": self.discomfort_k.tolist(),
            "comfortable": self.comfortable.tolist(),
            "best": [self.modes[mode].name for mode in best],
        }


def compare(
    vehicle: str | os.PathLike[str] = "jeffs2019",
    *,
    cycle: str | os.PathLike[str] = "wltc-class3b",
    controller: str | os.PathLike[str] = "hpcu-modern",
    ambients_degc: tuple[float, ...] = AMBIENTS_DEGC,
    store_degc: float | None = None,
    overrides: Overrides | None = None,
    threads: int | None = None,
) -> Compared:
    """Drives all modes of a vehicle at all ambient temperatures.

    Connections hold for the whole trip; the plant still opens one whose heat would flow the wrong way. Rules
    treat the battery, connect the cabin, switch between heating and cooling, and set all levels.

    Args:
        vehicle: Name or path.
        cycle: Name or path of a drive cycle.
        controller: Name or path of rules.
        ambients_degc: Ambient temperatures; all starts soaked at them.
        store_degc: Temperature of heat stores at the start; soaked by default: no heat is for free.
        overrides: Changes for all runs.
        threads: Native threads; one a processor by default.

    Raises:
        ModesError: The vehicle has nothing to combine, or the plant refuses a run.
        ConfigurationError: There is no such vehicle.
    """
    name = os.fspath(vehicle)
    if not ambients_degc:
        raise ModesError("there must be at least one ambient temperature")
    changes = assignments(overrides)
    own = [change.removeprefix("vehicle.") for change in changes if change.startswith("vehicle.")]
    layout = _core.vehicle_layout(name, own)
    found = modes(layout)
    if not found:
        raise ModesError(f"vehicle `{name}` has neither a heat pump nor a heater")
    always = {**_always(layout, store_degc), "scenario.cycle": os.fspath(cycle)}
    planned: list[planned_runs.Planned] = [
        (
            _SCENARIO,
            os.fspath(controller),
            name,
            [*assignments({**always, **_weather(ambient), **_held(mode)}), *changes],
        )
        for mode in found
        for ambient in ambients_degc
    ]
    shape = len(found), len(ambients_degc)
    energy_kwh, discomfort_k = _drive(planned, shape, threads or planned_runs.processors())
    return Compared(
        name,
        os.fspath(cycle),
        os.fspath(controller),
        tuple(ambients_degc),
        tuple(found),
        energy_kwh,
        discomfort_k,
    )


def _drive(
    planned: list[planned_runs.Planned], shape: tuple[int, int], threads: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Energy [kWh] and discomfort [K], a row a mode; NaN where a trip does not arrive.

    Raises:
        ModesError: The plant refuses a run.
    """
    totals = planned_runs.drive(planned, threads)
    refusal = next((reason for reason in totals.refusals if reason is not None), None)
    if refusal is not None:
        raise ModesError(refusal)
    arrived = np.array([end == _ARRIVED for end in totals.ends])

    def table(total: str) -> NDArray[np.float64]:
        values = np.where(arrived, totals.values[:, totals.names.index(total)], np.nan)
        return values.reshape(shape)

    return table("energy_kwh"), table("discomfort_k")


def ambients(text: str) -> tuple[float, ...]:
    """Reads ambient temperatures of the command line: `LOW:HIGH/COUNT`, `LOW:HIGH:STEP` or `A,B,C`.

    Raises:
        ValueError: It is none of these.
    """
    _, values = parse_axis(f"ambient={text}")
    if not isinstance(values, list):
        raise ModesError(f"ambient `{text}` must be LOW:HIGH/COUNT, LOW:HIGH:STEP or A,B,C")
    numbers = [value for value in values if isinstance(value, int | float) and not isinstance(value, bool)]
    if len(numbers) != len(values):
        raise ModesError(f"ambient `{text}` must be temperatures in degC")
    return tuple(float(f"{value:.4g}") for value in numbers)


def _always(layout: Any, store_degc: float | None) -> dict[str, Any]:
    """What holds in all modes: nothing limits heat flows, and no source is barred."""
    members = layout["members"]
    requests = {
        f"scenario.heat_demand.{member['name']}_w": _LARGEST_REQUEST_W
        for member in members
        if member["connection"]
    }
    sources = {
        f"scenario.strategy.{member['name']}": True for member in members if member["kind"] in _SOURCES
    }
    changes: dict[str, Any] = {"scenario.strategy.climate_control": "auto", **requests, **sources}
    if store_degc is not None:
        stores = [member["name"] for member in members if member["kind"] == "store"]
        changes |= {f"scenario.initial.{store}_temperature_degc": store_degc for store in stores}
    return changes


def _weather(ambient_degc: float) -> dict[str, Any]:
    humidity = 0.8 if ambient_degc < _HUMID_DEGC else 0.4
    return {
        "scenario.climate.ambient_temperature_degc": ambient_degc,
        "scenario.climate.relative_humidity": humidity,
    }


def _held(mode: Mode) -> dict[str, Any]:
    schedule = [
        {"from_s": 0.0, "member": member, "connection": option} for member, option in mode.connections
    ]
    return {
        "scenario.strategy.battery": mode.battery,
        "scenario.strategy.ptc": mode.ptc,
        "scenario.strategy.heat_pump": mode.heat_pump,
        "scenario.connection_schedule": schedule,
    }
