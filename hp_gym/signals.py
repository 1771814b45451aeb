"""The signals of a vehicle by name: what a trajectory holds and what a controller can look at."""

from typing import Final

from hp_gym import _core

ROWS: Final = tuple(_core.signals())
"""Name, unit and description of each signal of the default architecture."""

NAMES: Final[tuple[str, ...]] = tuple(name for name, _, _ in ROWS)
"""Names of all signals of the default architecture in column order. A name ends with its unit."""

UNITS: Final[dict[str, str]] = {name: unit for name, unit, _ in ROWS}
"""Unit of each signal; `-` where it has none."""

DESCRIPTIONS: Final[dict[str, str]] = {name: description for name, _, description in ROWS}
"""Meaning of each signal."""

COLUMNS: Final[dict[str, int]] = {name: column for column, name in enumerate(NAMES)}
"""Column of each signal."""


def observe(run: _core.Run) -> dict[str, float]:
    """Returns the present value of every signal of a run by name."""
    return dict(zip(run.experiment.signal_names, run.look().tolist(), strict=True))
