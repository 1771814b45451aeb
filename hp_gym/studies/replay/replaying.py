"""A measured trip driven by the model."""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from hp_gym import _core, extras, later, notebooks
from hp_gym.files import require_suffix
from hp_gym.json_text import dumps
from hp_gym.overrides import Overrides, Value, assignments
from hp_gym.simulation import Controller, simulate
from hp_gym.studies import csv_columns
from hp_gym.studies.replay import measured_quantities, measured_trace, replay_report, replay_scenario
from hp_gym.studies.replay.measured_quantities import QUANTITIES, Channels
from hp_gym.studies.replay.series_errors import SeriesError, series_errors
from hp_gym.studies.replay.trip_figures import Pair, figures
from hp_gym.transactions import new_contents

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from hp_gym.trajectory import Trajectory

FIGURES: Final = "figures.json"
SUFFIXES: Final = (".csv",)
COMPARISON: Final = "comparison.csv"
TRAJECTORY: Final = "trajectory.csv"


@dataclass(frozen=True, eq=False)
class Replay:
    """A measured trip beside the model's.

    Attributes:
        vehicle: Name or path of the vehicle.
        trace: Path of the trace.
        trajectory: The model's run.
        measured: What was measured, at the full seconds that both have, by the name of the quantity.
        model: The same of the model.
        figures: What both come to, by name.
        errors: How far the model is from what was measured, second by second.
        notes: Where starts and values come from, in sentences.
        warnings: Where the two are not of the whole trip, in sentences.
    """

    vehicle: str
    trace: str
    trajectory: Trajectory
    measured: Channels = field(repr=False)
    model: Channels = field(repr=False)
    figures: Mapping[str, Pair]
    errors: tuple[SeriesError, ...]
    notes: tuple[str, ...] = field(repr=False)
    warnings: tuple[str, ...]

    @property
    def title(self) -> str:
        """What was driven by what, in a line."""
        return f"{Path(self.trace).name} by {Path(self.vehicle).name} with {self.trajectory.controller}"

    def to_json(self) -> dict[str, Any]:
        """The figures as plain data, a pair each; None where not measured."""
        return {name: {"measured": one.measured, "model": one.model} for name, one in self.figures.items()}

    def plot(self, path: str | os.PathLike[str] | None = None) -> Figure:
        """Draws both over time.

        Args:
            path: Picture to write (.png, .svg or .pdf); None for the figure alone.

        Raises:
            ValueError: The path ends otherwise.
            MissingExtraError: Matplotlib is not installed.
            OSError: The file cannot be written; one that stood there stays as it was.
        """
        drawn: Figure = later.function("hp_gym.studies.replay.replay_plot", "plot")(self, path)
        return drawn

    def write(self, folder: Path) -> None:
        """Writes the figures, both second by second, and all signals of the model into a folder.

        Raises:
            OSError: A file cannot be written.
        """
        (folder / FIGURES).write_text(dumps(self.to_json()), encoding="utf-8")
        self.trajectory.save(folder / TRAJECTORY)
        columns = {"time_s": np.arange(len(next(iter(self.model.values()))), dtype=float)}
        for quantity in QUANTITIES:
            if quantity.name in self.measured:
                columns[quantity.column] = self.measured[quantity.name]
            if quantity.name in self.model:
                columns[f"model_{quantity.name}"] = self.model[quantity.name]
        with (folder / COMPARISON).open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(np.stack(list(columns.values()), axis=1).tolist())

    def _repr_html_(self) -> str:
        """What a notebook shows: the figures, and the picture where Matplotlib is installed."""
        figures = replay_report.figure_rows(self.figures)
        rows = [(label, f"{measured} | {model}", unit) for label, measured, model, _, unit in figures]
        table = notebooks.table(f"{self.title}: measured | model", rows)
        try:
            later.function("hp_gym.studies.replay.replay_plot", "plot")
        except extras.MissingExtraError:
            return table
        return table + notebooks.picture(self.plot)


