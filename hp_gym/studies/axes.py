"""Axes: which values of a configuration vary, by key, and between what."""

import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeGuard

import numpy as np

from hp_gym import _core, toml_files
from hp_gym.key_units import unit_of
from hp_gym.messages import OneLineError
from hp_gym.near_names import suggestion, unknown
from hp_gym.overrides import Value, assignments

SELECTORS: Final = ("scenario", "controller", "vehicle")
"""Keys that choose a file by name or path instead of changing a value in one."""

ALIASES: Final = {
    "architecture": "vehicle.architecture",
    "climate": "scenario.climate",
    "cycle": "scenario.cycle",
    # A scenario that does not give it starts at its ambient temperature, so its file may not have the key.
    "soak_temperature_degc": "scenario.initial.soak_temperature_degc",
}
"""Short words for keys whose values are names or sections of values, or that a file may leave out."""

TOGETHER: Final = "+"
"""Between keys that share one value."""

_MOST_VALUES: Final = 1_000_000


class AxisError(OneLineError):
    """A key, a value or a range of an axis is not right."""


@dataclass(frozen=True)
class Between:
    """A range of numbers, for samples and searches.

    Attributes:
        low: Least value.
        high: Greatest value.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        """Checks the order.

        Raises:
            AxisError: `low` is not below `high`, or one is no finite number.
        """
        if not (np.isfinite(self.low) and np.isfinite(self.high) and self.low < self.high):
            message = f"a range from {self.low} to {self.high} must be of finite numbers, the lower one first"
            raise AxisError(message)


@dataclass(frozen=True)
class Axis:
    """A value that varies.

    Attributes:
        name: What it is called in tables: the last part of its first key, where no other axis has that.
        keys: Dotted keys that share the value, or one of `SELECTORS`.
        values: Its values, or its range.
    """

    name: str
    keys: tuple[str, ...]
    values: tuple[Value, ...] | Between

    @property
    def unit(self) -> str:
        """Unit that the key ends with; `-` where it has none."""
        return unit_of(self.keys[0])

    @property
    def numeric(self) -> bool:
        """Whether all values are numbers."""
        return isinstance(self.values, Between) or all(is_number(value) for value in self.values)

    def label(self, value: Value) -> float | str:
        """The value as it stands in a table: a number, or text."""
        if self.numeric:
            return float(value)  # type: ignore[arg-type]
        if isinstance(value, Mapping):
            return ", ".join(f"{key}={self._text(inner)}" for key, inner in value.items())
        return self._text(value)

    @staticmethod
    def _text(value: Value) -> str:
        return value if isinstance(value, str) else assignments({"value": value})[0].partition("=")[2]

    def at(self, share: float) -> Value:
        """The value at a place from 0 to 1; of a list, each value has an equal part."""
        if isinstance(self.values, Between):
            return self.values.low + share * (self.values.high - self.values.low)
        return self.values[min(int(share * len(self.values)), len(self.values) - 1)]

    def probes(self) -> tuple[Value, ...]:
        """Values that must be right for all to be: the ends of a range, each of a list."""
        if isinstance(self.values, Between):
            return (self.values.low, self.values.high)
        return self.values

    def changes(self, value: Value) -> dict[str, Value]:
        """Overrides, and choices by `SELECTORS`, that give the axis a value."""
        if isinstance(value, Mapping):
            return {f"{key}.{name}": inner for key in self.keys for name, inner in value.items()}
        return dict.fromkeys(self.keys, value)


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value of a file is a number; truth is none."""
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


