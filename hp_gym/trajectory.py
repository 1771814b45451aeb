"""The record of a run."""

from __future__ import annotations

import csv
import math
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from hp_gym import extras, signals, vehicle_layout
from hp_gym.files import atomic_write, require_suffix

# pandas takes a second to import: it is loaded by the methods that need it.
if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy as np
    import pandas as pd
    from numpy.typing import NDArray

TABLE_SUFFIXES: Final = (".csv", ".parquet")


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
            KeyError: There is no such column.
        """
        return self.values[:, self._places[column]]

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
