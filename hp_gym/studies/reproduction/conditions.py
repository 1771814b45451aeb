"""Building blocks of claims: conditions with a margin, and outcomes made of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

LARGEST_SHORTFALL = 100.0


@dataclass(frozen=True)
class Condition:
    """One inequality.

    Attributes:
        holds: Whether it is true.
        margin: How far it is inside (positive) or outside, in units of a natural scale.
    """

    holds: bool
    margin: float

    def shortfall(self, wanted: float = 0.0) -> float:
        """How much the margin lacks of a wanted one; 0 where it has it."""
        return min(max(0.0, wanted - self.margin), LARGEST_SHORTFALL)


def _condition(holds: bool, margin: float, scale: float) -> Condition:
    return Condition(holds, -LARGEST_SHORTFALL if math.isnan(margin) else margin / scale)


def above(value: float, limit: float, scale: float) -> Condition:
    """`value > limit`."""
    return _condition(value > limit, value - limit, scale)


def below(value: float, limit: float, scale: float) -> Condition:
    """`value < limit`."""
    return _condition(value < limit, limit - value, scale)


def at_least(value: float, limit: float, scale: float) -> Condition:
    """`value >= limit`."""
    return _condition(value >= limit, value - limit, scale)


def at_most(value: float, limit: float, scale: float) -> Condition:
    """`value <= limit`."""
    return _condition(value <= limit, limit - value, scale)


@dataclass(frozen=True)
class Outcome:
    """What became of a claim.

    Attributes:
        evidence: The model's figures behind it.
        conditions: All must hold.
    """

    evidence: str
    conditions: Sequence[Condition]

    @property
    def holds(self) -> bool:
        """Whether the claim is true of the model."""
        return all(condition.holds for condition in self.conditions)

    def shortfalls(self, wanted: float = 0.0) -> list[float]:
        """How much the margin of each condition lacks of a wanted one."""
        return [condition.shortfall(wanted) for condition in self.conditions]
