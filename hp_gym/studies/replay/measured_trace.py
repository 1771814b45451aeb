"""What was measured on a trip: the columns of its trace that begin with `measured_`."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym.messages import OneLineError
from hp_gym.studies.csv_columns import Columns
from hp_gym.studies.replay.full_seconds import at_full_seconds
from hp_gym.studies.replay.measured_quantities import BATTERY_POWER, QUANTITIES

TIME: Final = "time_s"

LEAST_PEAK_W: Final = 300.0
"""A battery whose power never reaches this on a trip was not measured in W; in kW no car's exceeds it."""


class TraceError(OneLineError):
    """A trace that cannot be replayed; the message names file and column, and what was allowed."""


@dataclass(frozen=True, eq=False)
class MeasuredTrace:
    """What was measured on a trip.

    Attributes:
        path: The file.
        columns: Names of all its columns.
        first: First value of each quantity that was measured, by its name.
        channels: Values at the full seconds from the start, by the name of the quantity.
    """

    path: Path
    columns: tuple[str, ...]
    first: dict[str, float]
    channels: dict[str, NDArray[np.float64]] = field(repr=False)


def of(columns: Columns) -> MeasuredTrace:
    """Takes what was measured from a trace that the plant accepts as a cycle: its times rise, without gaps.

    Raises:
        TraceError: A battery's power is not in W.
    """
    times_s = columns.numbers(TIME)
    found = {
        quantity.name: columns.numbers(quantity.column)
        for quantity in QUANTITIES
        if quantity.column in columns.names
    }
    _require_watts(columns, found)
    return MeasuredTrace(
        columns.path,
        columns.names,
        {name: float(values[0]) for name, values in found.items()},
        {name: at_full_seconds(times_s - times_s[0], values) for name, values in found.items()},
    )


def _require_watts(columns: Columns, found: Mapping[str, NDArray[np.float64]]) -> None:
    power_w = found.get(BATTERY_POWER.name)
    peak_w = 0.0 if power_w is None else float(np.abs(power_w).max())
    if 0.0 < peak_w < LEAST_PEAK_W:
        raise TraceError(
            f"{columns.path}: column `{BATTERY_POWER.column}` is nowhere beyond {peak_w:g} W, but must reach "
            f"{LEAST_PEAK_W:g} W somewhere: is it in kW?"
        )
