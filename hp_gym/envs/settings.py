"""What an environment is made with, checked once for the single and the vector environment."""

from __future__ import annotations

import json
import logging
import math
import operator
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, Protocol, TypeAlias, TypedDict, Unpack

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.envs.rewards import Reward  # noqa: TC001, read by `get_type_hints`
from hp_gym.overrides import Overrides, Value, assignments

Action: TypeAlias = NDArray[np.int64] | NDArray[np.float32]
Name: TypeAlias = str | os.PathLike[str]

DEFAULT_DISTRIBUTION: Final = "train-v2"

PARTS: Final = tuple(_core.reward_parts())
"""Names of the parts of a reward, in points."""

TERMS: Final = tuple(_core.reward_terms())
"""Names of what they are counted from, in physical units."""

ACTION_GROUPS: Final[Mapping[str, tuple[str, ...]]] = {
    group: tuple(names) for group, names in _core.action_groups()
}
"""Actuators of the default architecture by the groups that an environment knows: `default`, `hpcu` (those
that the rule-based controller moves; it leaves the others as the environment sets them), `all`."""


INFO: Final = ("cost", "action_mask", "terms")
"""What infos can hold beside the parts of the reward."""


class SharedKeywords(TypedDict, total=False):
    """Settings that environments of a vector share; see `EVHeatPumpEnv` for their meaning.

    Each is a field of the core's settings too, which knows its default and what it accepts.
    """

    continuous: bool
    actions: str | Sequence[str]
    action_options: Mapping[str, Sequence[str]] | None
    observations: str | Sequence[str]
    observation_bounds: Mapping[str, tuple[float, float]] | None
    info: str | Sequence[str]
    reward: Name | Mapping[str, Value] | Reward
    control_interval_s: int
    sensor_noise: float
    overrides: Overrides | None


class Keywords(SharedKeywords, total=False):
    """Settings of an environment."""

    vehicle: Name | None


_LOG: Final = logging.getLogger(__name__)

_TOLD: Final[set[tuple[str, str]]] = set()

NAMES: Final = ("vehicle", *SharedKeywords.__annotations__)
"""Names of all settings."""


def to_json(**chosen: Unpack[Keywords]) -> str:
    """Returns settings as the core reads them; what is not given has the core's default.

    Raises:
        ConfigurationError: There is no such set of actions.
        TypeError: There is no such setting, or it is of a type that cannot be read.
    """
    settings: dict[str, Any] = {}
    info = told(chosen)
    if callable(chosen.get("reward")) and "terms" not in info:
        info = (*info, "terms")
    for name, value in chosen.items():
        if name not in NAMES:
            # In Python's words: libraries that try arguments, as TorchRL does, look for them.
            message = f"got an unexpected keyword argument '{name}'; there are {', '.join(NAMES)}"
            raise TypeError(message)
        read = _READERS.get(name)
        settings.update({name: value} if read is None else read(value))
    settings["info"] = info
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


def _observation_bounds(bounds: Mapping[str, tuple[float, float]] | None) -> dict[str, Any]:
    pairs: dict[str, tuple[float, float]] = {}
    try:
        rows = dict(bounds or {})
    except (TypeError, ValueError):
        message = f"observation_bounds is {bounds!r}, but must be a mapping of rows to (low, high)"
        raise _core.ConfigurationError(message) from None
    for name, pair in rows.items():
        try:
            low, high = (float(end) for end in pair)
        except (TypeError, ValueError):
            message = f"observation_bounds of `{name}` is {pair!r}, but must be two numbers, the lower first"
            raise _core.ConfigurationError(message) from None
        # JSON has no other numbers.
        if not (math.isfinite(low) and math.isfinite(high)):
            message = f"observation_bounds of `{name}` is {pair!r}, but must be finite"
            raise _core.ConfigurationError(message)
        pairs[name] = (low, high)
    return {"observation_bounds": pairs}


def told(chosen: Mapping[str, Any]) -> tuple[str, ...]:
    """Returns what infos hold beside the parts of the reward: the setting `info`, checked.

    Raises:
        ConfigurationError: There is no such thing to tell.
    """
    names = _names("info", chosen.get("info", ()))
    for name in names:
        if name not in INFO:
            message = f"unknown info `{name}`; available: {', '.join(INFO)}"
            raise _core.ConfigurationError(message)
    return tuple(names)


def _reward(reward: Name | Mapping[str, Value] | Reward) -> dict[str, Any]:
    if callable(reward):
        # Parts and KPIs are counted with the default weights, terms with none.
        return {}
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
    "observation_bounds": _observation_bounds,
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
    def narrow_rows(self) -> list[tuple[str, str, float, float]]: ...


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


def tell_of_narrow_rows(core: _Rows) -> None:
    """Logs rows whose bounds a vehicle can leave, each once a process."""
    for vehicle, row, high, limit in core.narrow_rows():
        if (vehicle, row) not in _TOLD:
            _TOLD.add((vehicle, row))
            _LOG.warning(
                "vehicle `%s` can reach %s = %g, but observations end at %g: give "
                "observation_bounds={%r: (low, high)}",
                vehicle,
                row,
                limit,
                high,
                row,
            )


def option_names(core: _Rows) -> dict[str, tuple[str, ...]]:
    """Returns the options of each action by its name, in the order of an action; none for levels."""
    return {name: tuple(options) for name, _, options, _ in core.action_rows()}


def whole_seed(seed: object) -> int:
    """Returns a seed of any type of integer as an `int`.

    Raises:
        TypeError: It is no integer.
        ValueError: It is negative.
    """
    try:
        number = operator.index(seed)  # type: ignore[arg-type]
    except TypeError:
        message = f"seed is {seed!r}, but must be a whole number"
        raise TypeError(message) from None
    if number < 0:
        message = f"seed is {number}, but must not be negative"
        raise ValueError(message)
    return number


def core_seed(seed: object) -> int:
    """Returns the seed of the core for a seed of any type and size.

    Raises:
        TypeError: It is no integer.
        ValueError: It is negative.
    """
    return whole_seed(seed) % 2**64


def decode(core: _Rows, observations: NDArray[np.float32]) -> dict[str, NDArray[np.float64]]:
    """Returns observations in the units of their rows, by name.

    Raises:
        ValueError: They have the wrong shape.
    """
    rows = core.observation_rows()
    observations = np.asarray(observations)
    if observations.shape[-1:] != (len(rows),):
        message = f"observations have the shape {observations.shape}, but must end with {len(rows)} rows"
        raise ValueError(message)
    low = np.array([row[2] for row in rows])
    high = np.array([row[3] for row in rows])
    values = low + 0.5 * (observations.astype(np.float64) + 1.0) * (high - low)
    return {row[0]: values[..., place] for place, row in enumerate(rows)}
