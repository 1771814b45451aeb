"""What choices cost on training trips: energy, and discomfort that must not exceed the paper's."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from agents.training import configuration
from agents.tuning import rules
from agents.tuning.bands import Band, training_distribution
from hp_gym.policies import HpcuPolicy
from hp_gym.vector_env import EVHeatPumpVectorEnv

POLICY: Final = "ppo"
"""Training configuration whose reward and comfort constraint are the rules', too."""


class Objective:
    """Mean score of rules over the same training trips of a band, no less comfortable than the paper's.

    Args:
        band: Ambient band.
        distribution: File of its trips.
        trips: Number of trips.
        seed: Seed of the first one.
    """

    def __init__(self, band: Band, distribution: Path, trips: int, seed: int) -> None:
        self.band = band
        self._distribution = distribution
        self._trips = trips
        self._seed = seed
        training = configuration.load(POLICY)
        assert training.comfort_constraint is not None
        self._reward = training.environment.reward
        self._penalty_per_k = training.comfort_constraint.penalty_per_k
        _, papers_k = self._drive(rules.PAPER)
        self._allowed_k = papers_k - training.comfort_constraint.margin_for(papers_k)

    def score(self, choices: rules.Choices) -> float:
        """Returns points a trip; more is better. Discomfort beyond what is allowed costs a penalty."""
        score, discomfort_k = self._drive(choices)
        return score - self._penalty_per_k * max(discomfort_k - self._allowed_k, 0.0)

    def _drive(self, choices: rules.Choices) -> tuple[float, float]:
        """Mean score of a trip, and mean discomfort over time [K]."""
        with TemporaryDirectory() as folder:
            file = Path(folder) / "controller.toml"
            rules.write(file, "One trial of a search.", [(self.band, choices)])
            env = EVHeatPumpVectorEnv(
                self._trips,
                distribution=self._distribution,
                continuous=True,
                actions=HpcuPolicy.ACTIONS,
                reward=self._reward,
                overrides={"scenario.controller": str(file)},
            )
            env.reset(seed=self._seed)
            scores = np.full(self._trips, np.nan)
            discomfort_k, duration_s = np.zeros(self._trips), np.zeros(self._trips)
            while np.isnan(scores).any():
                _, _, terminated, _, _ = env.step(env.rule_based_actions())
                for index in np.flatnonzero(terminated & np.isnan(scores)).tolist():
                    kpis = env.kpis(index)
                    scores[index], discomfort_k[index] = kpis["score"], kpis["discomfort_k"]
                    duration_s[index] = env.summary(index)["duration_s"]
        return float(scores.mean()), float(np.average(discomfort_k, weights=duration_s))


@contextmanager
def objective(band: Band, trips: int, seed: int) -> Iterator[Objective]:
    """Gives the objective of a band."""
    with training_distribution(band) as distribution:
        yield Objective(band, distribution, trips, seed)
