"""Comfort that must hold in every climate: discomfort weighs more where it exceeds that of rules."""

from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from hp_gym import extras
from hp_gym.agents.training.configuration import ComfortConstraintSettings, Training
from hp_gym.agents.training.environments import scaled_reward
from hp_gym.agents.training.trips import Decide, Driven, FixedTrips

with extras.needed("train"):
    from stable_baselines3.common.vec_env import VecEnv


class ComfortConstraint:
    """Learns what discomfort must weigh more at each ambient temperature.

    The policy minimises energy and weighed discomfort, subject to being no less comfortable than rules. The
    multiplier of that condition rises where the condition is violated, falls where there is comfort to spare,
    and is never negative (Tessler et al. 2019, arXiv:1805.11074, section 4, with one multiplier a climate).
    Alone it is an integral controller; the proportional part is that of Stooke et al. 2020, arXiv:2007.03964.
    With a convex weight (`convex`) this is a penalty method, no longer dual ascent: what is driven to its
    bound is the mean discomfort, what costs is its square.

    Args:
        training: What is trained.
        settings: The condition.
        notes: What `notes` returned, at a checkpoint or just after `begin`.
    """

    def __init__(
        self, training: Training, settings: ComfortConstraintSettings, notes: dict[str, Any]
    ) -> None:
        self._settings = settings
        self._trips = FixedTrips(training, settings.trips, settings.seed)
        self._next_update: int = notes["next_update"]
        self._multipliers = np.array(notes["multipliers"])
        self._integrals = np.array(notes["integrals"])
        self._allowed_k = np.array(notes["allowed_k"])

    @classmethod
    def begin(cls, training: Training, settings: ComfortConstraintSettings) -> Self:
        """Drives the rules to see what they allow.

        Raises:
            ConfigurationError: There are no such rules.
        """
        of_rules = FixedTrips(training, settings.trips, settings.seed).of_rules(settings.rules)
        reached_k = by_climate(of_rules.discomfort_k, of_rules, settings.ambient_degc)
        margin_k = np.minimum(settings.margin_k, settings.margin_share * reached_k)
        start = [settings.start] * len(settings.ambient_degc)
        notes = {
            "next_update": settings.interval_decisions,
            "multipliers": start,
            "integrals": start,
            "allowed_k": (reached_k - margin_k).tolist(),
        }
        return cls(training, settings, notes)

    @property
    def multipliers(self) -> NDArray[np.float64]:
        """Of each ambient temperature; what is added to the weight of discomfort there.

        With a convex weight at the allowed distance from comfort, less below and up to twice as much beyond.
        """
        return self._multipliers

    def weigh(self, envs: VecEnv) -> None:
        """Lets rewards count with the multipliers from now on; `environments.make` made the environments."""
        scaled = scaled_reward(envs)
        assert scaled is not None
        scaled.scale.set_multipliers(self._multipliers, self._allowed_k)

    def is_due(self, decisions: int) -> bool:
        """Whether so many decisions ask for an update."""
        return decisions >= self._next_update

    def update(self, decisions: int, decide: Decide, *, masked: bool) -> NDArray[np.float64]:
        """Drives a policy without chance and moves the multipliers.

        Returns:
            By how much each climate's discomfort exceeds what is allowed [K].
        """
        settings = self._settings
        self._next_update = decisions + settings.interval_decisions
        driven = self._trips.of_policy(decide, masked=masked)
        reached_k = by_climate(driven.discomfort_k, driven, settings.ambient_degc)
        excess_k: NDArray[np.float64] = reached_k - self._allowed_k
        counted_k = np.clip(excess_k, -1.0, 1.0)
        self._integrals = np.clip(self._integrals + settings.step_per_k * counted_k, 0.0, settings.largest)
        damped = self._integrals + settings.damping_per_k * counted_k
        self._multipliers = np.clip(damped, 0.0, settings.largest)
        return excess_k

    def notes(self) -> dict[str, Any]:
        """Returns what a checkpoint must remember."""
        return {
            "next_update": self._next_update,
            "multipliers": self._multipliers.tolist(),
            "integrals": self._integrals.tolist(),
            "allowed_k": self._allowed_k.tolist(),
        }


def by_climate(values: NDArray[np.float64], driven: Driven, ambient_degc: list[float]) -> NDArray[np.float64]:
    """Mean over time of values of trips at given ambient temperatures.

    A trip counts for the two that enclose its own, the nearer one more, and beyond all for the last. 0 where
    there is no trip.

    Args:
        values: One a trip.
        driven: The trips.
        ambient_degc: Ambient temperatures, rising.
    """
    places = np.interp(driven.ambient_degc, ambient_degc, np.arange(len(ambient_degc)))
    shares = np.maximum(1.0 - np.abs(places[:, None] - np.arange(len(ambient_degc))), 0.0)
    times = shares * driven.duration_s[:, None]
    total = times.sum(axis=0)
    means: NDArray[np.float64] = np.divide(values @ times, total, out=np.zeros_like(total), where=total > 0.0)
    return means
