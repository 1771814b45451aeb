"""Heat map of modes over ambient temperatures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from hp_gym import extras
from hp_gym.pictures.picture_file import drawn

with extras.needed("plot"):
    import matplotlib as mpl
    from matplotlib.figure import Figure

if TYPE_CHECKING:
    import os

    from hp_gym.studies.heat_modes.comparing import Compared

MOST_ROWS: Final = 32
"""Modes that are drawn, the best overall."""

_HIGHEST_PCT: Final = 40.0


def plot(compared: Compared, path: str | os.PathLike[str] | None) -> Figure:
    """Draws energy beyond the best comfortable mode; grey where a mode is not comfortable.

    Args:
        compared: The modes.
        path: Picture to write (.png, .svg or .pdf); None for the figure alone.

    Raises:
        ValueError: The path ends otherwise.
        OSError: The file cannot be written; one that stood there stays as it was.
    """
    return drawn(lambda: _figure(compared), path, grid=False)


def _figure(compared: Compared) -> Figure:
    shown = _shown(compared)
    excess_pct = np.ma.masked_invalid(compared.excess_pct[shown])
    figure = Figure(figsize=(11.0, 1.6 + 0.23 * len(shown)), layout="constrained")
    axes = figure.add_subplot()
    colours = mpl.colormaps["viridis_r"].with_extremes(bad="#e4e4e4")
    image = axes.imshow(excess_pct, aspect="auto", cmap=colours, vmin=0.0, vmax=_HIGHEST_PCT)
    axes.set_xticks(range(len(compared.ambients_degc)), [f"{value:.0f}" for value in compared.ambients_degc])
    axes.set_yticks(range(len(shown)), [compared.modes[mode].name for mode in shown], fontsize=7.5)
    axes.set_xlabel("ambient temperature, °C")
    axes.set_title(f"{compared.vehicle}, {compared.cycle}: energy beyond the best mode at comfort")
    for column in range(len(compared.ambients_degc)):
        best = compared.ranking(column)[0]
        if best in shown:
            axes.plot(column, shown.index(best), marker="*", color="#c1432e", markersize=7, linestyle="none")
    bar = figure.colorbar(image, ax=axes, extend="max", fraction=0.03, pad=0.01)
    bar.set_label("% (star: best, grey: not comfortable)")
    return figure


def _shown(compared: Compared) -> list[int]:
    """The best overall and the best at each ambient temperature, best overall first."""
    overall = compared.overall()
    champions = {compared.ranking(place)[0] for place in range(len(compared.ambients_degc))}
    rest = [mode for mode in overall if mode not in champions][: max(0, MOST_ROWS - len(champions))]
    wanted = champions | set(rest)
    return [mode for mode in overall if mode in wanted]
