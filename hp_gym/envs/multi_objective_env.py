"""Environments whose reward is a vector: `EVHeatPumpMO-v0`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from gymnasium import spaces

from hp_gym import _core
from hp_gym.envs import settings
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

if TYPE_CHECKING:
    from numpy.typing import NDArray

OBJECTIVES: Final = settings.PARTS
"""What the entries of a reward are, in points; their sum is the reward of `EVHeatPump-v0`."""


def _reward_space() -> spaces.Box[np.float64]:
    space: spaces.Box[np.float64] = spaces.Box(-np.inf, np.inf, (len(OBJECTIVES),), np.float64)
    return space


def _refuse_function(chosen: dict[str, Any]) -> None:
    if callable(chosen.get("reward")):
        message = (
            "reward is a function, but must be a name, a path or weights: here it is the vector of its parts"
        )
        raise _core.ConfigurationError(message)


class EVHeatPumpMOEnv(EVHeatPumpEnv):
    """An `EVHeatPumpEnv` whose reward holds the four parts of `OBJECTIVES`, as MO-Gymnasium wants it.

    Args:
        **chosen: Arguments of `EVHeatPumpEnv`; `reward` weighs the parts.

    Attributes:
        reward_space: Space of a reward.

    Raises:
        ConfigurationError: The reward is a function.
    """

    def __init__(self, **chosen: Any) -> None:
        _refuse_function(chosen)
        super().__init__(**chosen)
        self.reward_space = _reward_space()

    # MO-Gymnasium's interface differs from Gymnasium's here, and here alone.
    def step(  # type: ignore[override]
        self, action: Any
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], bool, bool, dict[str, Any]]:
        """Drives on for one control interval; errors as in `EVHeatPumpEnv`."""
        observation, _, terminated, truncated, info = super().step(action)
        return observation, np.array([info[name] for name in OBJECTIVES]), terminated, truncated, info


class EVHeatPumpMOVectorEnv(EVHeatPumpVectorEnv):
    """As many `EVHeatPumpMOEnv` as asked for, stepped together; rewards are (num_envs, 4).

    Args:
        num_envs: Number of environments.
        **chosen: Arguments of `EVHeatPumpVectorEnv`; `reward` weighs the parts.

    Attributes:
        reward_space: Space of one environment's reward.

    Raises:
        ConfigurationError: The reward is a function.
    """

    def __init__(self, num_envs: int = 1, **chosen: Any) -> None:
        _refuse_function(chosen)
        super().__init__(num_envs, **chosen)
        self.reward_space = _reward_space()

    def step(
        self, actions: Any
    ) -> tuple[
        NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]
    ]:
        """Drives all environments on for one control interval; errors as in `EVHeatPumpVectorEnv`."""
        observations, _, terminated, truncated, infos = super().step(actions)
        paid = np.stack([infos[name] for name in OBJECTIVES], axis=1)
        # Of trips that were reset within the step the infos of the end tell.
        for trip in self.finished:
            paid[trip.index] = [trip.info[name] for name in OBJECTIVES]
        return observations, paid, terminated, truncated, infos
