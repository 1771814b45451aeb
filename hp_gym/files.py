"""Writing files whole or not at all."""

import os
import secrets
from collections.abc import Collection, Generator
from contextlib import contextmanager
from pathlib import Path


def require_suffix(path: str | os.PathLike[str], allowed: Collection[str]) -> str:
    """Returns the lower-case suffix of a path.

    Raises:
        ValueError: It is none of those allowed.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in allowed:
        message = f"{os.fspath(path)}: the name must end with one of {', '.join(allowed)}"
        raise ValueError(message)
    return suffix


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Generator[Path]:
    """Gives a temporary file beside `path` that takes its place if the block succeeds.

    If it does not, whatever was at `path` stays as it was and nothing else is left behind.

    Raises:
        OSError: The folder cannot be written to; the message names `path`.
    """
    target = Path(path)
    temporary = target.with_name(f".{target.stem}.{secrets.token_hex(4)}{target.suffix}")
    try:
        temporary.touch(exist_ok=False)
    except OSError as error:
        raise _about(target, error) from error
    try:
        yield temporary
        temporary.replace(target)
    except OSError as error:
        if error.filename in {None, str(temporary)}:
            raise _about(target, error) from error
        raise
    finally:
        temporary.unlink(missing_ok=True)


def _about(target: Path, error: OSError) -> OSError:
    """The same error, told of the file that was asked for."""
    if error.errno is None:
        return OSError(f"{target}: {error}")
    return OSError(error.errno, os.strerror(error.errno), str(target))
