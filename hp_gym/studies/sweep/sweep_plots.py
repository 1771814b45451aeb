"""Pictures of sweeps: lines over one axis, heat maps over two, one a value of a third, points of samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from hp_gym import extras
from hp_gym.key_units import titled, unit_of
from hp_gym.pictures.picture_file import drawn
from hp_gym.studies.sweep.sweep_plan import SweepError

with extras.needed("sweep"):
    from matplotlib.figure import Figure

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    import xarray as xr
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from hp_gym.studies.sweep.swept import Sweep

KINDS: Final = ("auto", "lines", "heat")
"""Kinds of pictures of a grid."""

MOST_PANELS: Final = 6
"""Values of a third axis that are shown, evenly chosen."""

_MOST_LINES: Final = 8
_PANEL_INCH: Final = (3.2, 2.7)


def plot(
    swept: Sweep, path: str | os.PathLike[str] | None, kpis: Sequence[str], kind: str = "auto"
) -> Figure:
    """Draws totals over the axes, a row of panels each.

    Args:
        swept: The sweep.
        path: Picture to write (.png, .svg or .pdf); None for the figure alone.
        kpis: Totals.
        kind: `lines`, `heat`, or `auto`: lines over one axis, heat maps over more. Samples are points.

    Raises:
        SweepError: A total does not exist, or there is no such kind.
        ValueError: The path ends otherwise.
        OSError: The file cannot be written; one that stood there stays as it was.
    """
    if kind not in KINDS:
        raise SweepError(f"kind is `{kind}`, but must be one of {', '.join(KINDS)}")
    names = swept.require_kpis(kpis)
    sampled = swept.definition["sample"]
    return drawn(lambda: _points(swept, names) if sampled else _grid(swept, names, kind), path)


def _panels(rows: int, columns: int) -> tuple[Figure, Any]:
    size = (_PANEL_INCH[0] * columns + 0.8, _PANEL_INCH[1] * rows + 0.4)
    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def _points(swept: Sweep, kpis: Sequence[str]) -> Figure:
    frame = swept.to_pandas(kpis)
    figure, panels = _panels(len(kpis), len(swept.axes))
    for row, kpi in enumerate(kpis):
        for column, axis in enumerate(swept.axes):
            panel: Axes = panels[row, column]
            panel.plot(frame[axis], frame[kpi], ".", markersize=2.0, alpha=0.5)
            panel.margins(x=0.02)
            panel.set_xlabel(titled(axis))
            panel.set_ylabel(titled(kpi) if column == 0 else "")
    return figure


def _grid(swept: Sweep, kpis: Sequence[str], kind: str) -> Figure:
    data = swept.to_xarray(kpis)
    axes = sorted(swept.axes, key=lambda name: -data.sizes[name])
    lines = kind == "lines" or (kind == "auto" and len(axes) == 1)
    shown = axes[:2]
    facets = _facets(data, axes[2]) if len(axes) > 2 else [None]
    figure, panels = _panels(len(kpis), len(facets))
    averaged = axes[3:]
    for row, kpi in enumerate(kpis):
        values = data[kpi].mean(averaged) if averaged else data[kpi]
        # In the order of the axes, the lesser first.
        values = values.transpose(*reversed(axes[: min(len(axes), 3)]))
        limits = float(values.min()), float(values.max())
        for column, facet in enumerate(facets):
            panel: Axes = panels[row, column]
            part = values if facet is None else values.isel({axes[2]: facet})
            if lines or len(shown) == 1:
                _lines(panel, part, shown)
            else:
                mesh = _heat(panel, part, shown, limits)
                if column == len(facets) - 1:
                    figure.colorbar(mesh, ax=panels[row, :].tolist(), label=titled(kpi))
            panel.set_title(_title(data, axes, facet, kpi))
    if averaged:
        figure.suptitle(f"means over {', '.join(averaged)}")
    return figure


def _facets(data: xr.Dataset, axis: str) -> list[int]:
    count = data.sizes[axis]
    return [int(place) for place in np.unique(np.linspace(0, count - 1, min(count, MOST_PANELS)).round())]


def _title(data: xr.Dataset, axes: Sequence[str], facet: int | None, kpi: str) -> str:
    if facet is None:
        return titled(kpi)
    value = data[axes[2]].to_numpy()[facet]
    unit = unit_of(axes[2])
    shown = f"{value:g}" if data[axes[2]].dtype.kind == "f" else str(value)
    return f"{titled(axes[2]).partition(' [')[0]} {shown}" + ("" if unit == "-" else f" {unit}")


def _places(part: xr.DataArray, axis: str) -> tuple[NDArray[np.float64], list[str] | None]:
    """Where values stand along an axis, and their labels where they are no numbers."""
    values = part[axis].to_numpy()
    if values.dtype.kind == "f":
        return values, None
    return np.arange(len(values), dtype=np.float64), [str(value) for value in values]


def _lines(panel: Axes, part: xr.DataArray, shown: Sequence[str]) -> None:
    places, labels = _places(part, shown[0])
    if len(shown) == 1:
        panel.plot(places, part.to_numpy(), marker="o", markersize=3.0)
    else:
        count = part.sizes[shown[1]]
        for place in np.unique(np.linspace(0, count - 1, min(count, _MOST_LINES)).round().astype(int)):
            value = part[shown[1]].to_numpy()[place]
            label = f"{value:g}" if part[shown[1]].dtype.kind == "f" else str(value)
            line = part.isel({shown[1]: int(place)}).to_numpy()
            panel.plot(places, line, marker="o", markersize=3.0, label=label)
        panel.legend(title=titled(shown[1]), ncols=2)
    panel.set_xlabel(titled(shown[0]))
    if labels is not None:
        panel.set_xticks(places, labels, rotation=30, ha="right")


def _heat(panel: Axes, part: xr.DataArray, shown: Sequence[str], limits: tuple[float, float]) -> Any:
    across, across_labels = _places(part, shown[0])
    up, up_labels = _places(part, shown[1])
    # Values need not rise along an axis.
    columns, rows = np.argsort(across), np.argsort(up)
    values = part.to_numpy()[np.ix_(rows, columns)]
    mesh = panel.pcolormesh(
        across[columns], up[rows], values, shading="nearest", vmin=limits[0], vmax=limits[1]
    )
    panel.grid(visible=False)
    panel.set_xlabel(titled(shown[0]))
    panel.set_ylabel(titled(shown[1]))
    if across_labels is not None:
        panel.set_xticks(across, across_labels, rotation=30, ha="right")
    if up_labels is not None:
        panel.set_yticks(up, up_labels)
    return mesh
