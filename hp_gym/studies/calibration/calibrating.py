"""A calibration from its file to its results, without the terminal."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
import tomlkit

from hp_gym import notebooks
from hp_gym.json_text import dumps
from hp_gym.studies.calibration import calibrated_files, calibration_report, held_out, measured_report
from hp_gym.studies.calibration.fit import Fit, Options, Progress, fit
from hp_gym.studies.calibration.identifiability import Knowledge, knowledge
from hp_gym.studies.calibration.measurements import Driven, Measurement
from hp_gym.studies.calibration.problem import Problem, load
from hp_gym.studies.calibration.residuals import overrides
from hp_gym.transactions import new_contents

if TYPE_CHECKING:
    from hp_gym.studies.calibration.calibration_report import HeldOut

OVERRIDES: Final = "calibrated.toml"
KNOWLEDGE: Final = "knowledge.json"
"""Covariance, agreement with each measurement, and what the data cannot tell."""

Bars = Callable[[str, int], AbstractContextManager[Progress | None]]
"""Shows how far a fit is, by its name and how many evaluations there can be."""


@dataclass(frozen=True)
class Judged:
    """How far a quantity of a measurement is from the model.

    Attributes:
        measurement: Name of the measurement.
        role: Its role; `left out` where the fit was made without it.
        quantity: Signal or total.
        deviation: Root of the mean square of the deviations, in units of the stated uncertainty.
        error: The same in the unit of the quantity.
        values: Number of values.
    """

    measurement: str
    role: str
    quantity: str
    deviation: float
    error: float
    values: int


@dataclass(frozen=True)
class Calibrated:
    """A finished calibration.

    Attributes:
        fit: The fit.
        judged: How the model agrees with each measurement that may be looked at.
        left_out: The same for measurements that a fit without them predicts.
        knowledge: What the data say about the parameters; None without measurements.
        held_out: Errors of published totals that fits without them predict.
    """

    fit: Fit
    judged: tuple[Judged, ...] = ()
    left_out: tuple[Judged, ...] = ()
    knowledge: Knowledge | None = None
    held_out: tuple[HeldOut, ...] = ()

    def write(self, folder: Path) -> None:
        """Writes `calibrated.toml`, for `--overrides`, and a vehicle and a controller with the values.

        Those have the problem's own as `base`, and are read by path wherever one is.

        Raises:
            OSError: A file cannot be written.
        """
        (folder / OVERRIDES).write_text(calibration_report.to_toml(self.fit), encoding="utf-8")
        if self.knowledge is not None:
            (folder / KNOWLEDGE).write_text(dumps(measured_report.to_json(self)), encoding="utf-8")
        problem = self.fit.problem
        for kind, base in (("vehicle", problem.vehicle), ("controller", problem.controller)):
            text = _based(kind, base, self.fit.by_key())
            if text is not None:
                (folder / f"{kind}.toml").write_text(text, encoding="utf-8")

    def _repr_html_(self) -> str:
        """What a notebook shows: values with their deviations, and what is not known."""
        known = self.knowledge
        spread = known.deviations if known else [float("nan")] * len(self.fit.values)
        rows = [
            (name, f"{value:g}", f"± {deviation:.2g}" if np.isfinite(deviation) else "")
            for (name, value), deviation in zip(self.fit.by_name().items(), spread, strict=True)
        ]
        groups = "; ".join(" with ".join(group) for group in known.open_groups) if known else ""
        told = f"<p>The data cannot tell apart: {groups}</p>" if groups else ""
        return notebooks.table(self.fit.problem.description, rows) + told


def _based(kind: str, base: str, values: Mapping[str, float]) -> str | None:
    """A file with a base and the values of its kind; None where there are none, or one is within a list."""
    own = {key.partition(".")[2]: value for key, value in values.items() if key.startswith(f"{kind}.")}
    if not own or any("[" in key for key in own):
        return None
    document = tomlkit.document()
    document.add(tomlkit.comment("Written by `hp-gym calibrate`."))
    document["base"] = str(Path(base).resolve()) if Path(base).is_file() else base
    if kind == "vehicle":
        document["description"] = f"{Path(base).stem}, calibrated"
    for key, value in own.items():
        place: tomlkit.items.Table | tomlkit.TOMLDocument = document
        *sections, last = key.split(".")
        for section in sections:
            if section not in place:
                place[section] = tomlkit.table()
            place = place[section]
        place[last] = value
    return tomlkit.dumps(document)


def judge(fitted: Fit, measurements: tuple[Measurement, ...], role: str | None = None) -> list[Judged]:
    """Compares measurements with a fit.

    Args:
        fitted: The fit.
        measurements: What it is compared with.
        role: What is told as their role; their own by default.
    """
    problem = fitted.problem
    if not measurements:
        return []
    driven = Driven(measurements, problem.vehicle, problem.controller)
    found = driven.deviations(overrides(problem.parameters, fitted.values))
    judged = []
    for one in measurements:
        scales = {trace.signal: (trace.sigma, trace.weight) for trace in one.traces}
        scales |= {kpi: (sigma, 1.0) for kpi, _, sigma in one.totals}
        for quantity, (sigma, weight) in scales.items():
            deviation = float(np.sqrt(np.mean((found[one.name][quantity] / weight) ** 2)))
            count = len(found[one.name][quantity])
            judged.append(Judged(one.name, role or one.role, quantity, deviation, deviation * sigma, count))
    return judged


def carry_out(
    problem: Problem,
    start: dict[str, float],
    options: Options,
    *,
    leave_one_out: bool = False,
    held_back: bool = False,
    bars: Bars | None = None,
) -> Calibrated:
    """Fits, judges the fit, and leaves out each target or measurement in turn if that is wanted.

    Args:
        problem: The calibration.
        start: Value of each parameter to start from, by its first key.
        options: How to search.
        leave_one_out: Whether to refit without each.
        held_back: Whether measurements that are held back are looked at.
        bars: Shows how far fits are.
    """
    show: Bars = bars or (lambda _name, _evaluations: nullcontext(None))
    limit = options.maximum_evaluations or problem.maximum_evaluations
    with show("fit", limit) as progress:
        result = fit(problem, start, options, progress)
    seen = tuple(one for one in problem.measurements if held_back or one.role != "held-back")
    left_out: list[Judged] = []
    parts: list[HeldOut] = []
    if leave_one_out:
        fewer = replace(options, restarts=0, maximum_evaluations=max(limit // 4, 1))
        for target in problem.targets:
            with show(f"without {target.scenario}", fewer.maximum_evaluations or 1) as progress:
                parts.append(held_out.leave_out(problem, target.scenario, result.by_name(), fewer, progress))
        fitted = [one for one in problem.measurements if one.role == "fit"]
        for one in fitted if len(fitted) + len(problem.targets) > 1 else []:
            with show(f"without {one.name}", fewer.maximum_evaluations or 1) as progress:
                # From the priors: in the full fit's values something of the left-out one lives on.
                priors = {parameter.name: parameter.prior for parameter in problem.parameters}
                rest = fit(problem.without_measurement(one.name), priors, fewer, progress)
            left_out += judge(rest, (one,), "left out")
    return Calibrated(
        result,
        tuple(judge(result, seen)),
        tuple(left_out),
        knowledge(result) if problem.measurements else None,
        tuple(parts),
    )


def calibrate(
    config: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str] | None = None,
    start: str = "prior",
    leave_one_out: bool = False,
    held_back: bool = False,
    options: Options | None = None,
) -> Calibrated:
    """Fits parameters within bounds to measurements and published totals, as a file says.

    Args:
        config: Name or path of a calibration file, which fixes what each measurement is for.
        out: Folder for the result; none is written by default.
        start: `prior`, or `current`: the values in the files.
        leave_one_out: Whether to refit without each measurement and published total.
        held_back: Whether measurements that are held back are looked at: once, when all else is decided.
        options: How to search.

    Raises:
        ValueError: The file is not right, or a measurement does not fit it.
        OSError: A file cannot be read, or the folder not be written to; what was there before is intact.
    """
    problem = load(os.fspath(config))
    values = (
        calibrated_files.current_values(problem)
        if start == "current"
        else {parameter.name: parameter.prior for parameter in problem.parameters}
    )
    result = carry_out(
        problem, values, options or Options(), leave_one_out=leave_one_out, held_back=held_back
    )
    if out is not None:
        with new_contents(Path(out)) as folder:
            result.write(folder)
    return result
