"""What a trip comes to: the same figures of measured values and of the model's."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym.studies.replay.measured_quantities import (
    BATTERY_POWER,
    BATTERY_TEMPERATURE,
    CABIN_TEMPERATURE,
    HEATER_POWER,
    Channels,
)

LAST_S: Final = 300
"""Seconds at the end over which the heater's power is told."""

WARM_DEGC: Final = 18.0
"""A cabin above this is warm."""

_J_PER_KWH: Final = 3.6e6


@dataclass(frozen=True)
class Pair:
    """A figure of both.

    Attributes:
        measured: None where it was not measured.
        model: None where the vehicle has no such thing.
    """

    measured: float | None
    model: float | None

    @property
    def deviation(self) -> float | None:
        """Model less measured."""
        if self.measured is None or self.model is None:
            return None
        return self.model - self.measured


def figures(measured: Channels, model: Channels) -> dict[str, Pair]:
    """Figures of the same seconds, by name.

    Args:
        measured: What was measured at full seconds from 0 on.
        model: What the model has at the same seconds.
    """
    return {name: Pair(figure(measured), figure(model)) for name, figure in _FIGURES.items()}


def integral_kwh(power_w: NDArray[np.float64]) -> float:
    """Energy of a power at full seconds, by the trapezoid rule."""
    return float((power_w[1:] + power_w[:-1]).sum()) / 2.0 / _J_PER_KWH


def cumulated_kwh(power_w: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same up to each second."""
    return np.concatenate(([0.0], np.cumsum(0.5 * (power_w[1:] + power_w[:-1])))) / _J_PER_KWH


def _energy_kwh(channels: Channels) -> float | None:
    power_w = channels.get(BATTERY_POWER.name)
    return None if power_w is None else integral_kwh(power_w)


def _heating_energy_kwh(channels: Channels) -> float | None:
    power_w = channels.get(HEATER_POWER.name)
    return None if power_w is None else integral_kwh(power_w)


def _drive_energy_kwh(channels: Channels) -> float | None:
    energy_kwh, heating_kwh = _energy_kwh(channels), _heating_energy_kwh(channels)
    return None if energy_kwh is None or heating_kwh is None else energy_kwh - heating_kwh


def _heater_last_w(channels: Channels) -> float | None:
    """Mean of the last seconds, of the whole trip where that is shorter; at the start nothing was driven."""
    power_w = channels.get(HEATER_POWER.name)
    return None if power_w is None else float(power_w[1:][-LAST_S:].mean())


def _battery_rise_k(channels: Channels) -> float | None:
    degc = channels.get(BATTERY_TEMPERATURE.name)
    return None if degc is None else float(degc[-1] - degc[0])


def _cabin_warm_s(channels: Channels) -> float | None:
    """Seconds at whose end the cabin is warm."""
    degc = channels.get(CABIN_TEMPERATURE.name)
    return None if degc is None else float(np.count_nonzero(degc[1:] > WARM_DEGC))


_FIGURES: Final[dict[str, Callable[[Channels], float | None]]] = {
    "energy_kwh": _energy_kwh,
    "drive_energy_kwh": _drive_energy_kwh,
    "heating_energy_kwh": _heating_energy_kwh,
    "heater_last_300_s_w": _heater_last_w,
    "battery_rise_k": _battery_rise_k,
    "cabin_above_18_degc_s": _cabin_warm_s,
}
