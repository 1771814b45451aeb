"""The picture of a run: panels over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from hp_gym import extras, vehicle_layout
from hp_gym.pictures import panels, picture_file
from hp_gym.pictures.panels import GREEN, GREY, Connections

with extras.needed("plot"):
    from matplotlib import pyplot as plt
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.ticker import MultipleLocator

if TYPE_CHECKING:
    import os

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from hp_gym.pictures.panels import Curve, Panel
    from hp_gym.trajectory import Trajectory

SIZE_INCH: Final = (14.0, 13.0)
FULL_ROWS: Final = 5
"""Rows of panels that fill that size."""


def plot(trajectory: Trajectory, path: str | os.PathLike[str] | None = None) -> Figure:
    """Draws a run.

    Args:
        trajectory: The run.
        path: Picture to write (.png, .svg or .pdf). Without it the figure belongs to pyplot, and
            `matplotlib.pyplot.show()` opens it.

    Raises:
        ValueError: The path ends otherwise.
        OSError: The file cannot be written; one that stood there stays as it was.
    """
    # A figure of pyplot stays open until it is closed, so one for a file is none.
    new = plt.figure if path is None else Figure

    def draw() -> Figure:
        layout = ConstrainedLayoutEngine(w_pad=0.1, h_pad=0.08, hspace=0.02, wspace=0.02)
        return _draw(new(figsize=SIZE_INCH, layout=layout), trajectory)

    return picture_file.drawn(draw, path)


def _draw(figure: Figure, trajectory: Trajectory) -> Figure:
    shown = panels.of(vehicle_layout.typed(trajectory.layout))
    rows = -(-len(shown) // 2)
    figure.set_size_inches(SIZE_INCH[0], SIZE_INCH[1] * rows / FULL_ROWS)
    grid = figure.subplots(rows, 2, sharex=True, squeeze=False)
    time_min = trajectory["time_s"] / 60.0
    places = grid.ravel()
    for axes, panel in zip(places, shown, strict=False):
        if isinstance(panel, Connections):
            _draw_connections(axes, trajectory, time_min, panel)
        else:
            _draw_panel(axes, trajectory, time_min, panel)
    for axes in places[len(shown) :]:
        axes.remove()
    for axes in places[len(shown) - 2 : len(shown)]:
        axes.set_xlabel("time [min]")
        axes.tick_params(labelbottom=True)
        axes.xaxis.set_major_locator(MultipleLocator(5.0))
    # The names beside the connections would push the labels of the others away.
    curves = sum(not isinstance(panel, Connections) for panel in shown)
    for column in range(2):
        figure.align_ylabels(places[column:curves:2].tolist())
    figure.suptitle(_headline(trajectory), x=0.01, ha="left", fontsize=13, fontweight="bold")
    return figure


def _headline(trajectory: Trajectory) -> str:
    summary = trajectory.summary
    return (
        f"{trajectory.scenario}   |   {trajectory['ambient_temperature_degc'][0]:.0f} °C ambient   |   "
        f"{summary['energy_kwh']:.2f} kWh over {summary['distance_km']:.1f} km   |   "
        f"final SOC {summary['final_soc_pct']:.1f} %"
    )


def _draw_panel(axes: Axes, trajectory: Trajectory, time_min: NDArray[np.float64], panel: Panel) -> None:
    for curve in panel.curves:
        values = _values(trajectory, panel, curve)
        if not (panel.hide_idle and not values.any()):
            axes.plot(
                time_min, values, curve.style, color=curve.colour, linewidth=curve.width, label=curve.label
            )
    for name in panel.limits:
        if name in trajectory.limits:
            _draw_limit(axes, trajectory.limits[name])
    if panel.area:
        axes.fill_between(time_min, _values(trajectory, panel, panel.curves[0]), color=panels.LIGHT)
        axes.set_ylim(bottom=0.0)
    if panel.comfort_band:
        low, high = trajectory.limits["cabin_lowest_degc"], trajectory.limits["cabin_highest_degc"]
        axes.axhspan(low, high, color=GREEN, alpha=0.18, linewidth=0.0, label="comfort band")
    axes.set_title(panel.title)
    axes.set_ylabel(f"[{panel.unit}]")
    curves = len(axes.get_legend_handles_labels()[0])
    if curves > 1:
        # Beside the title; in several rows where one would run into it.
        columns = curves if curves <= 4 else 3
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=columns)


def _draw_limit(axes: Axes, limit: float) -> None:
    axes.axhline(limit, color=GREY, linestyle=":", linewidth=1.2)
    axes.annotate(
        "limit",
        (1.0, limit),
        xycoords=("axes fraction", "data"),
        xytext=(3, 0),
        textcoords="offset points",
        verticalalignment="center",
        color=GREY,
        fontsize=8,
    )


def _values(trajectory: Trajectory, panel: Panel, curve: Curve) -> NDArray[np.float64]:
    values = panel.scale * trajectory[curve.column]
    if panel.only_while_running:
        return np.where(trajectory["compressor_power_w"] > 0.0, values, np.nan)
    return values


def _draw_connections(
    axes: Axes, trajectory: Trajectory, time_min: NDArray[np.float64], panel: Connections
) -> None:
    for row, (column, _) in enumerate(panel.members):
        # A row of the record tells of the second before it.
        connection = trajectory[column][1:]
        for value, _, colour in panel.loops:
            edges = np.flatnonzero(np.diff(np.concatenate(([0], connection == value, [0]))))
            starts, ends = time_min[edges[::2]], time_min[edges[1::2]]
            axes.broken_barh(list(zip(starts, ends - starts, strict=True)), (row - 0.35, 0.7), color=colour)
    axes.set_yticks(range(len(panel.members)), [label for _, label in panel.members])
    axes.set_ylim(len(panel.members) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    axes.set_title("Connections")
    for _, label, colour in panel.loops:
        axes.barh(0, 0, color=colour, label=label)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=len(panel.loops))
