"""Trips that are the same every time: what a training is watched on."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from hp_gym.agents.training.configuration import Training
from hp_gym.comfort_standard import FIGURES, TripComfort
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

Decide: TypeAlias = Callable[[NDArray[np.float32], NDArray[np.bool_] | None], Any]
"""Actions for observations and, if it uses them, masks; one row an environment."""


@dataclass(frozen=True)
class Driven:
    """How trips went, one value a trip.

    Attributes:
        ambient_degc: Ambient temperature.
        duration_s: How long somebody was under way.
        score: Reward of the trip, points.
        attributable_energy_kwh: Energy beyond the trip's reference.
        discomfort_k: Mean distance of the cabin from 22 degC.
        arrived: 1 for trips that arrived, else 0.
        comfort: What their comfort is judged by.
    """

    ambient_degc: NDArray[np.float64]
    duration_s: NDArray[np.float64]
    score: NDArray[np.float64]
    attributable_energy_kwh: NDArray[np.float64]
    discomfort_k: NDArray[np.float64]
    arrived: NDArray[np.float64]
    comfort: TripComfort


class FixedTrips:
    """Trips with seeds that training does not use.

    Args:
        training: What is trained; says what environment the policy needs.
        number: How many trips.
        seed: Seed of the first; the others follow.
        reward: What the score is counted in.
        distribution: Where they are drawn; that of the training by default.
    """

    def __init__(
        self,
        training: Training,
        number: int,
        seed: int,
        *,
        reward: str | dict[str, float | str] | None = None,
        distribution: str | None = None,
    ) -> None:
        self._seeds = list(range(seed, seed + number))
        self._policy_arguments = training.environment.model_dump(
            exclude={"distribution", "vehicle", "reward", "sensor_noise"}
        )
        self._trip_arguments: dict[str, Any] = {
            "distribution": distribution or training.environment.distribution,
            "vehicle": training.environment.vehicle,
            "reward": training.environment.reward if reward is None else reward,
            "threads": training.environments.threads,
        }

    def of_rules(self, controller: str = "hpcu") -> Driven:
        """Drives rules with all their actuators, second by second.

        Args:
            controller: Name or path of a controller file.
        """
        rules_arguments = {
            "continuous": True,
            "actions": HpcuPolicy.ACTIONS,
            "overrides": {"scenario.controller": controller},
        }
        envs = self._envs(rules_arguments)
        rules = HpcuPolicy(envs)
        return drive(envs, self._seeds, lambda *_: rules())

    def of_policy(self, decide: Decide, *, masked: bool) -> Driven:
        """Drives a policy."""
        return drive(self._envs(self._policy_arguments), self._seeds, decide, masked=masked)

    def _envs(self, arguments: dict[str, Any]) -> EVHeatPumpVectorEnv:
        return EVHeatPumpVectorEnv(len(self._seeds), **self._trip_arguments, **arguments)


def drive(envs: EVHeatPumpVectorEnv, seeds: Sequence[int], decide: Decide, *, masked: bool = False) -> Driven:
    """Drives the first trip of each environment to its end, then closes them.

    Args:
        envs: Environments, one a seed.
        seeds: Seeds of the trips.
        decide: Who drives.
        masked: Whether it is told what the plant would grant.
    """
    observations, _ = envs.reset(seed=list(seeds))
    trips = range(len(seeds))
    ambient_degc = [envs.signals(index)["ambient_temperature_degc"] for index in trips]
    ends: list[dict[str, float]] = [{} for _ in trips]
    under_way = np.ones(len(ends), dtype=np.bool_)
    while under_way.any():
        masks = envs.action_masks() if masked else None
        observations, _, terminated, _, _ = envs.step(decide(observations, masks))
        # Environments whose trip has ended begin another one, which is not counted.
        for trip in envs.finished:
            if under_way[trip.index]:
                arrived = float(trip.end_reason == "arrived")
                figures = {name: trip.summary[name] for name in FIGURES}
                ends[trip.index] = {**trip.kpis, **figures, "arrived": arrived}
        under_way &= ~terminated
    envs.close()
    values = {name: np.array([end[name] for end in ends]) for name in {*_OF_THE_END, *FIGURES}}
    comfort = TripComfort.of(values, 1.0 - values["arrived"])
    of_the_end = {name: values[name] for name in _OF_THE_END}
    return Driven(ambient_degc=np.array(ambient_degc), **of_the_end, comfort=comfort)


_OF_THE_END = ("duration_s", "score", "attributable_energy_kwh", "discomfort_k", "arrived")
