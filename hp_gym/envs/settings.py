"""What an environment is made with, checked once for the single and the vector environment."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, Protocol, TypeAlias, TypedDict, Unpack

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.overrides import Overrides, Value, assignments

Action: TypeAlias = NDArray[np.int64] | NDArray[np.float32]
Name: TypeAlias = str | os.PathLike[str]

DEFAULT_DISTRIBUTION: Final = "train-v1"

ACTION_GROUPS: Final[Mapping[str, tuple[str, ...]]] = {
    group: tuple(names) for group, names in _core.action_groups()
}
"""Actuators of the default architecture by the groups that an environment knows: `default`, `hpcu` (those
that the rule-based controller moves; it leaves the others as the environment sets them), `all`."""


class SharedKeywords(TypedDict, total=False):
    """Settings that environments of a vector share; see `EVHeatPumpEnv` for their meaning.

    Each is a field of the core's settings too, which knows its default and what it accepts.
    """

    continuous: bool
    actions: str | Sequence[str]
    action_options: Mapping[str, Sequence[str]] | None
    observations: str | Sequence[str]
    reward: Name | Mapping[str, Value]
    control_interval_s: int
    sensor_noise: float
    overrides: Overrides | None


class Keywords(SharedKeywords, total=False):
    """Settings of an environment."""

    vehicle: Name | None


NAMES: Final = ("vehicle", *SharedKeywords.__annotations__)
"""Names of all settings."""


def to_json(**chosen: Unpack[Keywords]) -> str:
    """Returns settings as the core reads them; what is not given has the core's default.

    Raises:
        ConfigurationError: There is no such set of actions.
        TypeError: There is no such setting, or it is of a type that cannot be read.
    """
    settings: dict[str, Any] = {}
    for name, value in chosen.items():
        if name not in NAMES:
            message = f"there is no setting `{name}`; there are {', '.join(NAMES)}"
            raise TypeError(message)
        read = _READERS.get(name)
        settings.update({name: value} if read is None else read(value))
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


def _actions(actions: str | Sequence[str]) -> dict[str, Any]:
    if isinstance(actions, str) and actions not in ACTION_GROUPS:
        message = (
            f"unknown set of actions `{actions}`; available: {', '.join(ACTION_GROUPS)}, or a list of names"
        )
        raise _core.ConfigurationError(message)
    return {"actions": _names("actions", actions)}


def _action_options(options: Mapping[str, Sequence[str]] | None) -> dict[str, Any]:
    return {"action_options": {name: list(chosen) for name, chosen in (options or {}).items()}}


def _reward(reward: Name | Mapping[str, Value]) -> dict[str, Any]:
    if not isinstance(reward, Mapping):
        return {"reward": os.fspath(reward)}
    changes = dict(reward)
    base = changes.pop("base", "balanced")
    if not isinstance(base, str):
        message = f"reward `base` is {base!r}, but must be the name or path of a reward"
        raise TypeError(message)
    return {"reward": base, "reward_overrides": assignments(changes)}


def _sensor_noise(strength: float) -> dict[str, Any]:
    # JSON has no such numbers.
    if not math.isfinite(strength):
        message = f"sensor_noise is {strength}, but must be between 0 and 1"
        raise _core.ConfigurationError(message)
    return {"sensor_noise": strength}


_READERS: Final[Mapping[str, Callable[[Any], dict[str, Any]]]] = {
    "vehicle": lambda name: {"vehicle": None if name is None else os.fspath(name)},
    "actions": _actions,
    "action_options": _action_options,
    "observations": lambda names: {"observations": _names("observations", names)},
    "reward": _reward,
    "sensor_noise": _sensor_noise,
    "overrides": lambda changes: {"overrides": assignments(changes)},
}
"""Settings that the core reads in another form than they are given."""


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


class _Rows(Protocol):
    """An environment of the core, single or vector."""

    def option_counts(self) -> list[int]: ...
    def action_rows(self) -> list[tuple[str, str, list[str], str]]: ...
    def observation_rows(self) -> list[tuple[str, str, float, float, str]]: ...


def action_space(core: _Rows) -> spaces.Space[Any]:
    """Returns the space of one action."""
    counts = core.option_counts()
    if counts:
        return spaces.MultiDiscrete(np.array(counts, dtype=np.int64))
    return spaces.Box(-1.0, 1.0, (len(core.action_rows()),), np.float32)


def observation_space(core: _Rows) -> spaces.Box[np.float32]:
    """Returns the space of one observation."""
    # Gymnasium 1.2 has no generic Box.
    box: spaces.Box[np.float32] = spaces.Box(-1.0, 1.0, (len(core.observation_rows()),), np.float32)
    return box


def option_names(core: _Rows) -> dict[str, tuple[str, ...]]:
    """Returns the options of each action by its name, in the order of an action; none for levels."""
    return {name: tuple(options) for name, _, options, _ in core.action_rows()}


def core_seed(seed: int) -> int:
    """Returns the seed of the core for a seed of any size."""
    return seed % 2**64
