"""What was measured on a trip: the columns of its trace that begin with `measured_`."""

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym.files import require_suffix
from hp_gym.messages import OneLineError
from hp_gym.near_names import unknown
from hp_gym.studies import csv_columns
from hp_gym.studies.csv_columns import Columns
from hp_gym.studies.replay.full_seconds import at_full_seconds
from hp_gym.studies.replay.measured_quantities import BATTERY_POWER, QUANTITIES, Quantity

TIME: Final = "time_s"
AMBIENT: Final = "ambient_degc"
MEASURED: Final = "measured_"
SUFFIXES: Final = (".csv",)

LEAST_PEAK_W: Final = 300.0
"""A battery whose power never reaches this on a trip was not measured in W; in kW no car's exceeds it."""


class TraceError(OneLineError):
    """A trace that cannot be replayed; the message names file, line and column, and what was allowed."""


@dataclass(frozen=True, eq=False)
class MeasuredTrace:
    """What was measured on a trip.

    Attributes:
        path: The file.
        columns: Names of all its columns.
        first: First value of each quantity that was measured, by its name.
        channels: Values at the full seconds from the start, by the name of the quantity.
        duration_s: Last full second.
        first_ambient_degc: Ambient temperature in the first row; None where the trace does not say.
    """

    path: Path
    columns: tuple[str, ...]
    first: dict[str, float]
    channels: dict[str, NDArray[np.float64]] = field(repr=False)
    duration_s: int
    first_ambient_degc: float | None


def read(path: str | os.PathLike[str]) -> MeasuredTrace:
    """Reads the measured columns of a trace; the plant reads and checks the others.

    Raises:
        TraceError: There is no column of times, a time does not rise, a value is missing, is no number or is
            none in the unit of its column, or a measured column is not known.
        ValueError: The name does not end with `.csv`.
        OSError: The file cannot be read.
    """
    require_suffix(path, SUFFIXES)
    try:
        columns = csv_columns.read(Path(path))
        return _read(columns)
    except csv_columns.ColumnError as error:
        raise TraceError(str(error)) from error


def _read(columns: Columns) -> MeasuredTrace:
    known = [quantity.column for quantity in QUANTITIES]
    for name in columns.names:
        if name.startswith(MEASURED) and name not in known:
            raise TraceError(f"{columns.path}: {unknown('measured column', name, known)}")
    times_s = _times(columns)
    found = {
        quantity.name: _values(columns, quantity)
        for quantity in QUANTITIES
        if quantity.column in columns.names
    }
    return MeasuredTrace(
        columns.path,
        columns.names,
        {name: float(values[0]) for name, values in found.items()},
        {name: at_full_seconds(times_s, values) for name, values in found.items()},
        int(times_s[-1]),
        float(columns.numbers(AMBIENT)[0]) if AMBIENT in columns.names else None,
    )


def _times(columns: Columns) -> NDArray[np.float64]:
    """Times from the first row on, which need not be at 0."""
    times_s = columns.numbers(TIME)
    if len(times_s) < 2:
        raise TraceError(f"{columns.path}: has {len(times_s)} rows, but must have at least 2")
    for place in np.flatnonzero(np.diff(times_s) <= 0.0)[:1] + 1:
        raise TraceError(
            f"{columns.path}: line {columns.lines[place]}, column `{TIME}` is {times_s[place]:g}, "
            f"but must be more than {times_s[place - 1]:g} in the row before"
        )
    return np.asarray(times_s - times_s[0])


def _values(columns: Columns, quantity: Quantity) -> NDArray[np.float64]:
    values = columns.numbers(quantity.column)
    for place in np.flatnonzero((values < quantity.lowest) | (values > quantity.highest))[:1]:
        raise TraceError(
            f"{columns.path}: line {columns.lines[place]}, column `{quantity.column}` is {values[place]:g}, "
            f"but must be between {quantity.lowest:g} and {quantity.highest:g} {quantity.unit}"
        )
    peak = float(np.abs(values).max())
    if quantity is BATTERY_POWER and 0.0 < peak < LEAST_PEAK_W:
        raise TraceError(
            f"{columns.path}: column `{quantity.column}` is nowhere beyond {peak:g} W, but must reach "
            f"{LEAST_PEAK_W:g} W somewhere: is it in kW?"
        )
    return values
