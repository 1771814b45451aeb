"""What a search wants: totals made small or large, and limits that others must keep."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from hp_gym.messages import OneLineError
from hp_gym.studies.planned_runs import Totals

ARRIVED: Final = "arrived"

_PER_TIME: Final = ("discomfort_k", "comfortable_share", "mean_voltage_v")
"""Totals that are means over time, and so are they over several trips, as in the benchmark."""

_PER_DISTANCE: Final = ("energy_kwh_per_100_km",)

_LIMIT: Final = re.compile(r"\s*([a-z]\w*)\s*(<=|>=)\s*(\S+)\s*")


class GoalError(OneLineError):
    """A goal or a constraint is not right."""


@dataclass(frozen=True)
class Goal:
    """A total to be made small or large.

    Attributes:
        kpi: Its name.
        larger: Whether more is better.
    """

    kpi: str
    larger: bool = False

    @property
    def direction(self) -> Literal["minimize", "maximize"]:
        """Optuna's word for it."""
        return "maximize" if self.larger else "minimize"


@dataclass(frozen=True)
class Limit:
    """A total that must stay on one side of a value.

    Attributes:
        kpi: Its name.
        bound: The value.
        most: Whether it is the greatest allowed; the least otherwise.
    """

    kpi: str
    bound: float
    most: bool

    def excess(self, value: float) -> float:
        """By how much a value is beyond; 0 or less is allowed, and what does not exist is not."""
        excess = value - self.bound if self.most else self.bound - value
        return excess if np.isfinite(excess) else np.inf


def goal(text: str) -> Goal:
    """Reads `KPI` or `min:KPI` (made small), or `max:KPI` (made large).

    Raises:
        GoalError: It is neither.
    """
    way, colon, kpi = text.strip().rpartition(":")
    if way not in {"", "min", "max"} or not kpi or (colon and not way):
        message = f"goal `{text}` must have the form KPI, min:KPI or max:KPI"
        raise GoalError(message)
    return Goal(kpi, way == "max")


def limit(text: str) -> Limit:
    """Reads `KPI<=VALUE` or `KPI>=VALUE`.

    Raises:
        GoalError: It is neither.
    """
    found = _LIMIT.fullmatch(text)
    try:
        bound = float(found[3]) if found else np.nan
    except ValueError:
        bound = np.nan
    if found is None or not np.isfinite(bound):
        message = f"constraint `{text}` must have the form KPI<=VALUE or KPI>=VALUE"
        raise GoalError(message)
    return Limit(found[1], bound, found[2] == "<=")


def over_trips(kpi: str, totals: Totals, rows: Sequence[int]) -> float:
    """Mean of a total over several trips, weighted by time or distance where it is a mean over those."""
    column = totals.names.index(kpi)
    values = totals.values[list(rows), column]
    if kpi in _PER_TIME:
        return float(np.average(values, weights=_weights(totals, rows, "duration_s")))
    if kpi in _PER_DISTANCE:
        return float(np.average(values, weights=_weights(totals, rows, "distance_km")))
    return float(values.mean())


def _weights(totals: Totals, rows: Sequence[int], name: str) -> NDArray[np.float64]:
    return totals.values[list(rows), totals.names.index(name)]


def stranded(totals: Totals, rows: Sequence[int]) -> int:
    """Number of trips that did not arrive; as in the benchmark, their totals cannot be compared."""
    return sum(totals.ends[row] != ARRIVED for row in rows)