@dataclass(frozen=True)
class Base:
    """What is driven where no axis says otherwise.

    Attributes:
        scenario: Name or path of a scenario.
        controller: Name or path of a controller; the scenario's own if None.
        vehicle: Name or path of a vehicle; the scenario's own if None.
        overrides: Changes for all runs, `key=value`.
        substeps: Steps of the plant in each second.
    """

    scenario: str
    controller: str | None = None
    vehicle: str | None = None
    overrides: tuple[str, ...] = ()
    substeps: int = 1

    def run(self, changes: Mapping[str, Value]) -> tuple[str, str | None, str | None, list[str]]:
        """Scenario, controller, vehicle and overrides of a run that differs by some changes."""
        chosen = {name: changes.get(name, getattr(self, name)) for name in SELECTORS}
        others = {key: value for key, value in changes.items() if key not in SELECTORS}
        names = [None if name is None else str(name) for name in chosen.values()]
        return str(names[0]), names[1], names[2], [*self.overrides, *assignments(others)]

    def load(self, changes: Mapping[str, Value]) -> _core.Experiment:
        """Loads a run that differs by some changes.

        Raises:
            ConfigurationError: The plant does not accept it.
        """
        scenario, controller, vehicle, overrides = self.run(changes)
        return _core.Experiment(scenario, controller, overrides, self.substeps, vehicle)

    def known_keys(self) -> list[str]:
        """Dotted keys of all values and sections in the files of the run."""
        return list(self.values())

    def values(self) -> dict[str, Any]:
        """What the files of the run say, by dotted key, sections included; overrides are not looked at."""
        experiment = self.load({})
        files = {
            "scenario": self.scenario,
            "controller": experiment.controller,
            "vehicle": experiment.vehicle,
        }
        found: dict[str, Any] = {}
        for kind, name in files.items():
            for _, table in toml_files.chain(kind, name):
                # What a file says stands before what its base does.
                found = dict(_entries(table, kind)) | found
        return found


