"""One process at a time writes results to a folder; the system frees what a killed one held."""

import errno
import os
import sys
import warnings
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from hp_gym.files import OURS
from hp_gym.messages import InUseError

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

_NO_LOCKS: Final = {errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOLCK}
"""What file systems answer that have no locks."""


def lock_path(place: Path) -> Path:
    """Returns the file beside a folder that its writer locks; it is there while somebody writes."""
    return place.with_name(f".{place.name}.{OURS}lock")


@contextmanager
def lock(folder: Path) -> Generator[None]:
    """Keeps other processes from writing to a folder, which need not exist, for the length of a block.

    Raises:
        InUseError: Another process writes to it.
        OSError: The folder around it cannot be written to.
    """
    place = folder.resolve()
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder)) from error
    path = lock_path(place)
    descriptor = _acquired(path, folder)
    try:
        with suppress(OSError):
            os.truncate(descriptor, 0)
            os.write(descriptor, f"{os.getpid()}\n".encode("ascii"))
        yield
    finally:
        # While it is held: afterwards it might be another's. Windows keeps it.
        with suppress(OSError):
            path.unlink()
        os.close(descriptor)


def _acquired(path: Path, folder: Path) -> int:
    while True:
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise OSError(error.errno, os.strerror(error.errno or 0), str(folder)) from error
        try:
            _lock(descriptor, folder)
            # Whoever held it before may have removed the file in between.
            if path.exists() and os.path.samestat(os.fstat(descriptor), path.stat()):
                return descriptor
        except FileNotFoundError:
            pass
        except BlockingIOError as error:
            writer = _writer(descriptor)
            os.close(descriptor)
            message = (
                f"{folder}: another process{writer} writes its results there; wait, or choose another folder"
            )
            raise InUseError(message) from error
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)


def _lock(descriptor: int, folder: Path) -> None:
    try:
        if sys.platform == "win32":
            try:
                msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
            except OSError as error:
                raise BlockingIOError from error
        else:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
        message = (
            f"{folder}: this file system has no locks, so nothing keeps a second process from writing there"
        )
        warnings.warn(message, RuntimeWarning, stacklevel=2)


def _writer(descriptor: int) -> str:
    with suppress(OSError, ValueError):
        return f" ({int(os.pread(descriptor, 20, 0))})" if sys.platform != "win32" else ""
    return ""
