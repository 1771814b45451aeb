"""The record of a run."""

from __future__ import annotations

import csv
import math
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from hp_gym import extras, later, notebooks, signals, vehicle_layout
from hp_gym.files import atomic_write, require_suffix
from hp_gym.key_units import unit_of
from hp_gym.near_names import unknown

# pandas takes a second to import: it is loaded by the methods that need it.
if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy as np
    import pandas as pd
    import xarray as xr
    from numpy.typing import NDArray

TABLE_SUFFIXES: Final = (".csv", ".parquet")

_SHOWN: Final = (
    "energy_kwh",
    "energy_kwh_per_100_km",
    "final_soc_pct",
    "duration_s",
    "distance_km",
    "discomfort_k",
    "time_to_comfort_s",
    "heat_pump_cop",
    "limit_breaches",
)
"""Totals that a notebook shows; `summary` has all."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Everything that could be seen of a run, one row a second, the start included.

    Attributes:
        scenario: Name or path of the scenario.
        controller: Name of the controller.
        end_reason: `arrived`, `battery_empty`, `immobile` or `late`.
        summary: Totals by name; a name ends with its unit. NaN, in JSON null, where one does not exist,
            as energy per distance of a trip of 0 km.
        limits: Limits that the run is judged by.
        values: One row a second, one column a signal; not to be written to.
        signals: Name, unit and description of each column; those of the default architecture by default.
        layout: What the vehicle is made of, as `Experiment.layout()` tells it; empty where it was not told.
    """

    scenario: str
    controller: str
    end_reason: str
    summary: Mapping[str, float]
    limits: Mapping[str, float]
    values: NDArray[np.float64] = field(repr=False)
    signals: tuple[tuple[str, str, str], ...] = field(default=signals.ROWS, repr=False)
    layout: Mapping[str, Any] = field(default_factory=dict, repr=False)
    _places: Mapping[str, int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Keeps the record as it was made."""
        self.values.flags.writeable = False
        object.__setattr__(self, "_places", {name: place for place, name in enumerate(self.columns)})

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.values)

    def __getitem__(self, column: str) -> NDArray[np.float64]:
        """Returns the values of a column.

        Raises:
            KeyError: There is no such column; the message says what is near.
        """
        place = self._places.get(column)
        if place is None:
            raise KeyError(unknown("column", column, self.columns))
        return self.values[:, place]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(name for name, _, _ in self.signals)

    @property
    def units(self) -> dict[str, str]:
        """Unit of each column."""
        return {name: unit for name, unit, _ in self.signals}

    def to_pandas(self) -> pd.DataFrame:
        """Returns a table, one row a second, one column a signal, which knows its vehicle.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        with extras.needed("benchmark"):
            import pandas as pd

        return vehicle_layout.keep(pd.DataFrame(self.values.copy(), columns=list(self.columns)), self.layout)

    def to_xarray(self) -> xr.Dataset:
        """Returns a data set over time, a variable a signal with its unit and meaning in `attrs`.

        Raises:
            MissingExtraError: xarray is not installed.
        """
        with extras.needed("sweep"):
            import xarray as xr

        told = {name: {"units": unit, "long_name": meaning} for name, unit, meaning in self.signals}
        variables = {
            name: (("time_s",), self[name].copy(), told[name]) for name in self.columns if name != "time_s"
        }
        attributes: dict[str, Any] = {"scenario": self.scenario, "controller": self.controller}
        attributes |= {"end_reason": self.end_reason, **self.summary}
        time_s = (("time_s",), self["time_s"].copy(), told["time_s"])
        return xr.Dataset(variables, {"time_s": time_s}, attributes)

    def _repr_html_(self) -> str:
        """What a notebook shows: the totals, and the picture where Matplotlib is installed."""
        shown = [name for name in _SHOWN if name in self.summary]
        rows = [(name, f"{self.summary[name]:.6g}", unit_of(name)) for name in shown]
        title = f"{self.scenario} with {self.controller}: {self.end_reason.replace('_', ' ')}"
        table = notebooks.table(title, rows)
        try:
            plot = later.function("hp_gym.pictures.plotting", "plot")
        except extras.MissingExtraError:
            return table
        return table + notebooks.picture(lambda path: plot(self, path))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the table to a .csv or .parquet file.

        Raises:
            ValueError: The path ends otherwise.
            MissingExtraError: For .parquet, pandas and pyarrow are not installed.
            OSError: The file cannot be written; one that stood there stays as it was.
        """
        suffix = require_suffix(path, TABLE_SUFFIXES)
        if suffix == ".parquet":
            extras.require("benchmark", "pandas", "pyarrow")
        with atomic_write(path) as temporary:
            if suffix == ".csv":
                self._write_csv(temporary)
            else:
                self.to_pandas().to_parquet(temporary, index=False)

    def _write_csv(self, path: Path) -> None:
        """Writes what pandas would, which need not be installed: shortest exact numbers, nothing for NaN."""
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator=os.linesep)
            writer.writerow(self.columns)
            for row in self.values.tolist():
                writer.writerow("" if math.isnan(value) else value for value in row)
