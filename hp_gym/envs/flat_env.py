"""Environments with one choice among modes: `EVHeatPumpFlat-v0`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gymnasium.vector.utils import batch_space

from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.modes import Modes
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hp_gym.envs.modes import Mode


class EVHeatPumpFlatEnv(EVHeatPumpEnv):
    """An `EVHeatPumpEnv` whose action is the number of a mode, `Discrete`.

    Args:
        modes: What can be chosen, options by the names of actions; by default those of `MODES` that the
            vehicle can do.
        **chosen: Arguments of `EVHeatPumpEnv`; `actions` is `"heat"` here unless it is given, so that the
            rule-based controller moves the cabin's air.

    Raises:
        ConfigurationError: The environment is continuous, or a mode names what the vehicle lacks.
    """

    def __init__(self, *, modes: Sequence[Mode] | None = None, **chosen: Any) -> None:
        super().__init__(**{"actions": "heat", **chosen})
        self._modes = Modes(modes, self.option_names, self._episode.option_counts())
        self.modes = self._modes.modes
        self.action_space = self._modes.space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins a trip; see `EVHeatPumpEnv.reset`."""
        observation, info = super().reset(seed=seed, options=options)
        return observation, self._of_modes(info)

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Drives on for one control interval in a mode.

        Raises:
            ValueError: There is no such mode.
            TypeError: It is no whole number.
            ResetNeeded: No trip has begun, or it has ended.
        """
        observation, reward, terminated, truncated, info = super().step(self._modes.actions(action, ()))
        return observation, reward, terminated, truncated, self._of_modes(info)

    def action_masks(self) -> NDArray[np.bool_]:
        """Marks the modes of which the plant would grant every connection."""
        return self._modes.masks(super().action_masks())

    def rule_based_action(self) -> Any:
        """Returns the mode that is nearest to what the rule-based controller would do next."""
        return self._modes.nearest(super().rule_based_action())

    def _of_modes(self, info: dict[str, Any]) -> dict[str, Any]:
        if "action_mask" in info:
            info["action_mask"] = self._modes.masks(info["action_mask"])
        return info


class EVHeatPumpFlatVectorEnv(EVHeatPumpVectorEnv):
    """As many `EVHeatPumpFlatEnv` as asked for, stepped together.

    Args:
        num_envs: Number of environments.
        modes: As in `EVHeatPumpFlatEnv`.
        **chosen: Arguments of `EVHeatPumpVectorEnv`.

    Raises:
        ConfigurationError: The environments are continuous, or a mode names what the vehicles lack.
    """

    def __init__(self, num_envs: int = 1, *, modes: Sequence[Mode] | None = None, **chosen: Any) -> None:
        super().__init__(num_envs, **{"actions": "heat", **chosen})
        self._modes = Modes(modes, self.option_names, self._core.option_counts())
        self.modes = self._modes.modes
        self.single_action_space = self._modes.space
        self.action_space = batch_space(self.single_action_space, self.num_envs)

    def step(
        self, actions: Any
    ) -> tuple[
        NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]
    ]:
        """Drives all environments on for one control interval; errors as in `EVHeatPumpFlatEnv`."""
        return super().step(self._modes.actions(actions, (self.num_envs,)))

    def action_masks(self) -> NDArray[np.bool_]:
        """Marks the modes of which the plant would grant every connection, one row an environment."""
        return self._options(super().action_masks())

    def rule_based_actions(self) -> Any:
        """Returns the modes that are nearest to what the rule-based controllers would do next."""
        return self._modes.nearest(super().rule_based_actions())

    def _options(self, masks: NDArray[Any]) -> NDArray[Any]:
        return self._modes.masks(masks)
