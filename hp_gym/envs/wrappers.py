"""A flat list of actions for algorithms that know no other."""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, Final, TypeAlias

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from hp_gym import _core

Mode: TypeAlias = Mapping[str, str | int]
"""Options of actions by name or number; what is not named takes its first: isolated, off."""

_HEAT: Final[Mode] = {"cabin": "htc", "motor": "chiller"}
_COOL: Final[Mode] = {"cabin": "chiller", "ambient": "htc"}
_CIRCUITS: Final[tuple[Mode, ...]] = (
    {**_HEAT, "ambient": "chiller"},
    {**_HEAT, "ambient": "chiller", "transmission": "chiller"},
    {**_HEAT, "ambient": "chiller", "transmission": "chiller", "ptc": "allowed"},
    {**_HEAT, "ambient": "chiller", "transmission": "chiller", "battery": "htc", "ptc": "allowed"},
    {**_HEAT, "transmission": "chiller", "battery": "chiller", "ptc": "allowed"},
    {**_HEAT, "battery": "chiller"},
    {"ambient": "chiller", "motor": "chiller", "battery": "htc"},
    _COOL,
    {**_COOL, "battery": "chiller"},
    {"ambient": "htc", "battery": "chiller"},
)
_LEVELS: Final = (2, 5, 8, 10)

MODES: Final[tuple[Mode, ...]] = (
    {},
    {"cabin": "htc"},
    {"cabin": "htc", "ptc": "allowed"},
    {"cabin": "htc", "battery": "htc", "ptc": "allowed"},
    *({**circuit, "compressor_power": level} for circuit, level in product(_CIRCUITS, _LEVELS)),
)
"""All off; heat left in the HTC; PTC alone; and ten ways to use the heat pump at four levels each."""


class FlatActions(gym.ActionWrapper[NDArray[np.float32], np.int64, NDArray[np.int64]]):
    """One `Discrete` choice among modes instead of a choice for each component.

    Args:
        env: An `EVHeatPump-v0` with levels.
        modes: What can be chosen.

    Raises:
        ConfigurationError: The environment is continuous, or a mode names an action or option that it lacks.
    """

    def __init__(self, env: gym.Env[Any, Any], modes: Sequence[Mode] = MODES) -> None:
        super().__init__(env)
        inner: Any = env.unwrapped
        if not isinstance(env.action_space, spaces.MultiDiscrete):
            message = f"the action space is {env.action_space}, but must be MultiDiscrete (continuous=False)"
            raise _core.ConfigurationError(message)
        options: Mapping[str, Sequence[str]] = inner.option_names
        self.modes = tuple(modes)
        self._actions = np.array([_action(mode, options, env.action_space.nvec) for mode in self.modes])
        self._starts = np.concatenate([[0], np.cumsum(env.action_space.nvec)[:-1]])
        self.action_space = spaces.Discrete(len(self.modes))

    def action(self, action: np.int64) -> NDArray[np.int64]:
        """Returns the choice for each component.

        Raises:
            ValueError: There is no such mode.
        """
        if not self.action_space.contains(action):
            message = f"action is {action!r}, but must be a whole number from 0 to {len(self.modes) - 1}"
            raise ValueError(message)
        chosen: NDArray[np.int64] = self._actions[action].copy()
        return chosen

    def action_masks(self) -> NDArray[np.bool_]:
        """Marks the modes of which the plant would grant every connection."""
        masks: NDArray[np.bool_] = self.env.get_wrapper_attr("action_masks")()
        granted: NDArray[np.bool_] = masks[self._starts + self._actions].all(axis=1)
        return granted


def _action(mode: Mode, options: Mapping[str, Sequence[str]], counts: NDArray[np.int64]) -> list[int]:
    names = list(options)
    action = [0] * len(names)
    for name, chosen in mode.items():
        if name not in names:
            message = f"mode {dict(mode)}: unknown action `{name}`; available: {', '.join(names)}"
            raise _core.ConfigurationError(message)
        row = names.index(name)
        if isinstance(chosen, str) and chosen in options[name]:
            action[row] = options[name].index(chosen)
        elif isinstance(chosen, int) and 0 <= chosen < counts[row]:
            action[row] = chosen
        else:
            allowed = ", ".join(options[name]) or f"a level from 0 to {counts[row] - 1}"
            message = f"mode {dict(mode)}: `{name}` is {chosen!r}, but must be one of: {allowed}"
            raise _core.ConfigurationError(message)
    return action
