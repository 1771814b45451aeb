"""What may be measured on a trip, and which columns of a run are the same of the model."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from hp_gym import vehicle_layout
from hp_gym.trajectory import Trajectory

Channels = Mapping[str, NDArray[np.float64]]
"""Values at the full seconds of a trip, by the name of a quantity; what there is not is not there."""


@dataclass(frozen=True)
class Quantity:
    """Something that can be measured.

    Attributes:
        name: Name with its unit, without `measured_`.
        label: Name for people.
        unit: Unit for people.
    """

    name: str
    label: str
    unit: str

    @property
    def column(self) -> str:
        """Its column in a trace."""
        return f"measured_{self.name}"


BATTERY_POWER: Final = Quantity("battery_power_w", "Battery power", "W")
"""At the terminals, discharging positive."""
HEATER_POWER: Final = Quantity("heater_power_w", "Heater power", "W")
"""Electrical power of all heaters and of the compressor; pumps, blower and fans do not count."""
CABIN_TEMPERATURE: Final = Quantity("cabin_temperature_degc", "Cabin temperature", "°C")
"""Of the cabin's air."""
BATTERY_TEMPERATURE: Final = Quantity("battery_temperature_degc", "Battery temperature", "°C")
"""Of the cells, in the mean."""

QUANTITIES: Final = (BATTERY_POWER, HEATER_POWER, CABIN_TEMPERATURE, BATTERY_TEMPERATURE)


def battery_members(layout: Mapping[str, Any]) -> list[str]:
    """Names of the batteries of a vehicle."""
    members = vehicle_layout.typed(layout)["members"]
    return [member["name"] for member in members if member["kind"] == "battery"]


def cabin_members(layout: Mapping[str, Any]) -> list[str]:
    """Names of the cabins of a vehicle, that whose comfort counts first."""
    cabins = sorted(vehicle_layout.typed(layout)["cabins"], key=lambda cabin: not cabin["comfort"])
    return [cabin["member"] for cabin in cabins]


def of_model(trajectory: Trajectory) -> dict[str, NDArray[np.float64]]:
    """The quantities of a run: of its battery, its heaters, and the cabin whose comfort counts.

    A power is the mean of the second before, and 0 before the first; a temperature is that of the moment.
    """
    layout = vehicle_layout.typed(trajectory.layout)
    machines = [heater["power"] for heater in layout["heaters"]]
    machines += ["compressor_power_w"] if layout["refrigerates"] else []
    found = {
        BATTERY_POWER.name: trajectory["battery_power_w"],
        HEATER_POWER.name: np.sum([trajectory[machine] for machine in machines], axis=0)
        + np.zeros(len(trajectory)),
    }
    cabins = sorted(layout["cabins"], key=lambda cabin: not cabin["comfort"])
    if cabins:
        found[CABIN_TEMPERATURE.name] = trajectory[cabins[0]["air"]]
    batteries = [member["temperature"] for member in layout["members"] if member["kind"] == "battery"]
    if batteries and batteries[0] is not None:
        found[BATTERY_TEMPERATURE.name] = trajectory[batteries[0]]
    return found
