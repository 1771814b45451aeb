"""Rows of published values judged by what was driven."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from hp_gym.studies.published_values.published import Published, Row
from hp_gym.studies.published_values.rigs import Figures

Results = Mapping[str, Mapping[str, Figures]]
"""Figures by experiment and by car (or rig)."""


@dataclass(frozen=True)
class Judged:
    """A row and what the model says.

    Attributes:
        id: Its number, unique.
        row: As the file gives it.
        vehicle: Whose value it is.
        model: The model's value; None where it has none (a speed or a temperature was not reached).
        passes: Whether it lies within the tolerance.
        explanation: Why it does not.
    """

    id: str
    row: Row
    vehicle: str
    model: float | None
    passes: bool
    explanation: str

    @property
    def published(self) -> str:
        """The published value or range in words."""
        low, high = self.row.low, self.row.high
        if low is not None and high is not None:
            return f"{low:g}" if low == high else f"{low:g}..{high:g}"
        return f"at least {low:g}" if low is not None else f"at most {high:g}"

    @property
    def tolerance(self) -> str:
        """What is allowed beyond it, in words."""
        row = self.row
        return (
            f"{row.tolerance_pct:g} %"
            if row.tolerance_pct is not None
            else f"{row.tolerance:g} {_unit(row)}".strip()
        )

    def to_json(self) -> dict[str, Any]:
        """The row as plain data."""
        row = self.row
        return {
            "id": self.id,
            "vehicle": self.vehicle,
            "published": {"low": row.low, "high": row.high},
            "model": self.model,
            "tolerance": {"absolute": row.tolerance, "pct": row.tolerance_pct},
            "passes": self.passes,
            "unit": row.unit,
            "text": row.text,
            "conditions": row.conditions,
            "source": row.source,
            "set": row.set,
            "also": list(row.also),
            "explanation": self.explanation,
        }


def _unit(row: Row) -> str:
    return "" if row.unit == "-" else row.unit


def judge(published: Published, results: Results) -> list[Judged]:
    """Judges all rows, in the order of the file."""
    return [judged for row in published.row for judged in _rows(row, results)]


def _rows(row: Row, results: Results) -> Iterator[Judged]:
    values = _values(row, results)
    if row.over == "each" and len(values) > 1:
        for number, (key, value) in enumerate(values.items(), start=1):
            yield _judged(row, f"{row.id}.{number}", key, value)
        return
    vehicle = ", ".join(dict.fromkeys(key.partition(" ")[0] for key in values))
    yield _judged(row, row.id, vehicle, float(np.mean(list(values.values()))))


def _values(row: Row, results: Results) -> dict[str, float]:
    found = {key: figures[row.take] for key, figures in results[row.experiment].items()}
    if row.against is None:
        return found
    other = {key: figures[row.take] for key, figures in results[row.against].items()}
    if len(found) == 1 and len(other) == 1:
        other = dict(zip(found, other.values(), strict=True))
    return {key: _compared(row.as_, value, other[key]) for key, value in found.items()}


def _compared(how: str, value: float, other: float) -> float:
    if how == "ratio":
        return value / other
    return 100.0 * (value / other - 1.0) if how == "change_pct" else value - other


def _judged(row: Row, name: str, vehicle: str, value: float) -> Judged:
    low, high = row.bounds()
    exists = bool(np.isfinite(value))
    passes = exists and (low is None or value >= low) and (high is None or value <= high)
    explanation = row.explanation if isinstance(row.explanation, str) else row.explanation.get(vehicle, "")
    return Judged(name, row, vehicle, value if exists else None, passes, "" if passes else explanation)
