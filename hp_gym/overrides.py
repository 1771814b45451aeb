"""Changes of single configuration values."""

import json
from collections.abc import Mapping, Sequence
from numbers import Integral, Real
from typing import TypeAlias

Value: TypeAlias = bool | float | str | Sequence["Value"] | Mapping[str, "Value"]
"""What a configuration file can hold."""

Overrides: TypeAlias = Mapping[str, Value] | Sequence[str]
"""Changes by dotted key, or assignments as on the command line (`key=value`)."""


def assignments(overrides: Overrides | None) -> list[str]:
    """Returns overrides as `key=value` with the value in TOML.

    Raises:
        TypeError: A value is of a type that TOML does not have.
    """
    if overrides is None:
        return []
    if isinstance(overrides, str):
        message = f"overrides is the text {overrides!r}, but must be a mapping or a list of key=value"
        raise TypeError(message)
    if isinstance(overrides, Mapping):
        return [f"{key}={_toml(key, value)}" for key, value in overrides.items()]
    return list(overrides)


def _toml(key: str, value: object) -> str:
    match value:
        case bool():
            return "true" if value else "false"
        case Integral():
            return str(int(value))
        case Real():
            return repr(float(value))
        case str():
            return json.dumps(value)
        case Mapping():
            return "{" + ", ".join(f"{json.dumps(k)} = {_toml(key, v)}" for k, v in value.items()) + "}"
        case Sequence():
            return "[" + ", ".join(_toml(key, item) for item in value) + "]"
    message = f"override `{key}` is of type {type(value).__name__}, but must be a bool, number, text or list"
    raise TypeError(message)
