"""What is measured: each measurement is a function without arguments that takes a fraction of a second."""

from __future__ import annotations

from itertools import count
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

import gymnasium as gym

import hp_gym
from hp_gym import _core

if TYPE_CHECKING:
    from collections.abc import Callable

    from gymnasium.vector import VectorEnv

OURS: Final = "EVHeatPump-v0"
OTHERS: Final = "CartPole-v1"

_SAMPLES: Final = 20
"""Different random actions; drawing them does not count."""

_MICROSECONDS: Final = 1e6


def plant_step_us(*, random: bool) -> float:
    """Returns the mean time of a plant step [us] over the paper's nine scenarios, compressor on, one core.

    Args:
        random: Random actions; otherwise the HPCU drives, and its own time counts.
    """
    scenarios = [name for name in hp_gym.names("scenario") if name.startswith("jeffs2019/")]
    spent_s, steps = 0.0, 0
    for seed, scenario in enumerate(scenarios):
        more_s, more = _core.plant_step_seconds(scenario, seed if random else None)
        spent_s, steps = spent_s + more_s, steps + more
    return _MICROSECONDS * spent_s / steps


def single(env_id: str, seconds: float) -> Callable[[], float]:
    """Returns a measurement of one environment through `gym.make` with random actions [steps/s]."""
    env: gym.Env[Any, Any] = gym.make(env_id)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(1000)]
    env.reset(seed=0)

    def measure() -> float:
        steps, start_s = 0, perf_counter()
        while (passed_s := perf_counter() - start_s) < seconds:
            for action in actions:
                _, _, terminated, truncated, _ = env.step(action)
                if terminated or truncated:
                    env.reset()
            steps += len(actions)
        return steps / passed_s

    return measure


def vector(env_id: str, environments: int, seconds: float, **kwargs: Any) -> Callable[[], float]:
    """Returns a measurement of a vector environment with random actions [steps/s]."""
    envs: VectorEnv[Any, Any, Any] = gym.make_vec(
        env_id, num_envs=environments, vectorization_mode="vector_entry_point", **kwargs
    )
    envs.action_space.seed(0)
    actions = [envs.action_space.sample() for _ in range(_SAMPLES)]
    envs.reset(seed=0)
    # So many calls between two looks at the clock that it costs nothing.
    calls = max(1, 256 // environments)

    def measure() -> float:
        envs.step(actions[0])
        start_s = perf_counter()
        for call in count(1):
            envs.step(actions[call % _SAMPLES])
            if call % calls == 0 and (passed_s := perf_counter() - start_s) >= seconds:
                return call * environments / passed_s
        raise AssertionError

    return measure
