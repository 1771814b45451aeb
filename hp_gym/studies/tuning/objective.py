"""What choices cost on training trips: energy, and discomfort that must not exceed the paper's."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from hp_gym.agents.training.trips import drive
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.overrides import assignments
from hp_gym.studies.tuning import rule_choices
from hp_gym.studies.tuning.ambient_bands import Band, training_distribution
from hp_gym.studies.tuning.kept_trials import KeptTrials, Outcome

REWARD: Final = "reference"
"""What the reference policies are trained for, too (configs/rewards/reference.toml)."""

MARGIN_K: Final = 3.5
MARGIN_SHARE: Final = 0.2
"""By how much rules must be more comfortable than the paper's: the lesser of Kelvins and share."""

PENALTY_PER_K: Final = 20.0
"""Points for each Kelvin of discomfort beyond what is allowed: twenty times the reward's, on 20 minutes."""


class Objective:
    """Mean score of rules over the same training trips of a band, no less comfortable than the paper's.

    Args:
        band: Ambient band.
        distribution: File of its trips.
        trips: Number of trips.
        seed: Seed of the first one.
        kept: Trials that were driven before, if any.
        overrides: Changes for all trips, `key=value`.
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
    ) -> None:
        self.band = band
        self._distribution = distribution
        self._trips = trips
        self._seed = seed
        self._kept = kept
        self._overrides = overrides
        _, papers_k = self._outcome(rule_choices.PAPER)
        self._allowed_k = papers_k - min(MARGIN_K, MARGIN_SHARE * papers_k)

    def score(self, choices: rule_choices.Choices) -> float:
        """Returns points a trip; more is better. Discomfort beyond what is allowed costs `PENALTY_PER_K`."""
        score, discomfort_k = self._outcome(choices)
        return score - PENALTY_PER_K * max(discomfort_k - self._allowed_k, 0.0)

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
        """Mean score of a trip, and mean discomfort over time [K]."""
        with TemporaryDirectory() as folder:
            file = Path(folder) / "controller.toml"
            rule_choices.write(file, "One trial of a search.", [(self.band, choices)])
            env = EVHeatPumpVectorEnv(
                self._trips,
                distribution=self._distribution,
                continuous=True,
                actions=HpcuPolicy.ACTIONS,
                reward=REWARD,
                overrides=[*self._overrides, *assignments({"scenario.controller": str(file)})],
            )
            seeds = range(self._seed, self._seed + self._trips)
            driven = drive(env, seeds, lambda *_: env.rule_based_actions())
        discomfort_k = np.average(driven.discomfort_k, weights=driven.duration_s)
        return float(driven.score.mean()), float(discomfort_k)


@contextmanager
def objective(
    band: Band, trips: int, seed: int, kept: KeptTrials | None = None, *, overrides: Sequence[str] = ()
) -> Iterator[Objective]:
    """Gives the objective of a band; see `Objective`."""
    with training_distribution(band) as distribution:
        yield Objective(band, distribution, trips, seed, kept, overrides=overrides)
