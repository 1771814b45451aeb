"""Reading files within bounds, and writing them whole or not at all."""

import os
import secrets
import stat
import sys
from collections.abc import Collection, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from hp_gym.messages import FileError

if sys.platform != "win32":
    import fcntl

OURS: Final = "hp-gym-"
"""What names of temporary files and folders of this package hold, so that they can be told from others'."""


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


def read_bytes(path: str | os.PathLike[str], largest: int) -> bytes:
    """Reads a regular file of at most `largest` bytes; waits for no writer of a pipe.

    Raises:
        FileError: It is no regular file, or larger.
        OSError: It cannot be read.
    """
    name = os.fspath(path)
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    descriptor = os.open(name, flags)
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            message = f"{name}: is no regular file"
            raise FileError(message)
        with open(descriptor, "rb", closefd=False) as file:
            # A file may grow while it is read.
            data = b"" if status.st_size > largest else file.read(largest + 1)
    finally:
        os.close(descriptor)
    if max(status.st_size, len(data)) > largest:
        message = f"{name}: has {max(status.st_size, len(data))} bytes, but may have at most {largest}"
        raise FileError(message)
    return data


@contextmanager
def atomic_write(path: str | os.PathLike[str], *, durable: bool = True) -> Generator[Path]:
    """Gives a temporary file beside `path` that takes its place if the block succeeds.

    If it does not, whatever was at `path` stays as it was and nothing else is left behind. What a process
    that was killed has left of an earlier attempt is removed.

    Args:
        path: The file.
        durable: Whether the new content must outlive a power cut.

    Raises:
        OSError: The folder cannot be written to; the message names `path`.
    """
    target = Path(path)
    temporary = target.with_name(f".{target.stem}.{OURS}{secrets.token_hex(4)}{target.suffix}")
    try:
        descriptor = os.open(temporary, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666)
    except OSError as error:
        raise _about(target, error) from error
    try:
        with _held(descriptor):
            _sweep(target)
            yield temporary
            if durable:
                sync(temporary)
        temporary.replace(target)
        if durable:
            sync_folder(target.parent)
    except OSError as error:
        if error.filename in {None, str(temporary)}:
            raise _about(target, error) from error
        raise
    finally:
        temporary.unlink(missing_ok=True)


def sync(path: Path) -> None:
    """Lets the content of a file outlive a power cut.

    Raises:
        OSError: It cannot be written to the disk.
    """
    descriptor = os.open(path, os.O_RDWR | getattr(os, "O_BINARY", 0))
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def sync_folder(path: Path) -> None:
    """Lets the names in a folder outlive a power cut, where the system can.

    Raises:
        OSError: They cannot be written to the disk.
    """
    if sys.platform == "win32":
        return
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextmanager
def _held(descriptor: int) -> Generator[None]:
    """Marks a temporary file as that of a living process."""
    # Windows would refuse others to write to it, or to rename it.
    if sys.platform == "win32":
        os.close(descriptor)
        yield
        return
    # Where a file system has no locks, nothing is swept either.
    with suppress(OSError):
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    try:
        yield
    finally:
        os.close(descriptor)


def _sweep(target: Path) -> None:
    """Removes temporary files of `target` whose processes are gone."""
    if sys.platform == "win32":
        return
    for path in target.parent.glob(f".{_literal(target.stem)}.{OURS}????????{_literal(target.suffix)}"):
        with suppress(OSError), path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink()


def _literal(text: str) -> str:
    """A text in which `glob` sees nothing but itself."""
    return "".join(f"[{character}]" if character in "*?[" else character for character in text)


def _about(target: Path, error: OSError) -> OSError:
    """The same error, told of the file that was asked for."""
    if error.errno is None:
        return OSError(f"{target}: {error}")
    return OSError(error.errno, os.strerror(error.errno), str(target))