def replay(
    vehicle: str | os.PathLike[str],
    trace: str | os.PathLike[str],
    *,
    scenario: str | os.PathLike[str] | None = None,
    controller: str | os.PathLike[str] | Controller | None = None,
    overrides: Overrides | None = None,
    out: str | os.PathLike[str] | None = None,
) -> Replay:
    """Drives a measured trip and sets what was measured beside the model (docs/replay.md).

    Args:
        vehicle: Name or path.
        trace: Path of a .csv file: `time_s`, a speed, what there is of slope, weather and settings, and what
            was measured in columns that begin with `measured_`. Battery and cabin start from the first values
            that were measured.
        scenario: Name or path of a scenario that gives what the trace does not; by default all that the car
            has is used, the battery is left alone, and it is charged to 80 %.
        controller: As for `simulate`; by default that of the scenario, or `hpcu-modern` without one.
        overrides: As for `simulate`. They count more than first measured temperatures; a constant of the
            climate or of settings does not count where the trace has its column.
        out: Folder for the figures, the comparison and all signals; none is written by default.

    Raises:
        ColumnError: The trace is no table of numbers.
        TraceError: What was measured is not in the unit of its column.
        ConfigurationError: Vehicle, scenario, controller, an override or what is driven is not accepted.
        OSError: The trace cannot be read, or the folder not be written to; what was there before is intact.
    """
    name, changed = os.fspath(vehicle), assignments(overrides)
    require_suffix(trace, SUFFIXES)
    columns = csv_columns.read(Path(trace))
    base, rules = scenario, controller
    given: dict[str, Value] = {}
    if base is None:
        base = replay_scenario.SCENARIO
        rules = replay_scenario.CONTROLLER if rules is None else rules
        given |= replay_scenario.usual(columns, name)
    given |= replay_scenario.roles(columns, os.fspath(base))
    # Refuses a trace that cannot be driven before anything of it is used.
    known = None if callable(rules) or rules is None else os.fspath(rules)
    experiment = _core.Experiment(os.fspath(base), known, [*assignments(given), *changed], 1, name)
    measured = measured_trace.of(columns)
    given |= replay_scenario.first_temperatures(measured, experiment.layout())
    trajectory = simulate(base, rules, [*assignments(given), *changed], vehicle=name)
    compared = _compared(name, measured, trajectory, experiment.duration_s, changed)
    if out is not None:
        with new_contents(Path(out)) as folder:
            compared.write(folder)
    return compared


def _compared(
    vehicle: str,
    trace: measured_trace.MeasuredTrace,
    trajectory: Trajectory,
    duration_s: int,
    changed: list[str],
) -> Replay:
    """Compares the seconds that both have."""
    seconds = 1 + min(duration_s, len(trajectory) - 1)
    measured = {name: values[:seconds] for name, values in trace.channels.items()}
    model = {name: values[:seconds] for name, values in measured_quantities.of_model(trajectory).items()}
    ambient_degc = float(trajectory["ambient_temperature_degc"][0])
    return Replay(
        vehicle,
        os.fspath(trace.path),
        trajectory,
        measured,
        model,
        figures(measured, model),
        series_errors(measured, model),
        tuple(replay_scenario.notes(trace, ambient_degc, changed)),
        tuple(_warnings(duration_s, trajectory)),
    )


def _warnings(duration_s: int, trajectory: Trajectory) -> list[str]:
    driven_s = len(trajectory) - 1
    if driven_s < duration_s:
        end = trajectory.end_reason.replace("_", " ")
        return [
            f"The model ends at {driven_s} s of {duration_s} s ({end}): all figures are of the time before."
        ]
    if driven_s > duration_s:
        late_s = driven_s - duration_s
        return [
            f"The model falls behind and arrives {late_s} s later: figures are of the first {duration_s} s."
        ]
    return []
