"""Picture of a replay: what was measured and the model over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from hp_gym import extras
from hp_gym.pictures.panels import BLUE, GREY, RED
from hp_gym.pictures.picture_file import drawn
from hp_gym.studies.replay.measured_quantities import BATTERY_POWER, HEATER_POWER, QUANTITIES, Quantity
from hp_gym.studies.replay.trip_figures import cumulated_kwh

with extras.needed("plot"):
    from matplotlib.figure import Figure

if TYPE_CHECKING:
    import os

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from hp_gym.studies.replay.replaying import Replay

_MEAN_S: Final = 30
"""Powers are drawn as means over this time: second by second they hide each other."""


def plot(replay: Replay, path: str | os.PathLike[str] | None) -> Figure:
    """Draws speed, what was measured beside the model, and the energies of both.

    Args:
        replay: The replay.
        path: Picture to write (.png, .svg or .pdf); None for the figure alone.

    Raises:
        ValueError: The path ends otherwise.
        OSError: The file cannot be written; one that stood there stays as it was.
    """
    return drawn(lambda: _figure(replay), path)


def _figure(replay: Replay) -> Figure:
    shown = [quantity for quantity in QUANTITIES if quantity.name in replay.model]
    figure = Figure(figsize=(11.0, 1.0 + 1.7 * (2 + len(shown))), layout="constrained")
    axes = figure.subplots(2 + len(shown), 1, sharex=True)
    _speed(axes[0], replay)
    for place, quantity in zip(axes[1:], shown, strict=False):
        _quantity(place, replay, quantity)
    _energy(axes[-1], replay)
    axes[-1].set_xlabel("time [min]")
    figure.align_ylabels(axes.tolist())
    figure.suptitle(replay.title, x=0.01, ha="left", fontsize=12, fontweight="bold")
    return figure


def _speed(axes: Axes, replay: Replay) -> None:
    run = replay.trajectory
    axes.plot(run["time_s"] / 60.0, 3.6 * run["speed_m_s"], color=GREY)
    axes.set_title("Speed")
    axes.set_ylabel("[km/h]")


def _quantity(axes: Axes, replay: Replay, quantity: Quantity) -> None:
    power = quantity in (BATTERY_POWER, HEATER_POWER)
    for channels, label, colour, style in (
        (replay.measured, "measured", RED, "-"),
        (replay.model, "model", BLUE, "--"),
    ):
        if quantity.name in channels:
            values = channels[quantity.name]
            shown = 1e-3 * _mean(values) if power else values
            axes.plot(np.arange(len(values)) / 60.0, shown, style, color=colour, label=label)
    axes.set_title(f"{quantity.label}, mean of {_MEAN_S} s" if power else quantity.label)
    axes.set_ylabel("[kW]" if power else f"[{quantity.unit}]")
    _legend(axes)


def _energy(axes: Axes, replay: Replay) -> None:
    for channels, label, style in ((replay.measured, "measured", "-"), (replay.model, "model", "--")):
        for quantity, colour, what in ((BATTERY_POWER, RED, "battery"), (HEATER_POWER, BLUE, "heaters")):
            if quantity.name in channels:
                energy_kwh = cumulated_kwh(channels[quantity.name])
                minutes = np.arange(len(energy_kwh)) / 60.0
                axes.plot(minutes, energy_kwh, style, color=colour, label=f"{what}, {label}")
    axes.set_title("Energy")
    axes.set_ylabel("[kWh]")
    _legend(axes)


def _legend(axes: Axes) -> None:
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=4)


def _mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Running mean, of fewer values at the ends."""
    kernel = np.ones(min(_MEAN_S, len(values)))
    counts = np.convolve(np.ones(len(values)), kernel, mode="same")
    return np.asarray(np.convolve(values, kernel, mode="same") / counts)
