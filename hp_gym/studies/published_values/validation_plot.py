"""Picture of judged rows: published ranges, tolerances and the model's values on one scale."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from hp_gym import extras
from hp_gym.pictures.picture_file import drawn
from hp_gym.studies.published_values.validation_report import GROUPS, number

with extras.needed("plot"):
    from matplotlib.figure import Figure

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from hp_gym.studies.published_values.judging import Judged

_GREEN: Final = "#3a7d44"
_RED: Final = "#c1432e"
_FURTHEST: Final = 3.0


def plot(judged: Sequence[Judged], path: str | os.PathLike[str] | None) -> Figure:
    """Draws the model's value of each row, scaled so that what passes lies between -1 and 1.

    Of a bound alone a fifth of it is the scale.

    Args:
        judged: The rows.
        path: Picture to write (.png, .svg or .pdf); None for the figure alone.

    Raises:
        ValueError: The path ends otherwise.
        OSError: The file cannot be written; one that stood there stays as it was.
    """
    return drawn(lambda: _figure(judged), path)


def _figure(judged: Sequence[Judged]) -> Figure:
    groups = [[row for row in judged if row.row.group == group] for group in GROUPS]
    figure = Figure(figsize=(13.0, 1.3 + 0.2 * max(map(len, groups))), layout="constrained")
    for axes, title, rows in zip(figure.subplots(1, len(groups)), GROUPS.values(), groups, strict=True):
        _panel(axes, title, rows)
    figure.suptitle("published | model; green band: what passes", x=0.01, ha="left", fontsize=9)
    return figure


def _panel(axes: Axes, title: str, rows: Sequence[Judged]) -> None:
    axes.axvspan(-1.0, 1.0, color="#e6efe7", zorder=0)
    for place, row in enumerate(rows):
        position = min(max(scaled(row), -_FURTHEST), _FURTHEST) if row.model is not None else _FURTHEST
        marker = "o" if abs(position) < _FURTHEST else ">" if position > 0.0 else "<"
        axes.plot(position, place, marker, color=_GREEN if row.passes else _RED, markersize=4.5)
    names = [f"{row.id}  {row.published} | {number(row.model)} {row.row.unit}" for row in rows]
    axes.set_yticks(range(len(rows)), names, fontsize=7)
    axes.set_ylim(len(rows) - 0.3, -0.7)
    axes.set_xlim(-_FURTHEST - 0.2, _FURTHEST + 0.2)
    axes.set_xticks([-1.0, 1.0], ["least", "greatest"], fontsize=7.5)
    axes.set_title(title)


def scaled(row: Judged) -> float:
    """The model's value where what passes lies between -1 and 1."""
    low, high = row.row.bounds()
    value = row.model if row.model is not None else float("nan")
    if low is not None and high is not None:
        half = 0.5 * (high - low) or 1e-9
        return (value - 0.5 * (low + high)) / half
    bound = low if low is not None else high
    scale = 0.2 * abs(bound or 0.0) or 1.0
    # A bound alone: just met is the edge, well met the middle.
    away = (value - (bound or 0.0)) / scale * (1.0 if low is not None else -1.0)
    edge = -1.0 if low is not None else 1.0
    return edge + min(away, 1.0) * (1.0 if low is not None else -1.0)
