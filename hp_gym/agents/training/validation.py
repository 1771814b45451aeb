"""How good a policy is on trips that it is not trained on, beside the rule-based HPCU."""

from dataclasses import dataclass

from hp_gym.agents.training.configuration import Training
from hp_gym.agents.training.trips import Decide, Driven, FixedTrips


@dataclass(frozen=True)
class Figures:
    """Means over the validation trips.

    Attributes:
        score: Reward of a trip, points.
        attributable_energy_kwh: Energy of a trip beyond its reference trip.
        discomfort_k: Mean distance of the cabin from 22 degC.
        arrived_share: Share of trips that arrived.
    """

    score: float
    attributable_energy_kwh: float
    discomfort_k: float
    arrived_share: float


class Validation:
    """A fixed set of trips.

    Args:
        training: What is trained; says which trips, and the environment of the policy.
    """

    def __init__(self, training: Training) -> None:
        settings = training.validation
        self._trips = FixedTrips(
            training,
            settings.trips,
            settings.seed,
            reward=settings.reward,
            distribution=settings.distribution,
        )

    def of_rules(self) -> Figures:
        """Drives the paper's rules."""
        return _means(self._trips.of_rules())

    def of_policy(self, decide: Decide, *, masked: bool) -> Figures:
        """Drives a policy."""
        return _means(self._trips.of_policy(decide, masked=masked))


def _means(driven: Driven) -> Figures:
    return Figures(
        score=float(driven.score.mean()),
        attributable_energy_kwh=float(driven.attributable_energy_kwh.mean()),
        discomfort_k=float(driven.discomfort_k.mean()),
        arrived_share=float(driven.arrived.mean()),
    )
