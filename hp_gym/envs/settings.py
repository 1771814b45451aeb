"""What an environment is made with, checked once for the single and the vector environment."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.command import ACTUATORS
from hp_gym.overrides import Overrides, Value, assignments

Action: TypeAlias = NDArray[np.int64] | NDArray[np.float32]
Name: TypeAlias = str | os.PathLike[str]

DEFAULT_DISTRIBUTION: Final = "train-v1"

HPCU_ACTIONS: Final = (
    *ACTUATORS[:8],
    "recirculation",
    "battery_request",
    "ambient_request",
    "cabin_request",
)
"""Actuators that the rule-based controller moves; it leaves the others as the environment sets them."""

ACTION_SETS: Final[Mapping[str, tuple[str, ...]]] = {
    "default": ACTUATORS[:8],
    "hpcu": HPCU_ACTIONS,
    "all": ACTUATORS,
}
"""Sets of actuators by name."""


@dataclass(frozen=True)
class Settings:
    """Settings of an environment; see `EVHeatPumpEnv` for their meaning."""

    continuous: bool = False
    actions: str | Sequence[str] = "default"
    observations: str | Sequence[str] = ("default",)
    reward: Name | Mapping[str, Value] = "balanced"
    control_interval_s: int = 1
    sensor_noise: float = 0.0
    overrides: Overrides | None = None

    @property
    def action_names(self) -> tuple[str, ...]:
        """Actuators that the agent controls, in the order of an action."""
        return tuple(_actions(self.actions))

    def to_json(self) -> str:
        """Returns the settings as the core reads them.

        Raises:
            ConfigurationError: There is no such set of actions.
            TypeError: A setting is of a type that cannot be read.
        """
        if not math.isfinite(self.sensor_noise):
            message = f"sensor_noise is {self.sensor_noise}, but must be between 0 and 1"
            raise _core.ConfigurationError(message)
        reward, changes = _reward(self.reward)
        settings = {
            "continuous": self.continuous,
            "actions": list(self.action_names),
            "observations": _names("observations", self.observations),
            "reward": reward,
            "reward_overrides": changes,
            "overrides": assignments(self.overrides),
            "control_interval_s": self.control_interval_s,
            "sensor_noise": self.sensor_noise,
        }
        return json.dumps(settings, default=_plain)


def _plain(value: object) -> object:
    if isinstance(value, np.generic):
        return value.item()
    message = f"a setting is of type {type(value).__name__}: {value!r}"
    raise TypeError(message)


def _names(what: str, names: str | Sequence[str]) -> list[str]:
    if isinstance(names, str):
        return [names]
    try:
        return [str(name) for name in names]
    except TypeError:
        message = f"{what} is {names!r}, but must be a name or a list of names"
        raise TypeError(message) from None


def _actions(actions: str | Sequence[str]) -> list[str]:
    if not isinstance(actions, str):
        return _names("actions", actions)
    if actions not in ACTION_SETS:
        message = (
            f"unknown set of actions `{actions}`; available: {', '.join(ACTION_SETS)}, or a list of names"
        )
        raise _core.ConfigurationError(message)
    return list(ACTION_SETS[actions])


def _reward(reward: Name | Mapping[str, Value]) -> tuple[str, list[str]]:
    if not isinstance(reward, Mapping):
        return os.fspath(reward), []
    changes = dict(reward)
    base = changes.pop("base", "balanced")
    if not isinstance(base, str):
        message = f"reward `base` is {base!r}, but must be the name or path of a reward"
        raise TypeError(message)
    return base, assignments(changes)


def source(scenario: Name | None, distribution: Name | None) -> tuple[str | None, str | None]:
    """Returns the scenario or the distribution that trips come from.

    Raises:
        ConfigurationError: Both are given.
        TypeError: One is no name.
    """
    if scenario is not None and distribution is not None:
        message = f"scenario is {scenario!r} and distribution is {distribution!r}, but only one may be given"
        raise _core.ConfigurationError(message)
    if scenario is not None:
        return os.fspath(scenario), None
    return None, os.fspath(distribution) if distribution is not None else None


def once(options: Mapping[str, Any] | None, extra: Sequence[str] = ()) -> tuple[Any, Any]:
    """Returns scenario and distribution of the options of a reset.

    Raises:
        ConfigurationError: There is no such option.
    """
    options = options or {}
    known = ("scenario", "distribution", *extra)
    for key in options:
        if key not in known:
            message = f"unknown reset option `{key}`; available: {', '.join(known)}"
            raise _core.ConfigurationError(message)
    return options.get("scenario"), options.get("distribution")


def action_space(episode: _core.Episode, settings: Settings) -> spaces.Space[Any]:
    """Returns the space of one action."""
    counts = episode.option_counts()
    if counts:
        return spaces.MultiDiscrete(np.array(counts, dtype=np.int64))
    length = len(settings.action_names)
    return spaces.Box(-1.0, 1.0, (length,), np.float32)


def observation_space(episode: _core.Episode) -> spaces.Box[np.float32]:
    """Returns the space of one observation."""
    # Gymnasium 1.2 has no generic Box.
    box: spaces.Box[np.float32] = spaces.Box(-1.0, 1.0, (len(episode.observation_rows()),), np.float32)
    return box


def core_seed(seed: int) -> int:
    """Returns the seed of the core for a seed of any size."""
    return seed % 2**64
