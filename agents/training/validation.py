"""How good a policy is on trips that it is not trained on, beside the rule-based HPCU."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from agents.training.configuration import Training
from hp_gym.policies import HpcuPolicy
from hp_gym.vector_env import EVHeatPumpVectorEnv

Decide: TypeAlias = Callable[[NDArray[np.float32], NDArray[np.bool_] | None], Any]
"""Actions for observations and, if it uses them, masks; one row an environment."""


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
        self._settings = training.validation
        self._environment = training.environment.model_dump(
            exclude={"distribution", "reward", "sensor_noise"}
        )
        self._distribution = training.validation.distribution or training.environment.distribution
        self._threads = training.environments.threads

    def of_rules(self) -> Figures:
        """Drives the paper's rules with all their actuators, second by second."""
        envs = self._envs({"continuous": True, "actions": HpcuPolicy.ACTIONS})
        rules = HpcuPolicy(envs)
        return self._drive(envs, lambda *_: rules(), masked=False)

    def of_policy(self, decide: Decide, *, masked: bool) -> Figures:
        """Drives a policy."""
        return self._drive(self._envs(self._environment), decide, masked=masked)

    def _envs(self, arguments: dict[str, Any]) -> EVHeatPumpVectorEnv:
        return EVHeatPumpVectorEnv(
            self._settings.trips,
            autoreset_mode=AutoresetMode.SAME_STEP,
            threads=self._threads,
            distribution=self._distribution,
            reward=self._settings.reward,
            **arguments,
        )

    def _drive(self, envs: EVHeatPumpVectorEnv, decide: Decide, *, masked: bool) -> Figures:
        first, trips = self._settings.seed, self._settings.trips
        observations, _ = envs.reset(seed=list(range(first, first + trips)))
        under_way = np.ones(trips, dtype=np.bool_)
        ends: list[tuple[dict[str, float], str]] = []
        while under_way.any():
            masks = envs.action_masks() if masked else None
            observations, _, terminated, _, infos = envs.step(decide(observations, masks))
            for index in np.flatnonzero(terminated & under_way).tolist():
                final = infos["final_info"]
                kpis = {key: final["kpis"][key][index] for key in _MEANS}
                ends.append((kpis, final["end_reason"][index]))
            under_way &= ~terminated
        envs.close()
        return Figures(
            **{key: float(np.mean([kpis[key] for kpis, _ in ends])) for key in _MEANS},
            arrived_share=float(np.mean([reason == "arrived" for _, reason in ends])),
        )


_MEANS = ("score", "attributable_energy_kwh", "discomfort_k")
