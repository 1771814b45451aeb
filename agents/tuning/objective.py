"""What choices cost on training trips."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from agents.tuning import rules
from agents.tuning.bands import Band, training_distribution
from hp_gym.policies import HpcuPolicy
from hp_gym.vector_env import EVHeatPumpVectorEnv

REWARD: Final = "reference"
"""What the reference policies are trained for, too (configs/rewards/reference.toml)."""


class Objective:
    """Mean score of rules over the same training trips of a band.

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

    def score(self, choices: rules.Choices) -> float:
        """Returns points a trip; more is better."""
        with TemporaryDirectory() as folder:
            file = Path(folder) / "controller.toml"
            rules.write(file, "One trial of a search.", [(self.band, choices)])
            env = EVHeatPumpVectorEnv(
                self._trips,
                distribution=self._distribution,
                continuous=True,
                actions=HpcuPolicy.ACTIONS,
                reward=REWARD,
                overrides={"scenario.controller": str(file)},
            )
            env.reset(seed=self._seed)
            scores = np.full(self._trips, np.nan)
            while np.isnan(scores).any():
                _, _, terminated, _, _ = env.step(env.rule_based_actions())
                for index in np.flatnonzero(terminated & np.isnan(scores)).tolist():
                    scores[index] = env.kpis(index)["score"]
        return float(scores.mean())


@contextmanager
def objective(band: Band, trips: int, seed: int) -> Iterator[Objective]:
    """Gives the objective of a band."""
    with training_distribution(band) as distribution:
        yield Objective(band, distribution, trips, seed)
