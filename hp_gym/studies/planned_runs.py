"""Many runs in one native call: what sweeps and searches have in common."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.build_identity import build
from hp_gym.near_names import unknown
from hp_gym.overrides import Value
from hp_gym.studies.axes import AxisError, Base

Planned: TypeAlias = tuple[str, str | None, str | None, list[str]]
"""Scenario, controller, vehicle and overrides of a run."""

REFUSED: Final = "refused"
"""Reason of the end of a run that the plant does not accept."""


@dataclass(frozen=True)
class Totals:
    """Totals of runs.

    Attributes:
        names: Their names, each ending with its unit.
        values: A row of them for each run; NaN where one does not exist.
        ends: Why each ended: `arrived`, `unserved_energy`, `battery_empty`, or `refused`.
        refusals: Why the plant refused each, None where it did not.
    """

    names: tuple[str, ...]
    values: NDArray[np.float64]
    ends: tuple[str, ...]
    refusals: tuple[str | None, ...]


def drive(runs: Sequence[Planned], threads: int, substeps: int = 1) -> Totals:
    """Drives runs side by side on native threads, each bit for bit as `simulate` does."""
    names, values, ends, refusals = _core.summaries(runs, threads, substeps)
    return Totals(tuple(names), values, tuple(end or REFUSED for end in ends), tuple(refusals))


def drive_on_same(runs: Sequence[Planned], substeps: int, wanted: str) -> tuple[str, Totals | None]:
    """Drives runs on one thread if this process has the build that is wanted: another gives other bits.

    Returns:
        The build of this process, and the totals; None where it is another one.
    """
    found = build()
    return found, drive(runs, 1, substeps) if found == wanted else None


def processors() -> int:
    """Returns the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def require_kpis(kpis: Sequence[str], base: Base, changes: Mapping[str, Value]) -> tuple[str, ...]:
    """Checks that totals exist, by driving one run.

    Args:
        kpis: Names of totals.
        base: What is driven.
        changes: What differs in the run.

    Returns:
        Names of all totals of that run.

    Raises:
        AxisError: One does not exist; the message says what is near.
    """
    totals = drive([base.run(changes)], 1, base.substeps)
    if totals.refusals[0] is not None:
        raise AxisError(totals.refusals[0])
    for kpi in kpis:
        if kpi not in totals.names:
            raise AxisError(unknown("KPI", kpi, totals.names))
    return totals.names
