"""The results of a sweep: one labelled table, as pandas, xarray or a picture."""

from __future__ import annotations

import shutil
import weakref
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import pyarrow.parquet as pq

from hp_gym import notebooks
from hp_gym.near_names import unknown
from hp_gym.studies.sweep.chunk_files import END, RUN, TABLE, Folder
from hp_gym.studies.sweep.sweep_plan import SweepError

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

DEFAULT_KPIS: Final = ("energy_kwh", "discomfort_k")
"""Totals that pictures show unless others are named."""


class Sweep:
    """A finished sweep, or what there is of one that is being driven.

    Only what is asked for is read from its folder.

    Args:
        path: Folder of the sweep.
        temporary: Whether the folder goes when this object does.

    Raises:
        SweepError: There is no sweep in the folder.
    """

    def __init__(self, path: str | os.PathLike[str], *, temporary: bool = False) -> None:
        self.path = Path(path)
        if temporary:
            weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)
        self._folder = Folder(self.path)
        definition = self._folder.read_definition()
        if definition is None:
            raise SweepError(f"{self.path}: there is no sweep in this folder")
        self.definition = definition

    @property
    def axes(self) -> dict[str, str]:
        """Unit of each axis by name."""
        return {axis["name"]: axis["unit"] for axis in self.definition["axes"]}

    @property
    def complete(self) -> bool:
        """Whether all runs are driven."""
        return self._folder.complete

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns: `run`, the axes, `end_reason`, the totals."""
        if self.complete:
            return tuple(pq.read_schema(self.path / TABLE).names)
        names: dict[str, None] = {}
        for path in self._folder.chunks().values():
            names |= dict.fromkeys(pq.read_schema(path).names)
        return tuple(names)

    @property
    def kpis(self) -> tuple[str, ...]:
        """Names of the totals."""
        others = {RUN, END, *self.axes}
        return tuple(name for name in self.columns if name not in others)

    def require_kpis(self, kpis: Sequence[str]) -> list[str]:
        """Returns names of totals if they exist.

        Raises:
            SweepError: One does not; the message says what is near.
        """
        for kpi in kpis:
            if kpi not in self.kpis:
                raise SweepError(unknown("KPI", kpi, self.kpis))
        return list(kpis)

    def to_pandas(self, kpis: Sequence[str] | None = None) -> pd.DataFrame:
        """Returns a table, one row a run, with units in `attrs["units"]`.

        Args:
            kpis: Totals that it has; all by default.

        Raises:
            SweepError: A total does not exist.
        """
        import pandas as pd

        wanted = [RUN, *self.axes, END, *self.require_kpis(self.kpis if kpis is None else kpis)]
        parts = []
        units: dict[str, str] = {}
        for table in self._folder.tables():
            present = [name for name in wanted if name in table.column_names]
            units |= {
                name: (table.schema.field(name).metadata or {}).get(b"unit", b"-").decode()
                for name in present
            }
            parts.append(table.select(present).to_pandas())
        if not parts:
            raise SweepError(f"{self.path}: no run is driven yet")
        frame: pd.DataFrame = pd.concat(parts, ignore_index=True)[wanted]
        frame.attrs["units"] = units
        return frame

    def to_xarray(self, kpis: Sequence[str] | None = None) -> xr.Dataset:
        """Returns a data set: the axes of a grid are its dimensions; a sample has the dimension `run`.

        Args:
            kpis: Totals that it has; all by default.

        Raises:
            SweepError: A total does not exist, or runs of a grid are missing.
        """
        import xarray as xr

        frame = self.to_pandas(kpis)
        units = frame.attrs["units"]
        names = [name for name in frame.columns if name not in {RUN, *self.axes}]
        if self.definition["sample"] is None:
            if len(frame) != self.definition["runs"]:
                raise SweepError(f"{self.path}: {self.definition['runs'] - len(frame)} runs are missing")
            shape = tuple(len(axis["values"]) for axis in self.definition["axes"])
            dimensions = tuple(self.axes)
            places = np.arange(len(frame)).reshape(shape)
            coordinates: dict[str, Any] = {}
            for axis, name in enumerate(dimensions):
                along = places[tuple(slice(None) if other == axis else 0 for other in range(len(shape)))]
                coordinates[name] = ((name,), frame[name].to_numpy()[along], _attributes(name, units))
        else:
            shape, dimensions = (len(frame),), (RUN,)
            coordinates = {RUN: ((RUN,), frame[RUN].to_numpy())}
            coordinates |= {
                name: ((RUN,), frame[name].to_numpy(), _attributes(name, units)) for name in self.axes
            }
        variables = {
            name: (dimensions, frame[name].to_numpy().reshape(shape), _attributes(name, units))
            for name in names
        }
        attributes = {
            key: str(self.definition[key]) for key in ("scenario", "controller", "vehicle", "build")
        }
        return xr.Dataset(variables, coordinates, attributes)

    def plot(
        self,
        path: str | os.PathLike[str] | None = None,
        kpis: Sequence[str] = DEFAULT_KPIS,
        kind: str = "auto",
    ) -> Figure:
        """Draws totals over the axes; see `hp_gym.studies.sweep.sweep_plots.plot`."""
        from hp_gym.studies.sweep.sweep_plots import plot

        return plot(self, path, kpis, kind)

    def sensitivities(self, kpi: str) -> pd.DataFrame:
        """How much each axis matters; see `hp_gym.studies.sweep.sensitivities.sensitivities`."""
        from hp_gym.studies.sweep.sensitivities import sensitivities

        return sensitivities(self, kpi)

    def _repr_html_(self) -> str:
        """What a notebook shows: ranges of axes and totals, and the picture."""
        shown = [name for name in DEFAULT_KPIS if name in self.kpis]
        frame = self.to_pandas(shown)
        cells = []
        for name in [*self.axes, *shown]:
            column = frame[name]
            numeric = column.dtype.kind == "f"
            values = f"{column.min():g} .. {column.max():g}" if numeric else f"{column.nunique()} values"
            cells.append((name, values, frame.attrs["units"].get(name, "-")))
        title = f"{len(frame):,} of {self.definition['runs']:,} runs of {self.definition['scenario']}"
        drawn = notebooks.picture(lambda path: self.plot(path, shown)) if self.complete and shown else ""
        return notebooks.table(title, cells) + drawn


def _attributes(name: str, units: dict[str, str]) -> dict[str, str]:
    return {"units": units.get(name, "-"), "long_name": name.replace("_", " ")}
