"""TOML within bounds: how large a file may be and how deep its tables."""

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Final

from hp_gym import _core
from hp_gym.files import read_bytes
from hp_gym.messages import FileError

LARGEST_BYTES: Final = 2**20
"""Bytes of a configuration file."""

DEEPEST: Final = 32
"""Tables and lists within each other."""

LONGEST_BASE_CHAIN: Final = 8
"""Files that name each other as `base`."""


def load(kind: str, name: str) -> dict[str, Any]:
    """Loads a configuration file.

    Args:
        kind: Kind in words, as for `hp_gym.names`.
        name: Name of a file that is compiled in, or a path.

    Raises:
        FileError: It is no regular file, too large, too deep, or no TOML; the message names it.
        ConfigurationError: There is no such file.
        OSError: It cannot be read.
    """
    path = Path(name)
    if name in _core.names(kind) or path.suffix != ".toml" or not path.exists():
        return loads(_core.config_text(kind, name), name)
    return read(path)


def read(path: Path) -> dict[str, Any]:
    """Reads a TOML file; a byte-order mark at its beginning does not matter.

    Raises:
        FileError: It is no regular file, too large, too deep, or no TOML; the message names it.
        OSError: It cannot be read.
    """
    data = read_bytes(path, LARGEST_BYTES)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        message = f"{path}: byte {error.start} is no UTF-8"
        raise FileError(message) from error
    return loads(text, str(path))


def loads(text: str, name: str) -> dict[str, Any]:
    """Reads TOML.

    Args:
        text: What to read.
        name: Where it is from, for messages.

    Raises:
        FileError: It is too deep or no TOML.
    """
    too_deep = f"{name}: more than {DEEPEST} tables or lists within each other"
    # The time that the parser takes for a dotted key grows with the square of its parts.
    if _core.looks_deep(text):
        raise FileError(too_deep)
    try:
        tables = tomllib.loads(text)
    except RecursionError:
        raise FileError(too_deep) from None
    # Numbers of thousands of digits are a plain ValueError.
    except ValueError as error:
        message = f"{name}: {error}"
        raise FileError(message) from error
    _require_flat(tables, name)
    return tables


def chain(kind: str, name: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yields name and tables, without `base`, of a file, of the one that it names as its base, and so on.

    The path of a base counts from the folder of the file that names it.

    Raises:
        FileError: A file is not right, or the chain is too long or closed.
        ConfigurationError: There is no such file.
        OSError: A file cannot be read.
    """
    file = name
    for _ in range(LONGEST_BASE_CHAIN + 1):
        tables = load(kind, file)
        base = tables.pop("base", None)
        if base is not None and not isinstance(base, str):
            message = f"{file}: `base` is {base!r}, but must be the name of a {kind}"
            raise FileError(message)
        yield file, tables
        if base is None:
            return
        file = beside(kind, file, base)
    message = f"{name}: the chain of `base` files is too long or closed"
    raise FileError(message)


def merged(kind: str, name: str) -> dict[str, Any]:
    """Returns all values of a file, those of its bases included; where both have a value, the file's.

    Raises:
        FileError: A file is not right, or the chain is too long or closed.
        ConfigurationError: There is no such file.
        OSError: A file cannot be read.
    """
    return overlaid(tables for _, tables in chain(kind, name))


def overlaid(layers: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Returns tables laid over each other, the first on top."""
    values: dict[str, Any] = {}
    for tables in reversed(list(layers)):
        values = _over(values, tables)
    return values


def _over(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    both = dict(below)
    for key, value in above.items():
        old = both.get(key)
        both[key] = _over(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return both


def beside(kind: str, file: str, base: str) -> str:
    """Returns what a file means by a name or path: a path counts from the folder of that file.

    Args:
        kind: Kind of what is named, in words.
        file: Name or path of the file that names it.
        base: Name or path that stands there.
    """
    if base in _core.names(kind) or Path(base).suffix != ".toml" or file in _core.names(kind):
        return base
    return str(Path(file).parent / base)


def _require_flat(tables: dict[str, Any], name: str) -> None:
    level: list[Any] = [tables]
    for _ in range(DEEPEST):
        inner = (each.values() if isinstance(each, dict) else each for each in level)
        level = [item for items in inner for item in items if isinstance(item, dict | list)]
        if not level:
            return
    message = f"{name}: more than {DEEPEST} tables or lists within each other"
    raise FileError(message)
