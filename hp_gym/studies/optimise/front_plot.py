"""Pictures of searches: the front of two goals, or how one goal was approached."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hp_gym import extras
from hp_gym.key_units import titled
from hp_gym.pictures.picture_file import drawn

with extras.needed("studies"):
    from matplotlib.figure import Figure

if TYPE_CHECKING:
    import os

    from matplotlib.axes import Axes

    from hp_gym.studies.optimise.found import Found


def plot(found: Found, path: str | os.PathLike[str] | None) -> Figure:
    """Draws the trials: the first goal over the second with the front, or over their number.

    Args:
        found: The search.
        path: Picture to write (.png, .svg or .pdf); None for the figure alone.

    Raises:
        ValueError: The path ends otherwise.
        OSError: The file cannot be written; one that stood there stays as it was.
    """
    return drawn(lambda: _figure(found), path)


def _figure(found: Found) -> Figure:
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    panel = figure.subplots()
    if len(found.goals) > 1:
        _front(panel, found)
    else:
        _approach(panel, found)
    return figure


def _front(panel: Axes, found: Found) -> None:
    allowed, front = found.allowed, found.front
    # Whatever it is, all that is allowed is shown; what is not would spread the axes.
    panel.plot(
        [trial.values[1] for trial in allowed],
        [trial.values[0] for trial in allowed],
        ".",
        color="#b8b8b8",
        label=f"{len(allowed)} trials that keep the constraints",
    )
    ordered = sorted(front, key=lambda trial: trial.values[1])
    across, up = ([trial.values[place] for trial in ordered] for place in (1, 0))
    panel.plot(across, up, "o-", markersize=4.0, label=f"front, {len(front)} trials")
    panel.set_xlabel(titled(found.goals[1]))
    panel.set_ylabel(titled(found.goals[0]))
    panel.margins(x=0.04, y=0.04)
    panel.legend()


def _approach(panel: Axes, found: Found) -> None:
    allowed = found.allowed
    if not allowed:
        return
    numbers = [trial.number for trial in allowed]
    values = np.array([trial.values[0] for trial in allowed])
    larger = found.definition["goals"][0]["larger"]
    best = np.maximum.accumulate(values) if larger else np.minimum.accumulate(values)
    panel.plot(numbers, values, ".", color="#b8b8b8", label="trials that keep the constraints")
    panel.step(numbers, best, where="post", label="best so far")
    panel.set_xlabel("trial")
    panel.set_ylabel(titled(found.goals[0]))
    panel.margins(x=0.02)
    panel.legend()
