"""What choices cost on training trips: energy, at a comfort that they must keep."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, Literal, TypeAlias

import numpy as np

from hp_gym.agents.training.trips import Driven, drive
from hp_gym.comfort_standard import REFERENCE, Verdict, judge
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.overrides import assignments
from hp_gym.studies.tuning import rule_choices
from hp_gym.studies.tuning.ambient_bands import Band, training_distribution
from hp_gym.studies.tuning.kept_trials import KeptTrials, Outcome

REWARD: Final = "reference"
"""What the reference policies are trained for, too (configs/rewards/reference.toml)."""

REWARD_AT_STANDARD: Final[Mapping[str, float | str]] = {"base": REWARD, "discomfort_per_k_h": 0.0}
"""Held to the standard, rules gain nothing by more comfort than that asks for."""

MARGIN_K: Final = 3.5
MARGIN_SHARE: Final = 0.2
"""By how much rules must be more comfortable than the paper's: the lesser of Kelvins and share."""

PENALTY_PER_K: Final = 20.0
"""Points for each Kelvin of discomfort beyond what is allowed: twenty times the reward's, on 20 minutes."""

FAILED_TRIP_POINTS: Final = 100.0
"""Points for a trip that fails the standard: more than any trip costs (configs/rewards/balanced.toml)."""

Comfort: TypeAlias = Literal["pooled", "standard"]
"""What rules are held to: mean discomfort beside the paper's, or `hp_gym.comfort_standard` trip by trip."""


class Objective:
    """Mean score of rules over the same training trips of a band, at a comfort that they must keep.

    Args:
        band: Ambient band.
        distribution: File of its trips.
        trips: Number of trips.
        seed: Seed of the first one.
        kept: Trials that were driven before, if any.
        overrides: Changes for all trips, `key=value`.
        comfort: What rules are held to.
    """

    def __init__(
        self,
        band: Band,
        distribution: Path,
        trips: int,
        seed: int,
        kept: KeptTrials | None = None,
        *,
        overrides: Sequence[str] = (),
        comfort: Comfort = "pooled",
    ) -> None:
        self.band = band
        self._distribution = distribution
        self._trips = trips
        self._seed = seed
        self._kept = kept
        self._overrides = overrides
        self._comfort = comfort
        self._reference = self._trips_of(REFERENCE).comfort if comfort == "standard" else None
        _, papers = self._outcome(rule_choices.PAPER)
        allowed_k = papers - min(MARGIN_K, MARGIN_SHARE * papers)
        self._allowed, self._penalty = (
            (allowed_k, PENALTY_PER_K) if self._reference is None else (0.0, FAILED_TRIP_POINTS)
        )

    def score(self, choices: rule_choices.Choices) -> float:
        """Returns points a trip; more is better.

        Discomfort beyond what is allowed costs `PENALTY_PER_K`; held to the standard, a trip that fails costs
        `FAILED_TRIP_POINTS`, half of them where it hardly fails.
        """
        score, lack = self._outcome(choices)
        return score - self._penalty * max(lack - self._allowed, 0.0)

    def _outcome(self, choices: rule_choices.Choices) -> Outcome:
        """What was driven before, or is driven now."""
        if self._kept is None:
            return self._drive(choices)
        outcome = self._kept.get(self.band, choices)
        if outcome is None:
            outcome = self._drive(choices)
            self._kept.add(self.band, choices, outcome)
        return outcome

    def _drive(self, choices: rule_choices.Choices) -> Outcome:
        """Mean score of a trip, and what it lacks in comfort.

        That is the mean discomfort over time [K], or, held to the standard, `failed_share`.
        """
        with TemporaryDirectory() as folder:
            file = Path(folder) / "controller.toml"
            rule_choices.write(file, "One trial of a search.", [(self.band, choices)])
            driven = self._trips_of(str(file))
        if self._reference is not None:
            lack = failed_share(judge(driven.comfort, self._reference))
        else:
            lack = float(np.average(driven.discomfort_k, weights=driven.duration_s))
        return float(driven.score.mean()), lack

    def _trips_of(self, controller: str) -> Driven:
        """The trips, driven by rules of a name or a file."""
        env = EVHeatPumpVectorEnv(
            self._trips,
            distribution=self._distribution,
            continuous=True,
            actions=HpcuPolicy.ACTIONS,
            reward=REWARD if self._comfort == "pooled" else dict(REWARD_AT_STANDARD),
            overrides=[*self._overrides, *assignments({"scenario.controller": controller})],
        )
        seeds = range(self._seed, self._seed + self._trips)
        return drive(env, seeds, lambda *_: env.rule_based_actions())


def failed_share(verdict: Verdict) -> float:
    """Share of trips that fail, half of one where it hardly fails, so that a search sees how near it is."""
    how_far = 0.5 * (1.0 + np.minimum(verdict.excess, 1.0))
    return float(np.mean(np.where(verdict.passes, 0.0, how_far)))


@contextmanager
def objective(
    band: Band,
    trips: int,
    seed: int,
    kept: KeptTrials | None = None,
    *,
    overrides: Sequence[str] = (),
    comfort: Comfort = "pooled",
) -> Iterator[Objective]:
    """Gives the objective of a band; see `Objective`."""
    with training_distribution(band) as distribution:
        yield Objective(band, distribution, trips, seed, kept, overrides=overrides, comfort=comfort)
