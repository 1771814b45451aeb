"""Changes of single configuration values."""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from numbers import Integral, Real
from pathlib import Path
from typing import Any, TypeAlias

from hp_gym import toml_files

Value: TypeAlias = bool | float | str | Sequence["Value"] | Mapping[str, "Value"]
"""What a configuration file can hold."""

Overrides: TypeAlias = Mapping[str, Value] | Sequence[str] | os.PathLike[str]
"""Changes by dotted key, assignments as on the command line (`key=value`), or the path of a .toml file."""


def assignments(overrides: Overrides | None) -> list[str]:
    """Returns overrides as `key=value` with the value in TOML.

    Raises:
        TypeError: A value is of a type that TOML does not have.
        FileError: A file of overrides is no TOML.
        OSError: It cannot be read.
    """
    if overrides is None:
        return []
    if isinstance(overrides, os.PathLike) or (isinstance(overrides, str) and overrides.endswith(".toml")):
        return read(Path(overrides))
    if isinstance(overrides, str):
        message = (
            f"overrides is the text {overrides!r}, but must be a mapping, a list of key=value or a .toml file"
        )
        raise TypeError(message)
    if isinstance(overrides, Mapping):
        return [f"{key}={_toml(key, value)}" for key, value in overrides.items()]
    return list(overrides)


def read(path: Path) -> list[str]:
    """Reads a file of overrides: `"vehicle.body.mass_kg" = 1800.0`, or the same in sections.

    Raises:
        FileError: It is no TOML.
        OSError: It cannot be read.
    """
    return [f"{key}={_toml(key, value)}" for key, value in _leaves(toml_files.read(path), "")]


def _leaves(table: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


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
