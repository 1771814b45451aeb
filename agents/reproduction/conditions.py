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
        shortfall: How far it is from being true, in units of a natural scale; 0 where it holds.
    """

    holds: bool
    shortfall: float


def _condition(holds: bool, margin: float, scale: float) -> Condition:
    if holds:
        return Condition(True, 0.0)
    shortfall = LARGEST_SHORTFALL if math.isnan(margin) else min(max(0.0, -margin / scale), LARGEST_SHORTFALL)
    return Condition(False, shortfall)


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

    @property
    def shortfalls(self) -> list[float]:
        """How far each condition is from being true."""
        return [condition.shortfall for condition in self.conditions]
