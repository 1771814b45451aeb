"""Measurements of a calibration: traces and totals of drives, each with its uncertainty and its role."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from hp_gym import _core
from hp_gym.messages import OneLineError
from hp_gym.near_names import unknown
from hp_gym.overrides import assignments
from hp_gym.studies import csv_columns

ROLES: Final = ("fit", "check", "held-back")
"""What a measurement is for: the fit sees it; the fit is checked by it; it is looked at once, at the end."""

TIME: Final = "time_s"

_CHECKED: Final = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
_Name = Annotated[str, Field(min_length=1, max_length=300)]
_Number = Annotated[float, Field(ge=-1e12, le=1e12)]
_Positive = Annotated[float, Field(gt=0.0, le=1e12)]


class MeasurementError(OneLineError):
    """A measurement does not fit what it is said to be of; the message names it."""


class TraceTable(BaseModel):
    """A `[[measurement.trace]]`."""

    model_config = _CHECKED

    signal: _Name
    sigma: _Positive
    column: _Name | None = None
    """Column of the file; named as the signal by default."""
    independent_after_s: _Positive = 60.0
    """Time after which an error says something new: errors of sensors and of models are alike for a while."""


class TotalTable(BaseModel):
    """A `[[measurement.total]]`."""

    model_config = _CHECKED

    kpi: _Name
    value: _Number
    sigma: _Positive


class MeasurementTable(BaseModel):
    """A `[[measurement]]`."""

    model_config = _CHECKED

    name: _Name
    role: Literal["fit", "check", "held-back"]
    scenario: _Name
    overrides: dict[str, bool | float | str] = Field(default_factory=dict)
    """What was different from the scenario, by dotted key."""
    file: _Name | None = None
    trace: tuple[TraceTable, ...] = ()
    total: tuple[TotalTable, ...] = ()

    @model_validator(mode="after")
    def _has_something(self) -> Self:
        if not self.trace and not self.total:
            message = f"{self.name}: needs a [[measurement.trace]] or a [[measurement.total]]"
            raise ValueError(message)
        if bool(self.trace) != (self.file is not None):
            message = f"{self.name}: `file` is needed for traces, and for nothing else"
            raise ValueError(message)
        return self


@dataclass(frozen=True)
class Trace:
    """A signal over time.

    Attributes:
        signal: Name of the signal.
        sigma: Standard uncertainty of a value, in the signal's unit.
        times_s: When it was measured, rising.
        values: What was measured.
        weight: How much each value counts beside its uncertainty: less where values follow closely.
    """

    signal: str
    sigma: float
    times_s: NDArray[np.float64]
    values: NDArray[np.float64]
    weight: float


@dataclass(frozen=True)
class Measurement:
    """A drive that was measured.

    Attributes:
        name: Name.
        role: One of `ROLES`.
        scenario: Scenario that it was.
        overrides: What was different from that, `key=value`.
        traces: What was measured over time.
        totals: Name, value and standard uncertainty of what was measured as a whole.
    """

    name: str
    role: str
    scenario: str
    overrides: tuple[str, ...]
    traces: tuple[Trace, ...]
    totals: tuple[tuple[str, float, float], ...]

    @property
    def values(self) -> int:
        """Number of measured values."""
        return len(self.totals) + sum(len(trace.values) for trace in self.traces)


def load(
    tables: Sequence[MeasurementTable], folder: Path, vehicle: str, controller: str
) -> tuple[Measurement, ...]:
    """Reads the files of measurements and checks that they fit their scenarios.

    Args:
        tables: What the calibration file says of them.
        folder: From where relative paths count.
        vehicle: Vehicle that was measured.
        controller: Controller that drove.

    Raises:
        MeasurementError: A file lacks a column, has times that do not rise or do not fit the cycle, or a
            signal or a total does not exist.
        ConfigurationError: A scenario is not accepted.
        OSError: A file cannot be read.
    """
    return tuple(_measurement(table, folder, vehicle, controller) for table in tables)


def _measurement(table: MeasurementTable, folder: Path, vehicle: str, controller: str) -> Measurement:
    overrides = tuple(assignments(table.overrides))
    experiment = _core.Experiment(table.scenario, controller, overrides, 1, vehicle)
    columns: Mapping[str, NDArray[np.float64]] = {}
    if table.file is not None:
        columns = _columns(folder / table.file, table)
    traces = []
    for row in table.trace:
        if row.signal not in experiment.signal_names:
            message = unknown("signal", row.signal, experiment.signal_names)
            raise MeasurementError(f"measurement `{table.name}`: {message}")
        traces.append(_trace(table.name, row, columns, experiment.duration_s))
    if table.total:
        summary, _ = experiment.totals()
        for total in table.total:
            if total.kpi not in summary:
                raise MeasurementError(f"measurement `{table.name}`: {unknown('total', total.kpi, summary)}")
    totals = tuple((total.kpi, total.value, total.sigma) for total in table.total)
    return Measurement(table.name, table.role, table.scenario, overrides, tuple(traces), totals)


def _columns(path: Path, table: MeasurementTable) -> dict[str, NDArray[np.float64]]:
    """What a measurement needs of a file; NaN where nothing was measured."""
    try:
        columns = csv_columns.read(path)
        return {
            name: columns.numbers(name, gaps=True)
            for name in (TIME, *(row.column or row.signal for row in table.trace))
        }
    except csv_columns.ColumnError as error:
        raise MeasurementError(str(error)) from error


def _trace(name: str, row: TraceTable, columns: Mapping[str, NDArray[np.float64]], duration_s: int) -> Trace:
    column = row.column or row.signal
    there = np.isfinite(columns[column])
    times_s, values = columns[TIME][there], columns[column][there]
    where = f"measurement `{name}`, column `{column}`"
    if len(times_s) < 2:
        raise MeasurementError(f"{where}: has {len(times_s)} values, but must have at least 2")
    if not np.isfinite(times_s).all() or (np.diff(times_s) <= 0.0).any():
        raise MeasurementError(f"{where}: the times must be finite and rise")
    if times_s[0] < 0.0 or times_s[-1] > duration_s:
        raise MeasurementError(
            f"{where}: is from {times_s[0]:g} to {times_s[-1]:g} s, but the cycle is from 0 to {duration_s} s"
        )
    spacing_s = float(np.median(np.diff(times_s)))
    weight = math.sqrt(min(1.0, spacing_s / row.independent_after_s))
    return Trace(row.signal, row.sigma, times_s, values, weight)


class Driven:
    """Drives of measurements as functions of the free values; those of one call side by side.

    Args:
        measurements: What is compared.
        vehicle: Vehicle.
        controller: Controller.
    """

    def __init__(self, measurements: Sequence[Measurement], vehicle: str, controller: str) -> None:
        self.measurements = tuple(measurements)
        self._vehicle = vehicle
        self._controller = controller

    def deviations(self, changes: Sequence[str]) -> dict[str, dict[str, NDArray[np.float64]]]:
        """Model less measurement in units of its uncertainty, by measurement and by signal or total.

        Args:
            changes: `key=value` of the free values.
        """
        from concurrent.futures import ThreadPoolExecutor

        if len(self.measurements) == 1:
            return {self.measurements[0].name: self._deviation(self.measurements[0], changes)}
        with ThreadPoolExecutor() as pool:
            found = pool.map(lambda one: self._deviation(one, changes), self.measurements)
            return {one.name: each for one, each in zip(self.measurements, found, strict=True)}

    def _deviation(self, one: Measurement, changes: Sequence[str]) -> dict[str, NDArray[np.float64]]:
        overrides = [*one.overrides, *changes]
        experiment = _core.Experiment(one.scenario, self._controller, overrides, 1, self._vehicle)
        values, summary, _ = experiment.simulate()
        seconds = values[:, experiment.signal_names.index(TIME)]
        deviations: dict[str, NDArray[np.float64]] = {}
        for trace in one.traces:
            column = values[:, experiment.signal_names.index(trace.signal)]
            # Where a run ends early, its last value stands for the rest.
            model = np.interp(trace.times_s, seconds, column)
            deviations[trace.signal] = trace.weight * (model - trace.values) / trace.sigma
        for kpi, value, sigma in one.totals:
            deviations[kpi] = np.array([_finite(summary[kpi] - value) / sigma])
        return deviations


def _finite(value: Any) -> float:
    """A number that a fit can go on with where a total does not exist."""
    return float(value) if math.isfinite(value) else 1e3
