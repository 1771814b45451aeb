"""One choice among modes instead of one for each component, for algorithms that know no other."""

import operator
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, Final, TypeAlias

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


class Modes:
    """Modes of an environment with levels, as numbers.

    Args:
        modes: What can be chosen; None for those of `MODES` that the environment has all options of.
        options: Options of each action by its name; none for levels.
        counts: Number of options of each action.

    Raises:
        ConfigurationError: A mode names an action or option that is not there, or there are fewer than two.
    """

    def __init__(
        self,
        modes: Sequence[Mode] | None,
        options: Mapping[str, Sequence[str]],
        counts: Sequence[int],
    ) -> None:
        if not counts:
            message = "continuous is True, but modes choose among options (continuous=False)"
            raise _core.ConfigurationError(message)
        if modes is None:
            modes = [mode for mode in MODES if _fits(mode, options)]
            if len(modes) < 2:
                message = (
                    "modes is None, but the vehicle has the options of hardly any of the default modes; give "
                    f"a list of modes, options by the names of actions: {', '.join(options)}"
                )
                raise _core.ConfigurationError(message)
        if len(modes) < 2:
            message = f"modes is {modes!r}, but must be a list of at least two modes"
            raise _core.ConfigurationError(message)
        self.modes = tuple(dict(mode) for mode in modes)
        self._counts = np.asarray(counts)
        self._actions = np.array([_action(mode, options, self._counts) for mode in self.modes])
        self._starts = np.concatenate([[0], np.cumsum(self._counts)[:-1]])
        # Choices either agree or not; levels can be near.
        self._spans = np.array(
            [1 if chosen else count - 1 for chosen, count in zip(options.values(), counts, strict=True)]
        )
        self.space = spaces.Discrete(len(self.modes))

    def actions(self, chosen: Any, shape: tuple[int, ...]) -> NDArray[np.int64]:
        """Returns the choice for each component.

        Args:
            chosen: Numbers of modes.
            shape: Shape that they must have; () for one environment.

        Raises:
            ValueError: They have the wrong shape, or there is no such mode.
            TypeError: They are no whole numbers.
        """
        numbers = np.asarray(chosen)
        if numbers.dtype.kind not in "iu":
            message = f"action is {chosen!r}, but must be a whole number: a mode"
            raise TypeError(message)
        if numbers.shape != shape:
            message = f"action has the shape {numbers.shape}, but must have {shape}: modes"
            raise ValueError(message)
        wrong = (numbers < 0) | (numbers >= len(self.modes))
        if wrong.any():
            message = (
                f"action is {numbers[wrong].flat[0]}, but must be a mode from 0 to {len(self.modes) - 1}"
            )
            raise ValueError(message)
        actions: NDArray[np.int64] = self._actions[numbers]
        return actions

    def masks(self, masks: NDArray[Any]) -> NDArray[Any]:
        """Marks the modes of which all options are marked.

        Args:
            masks: Options action by action, one row an environment if there are many.
        """
        return np.asarray(masks[..., self._starts + self._actions].all(axis=-1), dtype=masks.dtype)

    def nearest(self, actions: NDArray[Any]) -> NDArray[np.int64]:
        """Returns the modes that differ least from choices for each component."""
        apart = np.abs(actions[..., None, :] - self._actions) / self._spans
        nearest: NDArray[np.int64] = np.minimum(apart, 1.0).sum(axis=-1).argmin(axis=-1)
        return nearest


def _fits(mode: Mode, options: Mapping[str, Sequence[str]]) -> bool:
    return all(
        name in options and (not isinstance(chosen, str) or chosen in options[name])
        for name, chosen in mode.items()
    )


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
        elif _is_level(chosen, counts[row]):
            action[row] = int(chosen)
        else:
            allowed = ", ".join(options[name]) or f"a level from 0 to {counts[row] - 1}"
            message = f"mode {dict(mode)}: `{name}` is {chosen!r}, but must be one of: {allowed}"
            raise _core.ConfigurationError(message)
    return action


def _is_level(chosen: object, count: int) -> bool:
    try:
        return 0 <= operator.index(chosen) < count  # type: ignore[arg-type]
    except TypeError:
        return False