def _entries(table: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        yield f"{prefix}.{name}", value
        if isinstance(value, Mapping):
            yield from _entries(value, f"{prefix}.{name}")


def axes_of(described: Mapping[str, Any], base: Base) -> tuple[Axis, ...]:
    """Makes axes of keys with their values, each checked against the files.

    Args:
        described: Values by key: a list, an array or a `Between`. A key is dotted, as for overrides, or the
            last parts of one where only one key ends so, or `scenario`, `controller`, `vehicle`,
            `architecture`, `cycle`, `climate`; several that share the value have a `+` between them.
        base: What is driven.

    Raises:
        AxisError: A key is unknown or appears twice, or it has no values.
        ConfigurationError: The base itself is not accepted.
    """
    if not described:
        message = "there is no axis: give at least one key with its values"
        raise AxisError(message)
    known = base.known_keys()
    found: dict[str, tuple[tuple[str, ...], Any]] = {}
    for given, values in described.items():
        keys = tuple(_resolved(part.strip(), known) for part in given.split(TOGETHER))
        found[given] = (keys, _checked_values(given, values))
    every = [key for keys, _ in found.values() for key in keys]
    for key in every:
        if every.count(key) > 1:
            message = f"axis `{key}` appears twice"
            raise AxisError(message)
    lasts = [keys[0].rpartition(".")[2] for keys, _ in found.values()]
    return tuple(
        Axis(last if lasts.count(last) == 1 else keys[0], keys, values)
        for last, (keys, values) in zip(lasts, found.values(), strict=True)
    )


def _checked_values(given: str, values: Any) -> tuple[Value, ...] | Between:
    if isinstance(values, Between):
        return values
    if isinstance(values, str) or not isinstance(values, Iterable):
        message = f"axis `{given}` is {values!r}, but must be a list of values or a range"
        raise AxisError(message)
    kept = tuple(value.item() if isinstance(value, np.generic) else value for value in values)
    if not 1 <= len(kept) <= _MOST_VALUES:
        message = f"axis `{given}` has {len(kept)} values, but must have between 1 and {_MOST_VALUES}"
        raise AxisError(message)
    texts = [repr(value) for value in kept]
    if len(set(texts)) < len(texts):
        twice = next(text for text in texts if texts.count(text) > 1)
        message = f"axis `{given}` has the value {twice} twice"
        raise AxisError(message)
    return kept


def _resolved(key: str, known: Sequence[str]) -> str:
    """The whole key of a short one.

    Raises:
        AxisError: There is none, or several end so.
    """
    if key in SELECTORS:
        return key
    key = ALIASES.get(key, key)
    if key.partition(".")[0] in SELECTORS:
        return key
    ends = [whole for whole in known if whole.endswith(f".{key.partition('[')[0]}")]
    if len(ends) == 1:
        return ends[0] + key[len(key.partition("[")[0]) :]
    if ends:
        message = f"axis `{key}` could be {' or '.join(f'`{end}`' for end in ends[:6])}: say which"
        raise AxisError(message)
    short = [whole.rpartition(".")[2] for whole in known]
    message = unknown("key for the axis", key, dict.fromkeys([*SELECTORS, *ALIASES, *short]))
    raise AxisError(message)


def require_accepted(axes: Sequence[Axis], base: Base) -> None:
    """Checks that the plant accepts every value of each axis, the others at their first or at their last.

    Raises:
        AxisError: It does not; the message names axis and value.
    """
    first: dict[str, Value] = {}
    last: dict[str, Value] = {}
    for axis in axes:
        first |= axis.changes(axis.probes()[0])
        last |= axis.changes(axis.probes()[-1])
    for axis in axes:
        for value in axis.probes():
            try:
                base.load(first | axis.changes(value))
            except _core.ConfigurationError as error:
                if _loads(base, last | axis.changes(value)):
                    continue
                # Not this axis but the others, which have their turn.
                if not _loads(base, axis.changes(value)) or len(axes) == 1:
                    hint = suggestion(axis.keys[0], base.known_keys()) if _is_unknown(axis, base) else ""
                    raise AxisError(f"axis `{axis.name}` at {axis.label(value)}: {error}{hint}") from error
                if axis is axes[-1]:
                    raise AxisError(f"axes {', '.join(a.name for a in axes)}: {error}") from error


def _loads(base: Base, changes: Mapping[str, Value]) -> bool:
    try:
        base.load(changes)
    except _core.ConfigurationError:
        return False
    return True


def _is_unknown(axis: Axis, base: Base) -> bool:
    known = {*SELECTORS, *base.known_keys()}
    return any(key.partition("[")[0] not in known for key in axis.keys)


def parse_axis(text: str) -> tuple[str, list[Value] | Between]:
    """Reads an axis of the command line.

    Args:
        text: `KEY=A,B,C`, `KEY=LOW:HIGH:STEP` or `KEY=LOW:HIGH/COUNT` (values), `KEY=LOW:HIGH` (a range).

    Raises:
        AxisError: It is none of these.
    """
    key, sign, values = text.partition("=")
    if not sign or not values.strip() or not key.strip():
        forms = "KEY=A,B,C or KEY=LOW:HIGH, KEY=LOW:HIGH:STEP, KEY=LOW:HIGH/COUNT"
        message = f"axis `{text}` must have the form {forms}"
        raise AxisError(message)
    span = _span(text, values.strip())
    return key.strip(), span if span is not None else _values(values)


def _span(text: str, values: str) -> list[Value] | Between | None:
    ends, slash, count = values.partition("/")
    try:
        numbers = [float(part) for part in ends.split(":")]
        points = int(count) if slash else None
    except ValueError:
        return None
    if len(numbers) == 2 and points is None:
        return Between(*numbers)
    if len(numbers) == 2 and points is not None and 2 <= points <= _MOST_VALUES:
        return [float(value) for value in np.linspace(numbers[0], numbers[1], points)]
    if len(numbers) == 3 and points is None:
        low, high, step = numbers
        if step != 0.0 and 0.0 <= (high - low) / step < _MOST_VALUES:
            steps = int((high - low) / step + 1e-9)
            # 0.1 three times is 0.3, not 0.30000000000000004.
            return [float(f"{low + number * step:.12g}") for number in range(steps + 1)]
    if len(numbers) == 1 and points is None:
        return None
    message = f"axis `{text}` is no grid: LOW:HIGH:STEP must come from LOW to HIGH, COUNT be at least 2"
    raise AxisError(message)


def _values(text: str) -> list[Value]:
    try:
        return list(tomllib.loads(f"values = [{text}]")["values"])
    except ValueError:
        return [_value(part.strip()) for part in text.split(",")]


def _value(text: str) -> Value:
    try:
        value: Value = tomllib.loads(f"value = {text}")["value"]
    except ValueError:
        return text
    return value
