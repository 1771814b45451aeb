"""The rule-based heat pump control unit as an agent."""

from typing import Any, Final

import gymnasium as gym
import numpy as np
from gymnasium.vector import VectorEnv

from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.settings import Action
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv


class HpcuPolicy:
    """Plays an environment by the rules of Jeffs et al. 2019, through the same actions as any agent.

    It reads the plant as a real controller does, not the observation. With the actions `HpcuPolicy.ACTIONS`
    and `continuous=True` it drives exactly what `hp_gym.simulate` does; with levels it takes the nearest, and
    with other actions it moves those that there are.

    Args:
        env: An `EVHeatPump-v0`, wrapped or not, single or vector.

    Raises:
        TypeError: It is another environment.
    """

    ACTIONS: Final = "hpcu"

    def __init__(self, env: gym.Env[Any, Any] | VectorEnv[Any, Any, Any]) -> None:
        inner = env.unwrapped
        if not isinstance(inner, EVHeatPumpEnv | EVHeatPumpVectorEnv):
            message = f"env is {env!r}, but must be an EVHeatPump-v0"
            raise TypeError(message)
        self._env = inner

    def __call__(self, observation: object = None) -> Action:  # noqa: ARG002
        """Returns the next action, whatever the observation."""
        if isinstance(self._env, EVHeatPumpVectorEnv):
            return self._env.rule_based_actions()
        return self._env.rule_based_action()

    def predict(
        self,
        observation: object,
        state: tuple[np.ndarray, ...] | None = None,
        episode_start: object = None,  # noqa: ARG002
        deterministic: bool = True,  # noqa: ARG002
    ) -> tuple[Action, tuple[np.ndarray, ...] | None]:
        """Returns the next action as models of stable-baselines3 do."""
        return self(observation), state
