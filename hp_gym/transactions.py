"""The contents of a folder of results: all are replaced in one rename, or none.

New contents are written to a folder beside the old one. At the end the two change places, in one system call
where there is one (Linux, macOS), and the old contents are removed. A process that is killed leaves the old
folder or the new one, whole, and beside it folders whose names hold `hp-gym-`; the next writer removes those.
"""

import ctypes
import errno
import os
import re
import secrets
import shutil
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from hp_gym import locks
from hp_gym.files import OURS, sync, sync_folder
from hp_gym.messages import FileError

_NOT_THERE: Final = {errno.ENOSYS, errno.EINVAL, errno.ENOTSUP, errno.EOPNOTSUPP}
"""What systems and file systems answer that cannot swap two names."""

_EARLIER_DEBRIS: Final = re.compile(r"\.new\.[0-9a-f]{8}")
"""What earlier versions left in the folder when they were killed."""

_AT_FDCWD: Final = -100
_RENAME_EXCHANGE: Final = 2
_RENAME_SWAP: Final = 2


@contextmanager
def new_contents(folder: Path) -> Generator[Path]:
    """Gives an empty folder whose contents take their places in `folder` if the block succeeds.

    If it does not, everything in `folder` stays as it was. What has no successor stays in either case.

    Raises:
        FileError: The folder cannot be replaced: it is that in which the command runs, or the root of a disk.
        InUseError: Another process writes to it.
        OSError: The folder cannot be made or written to.
    """
    place = folder.resolve()
    _require_replaceable(folder, place)
    with locks.lock(folder):
        _recover(place)
        staged = _beside(place, "new")
        try:
            staged.mkdir()
        except OSError as error:
            raise OSError(error.errno, os.strerror(error.errno or 0), str(folder)) from error
        try:
            yield staged
            _carry_over(place, staged)
            _sync_all(staged)
            _take_place(staged, place)
            sync_folder(place.parent)
        finally:
            # By now the old contents, if all went well.
            shutil.rmtree(staged, ignore_errors=True)


def _require_replaceable(folder: Path, place: Path) -> None:
    if place.exists() and not place.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder))
    working = Path.cwd()
    if place == working or place in working.parents:
        reason = "is the working folder, or around it"
    elif os.path.ismount(place):
        reason = "is the root of a disk"
    else:
        return
    message = f"{folder}: {reason}; results replace a folder as a whole, so choose one in it"
    raise FileError(message)


def _beside(place: Path, what: str) -> Path:
    return place.with_name(f".{place.name}.{OURS}{secrets.token_hex(4)}.{what}")


def _recover(place: Path) -> None:
    """Ends what killed processes have begun; called with the lock held, so that there is no living one."""
    ours = re.compile(re.escape(f".{place.name}.{OURS}") + r"[0-9a-f]{8}\.(new|old)")
    left = [path for path in place.parent.iterdir() if ours.fullmatch(path.name)]
    for path in sorted(left, key=lambda found: found.suffix != ".old"):
        # Between two renames, where a swap in one is not to be had.
        if path.suffix == ".old" and not place.exists():
            path.rename(place)
        else:
            shutil.rmtree(path, ignore_errors=True)


def _carry_over(place: Path, staged: Path) -> None:
    """Gives the new folder what it does not replace, as further names of the same files."""
    if not place.exists():
        return
    for entry in place.iterdir():
        successor = staged / entry.name
        if os.path.lexists(successor) or _EARLIER_DEBRIS.fullmatch(entry.name):
            continue
        if entry.is_dir() and not entry.is_symlink():
            shutil.copytree(entry, successor, symlinks=True, copy_function=_link)
        else:
            _link(entry, successor)


def _link(source: Any, target: Any) -> None:
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:
        shutil.copy2(source, target, follow_symlinks=False)


def _sync_all(folder: Path) -> None:
    for path, _, files in os.walk(folder):
        for name in files:
            file = Path(path) / name
            if file.is_file() and not file.is_symlink() and file.stat().st_nlink == 1:
                sync(file)
        sync_folder(Path(path))


def _take_place(staged: Path, place: Path) -> None:
    """Puts new contents in place; what was there before lies at `staged` then."""
    if not place.exists():
        staged.rename(place)
        return
    shutil.copymode(place, staged)
    try:
        _exchange(staged, place)
    except OSError as error:
        if error.errno not in _NOT_THERE:
            raise
        old = _beside(place, "old")
        place.rename(old)
        staged.rename(place)
        shutil.rmtree(old, ignore_errors=True)


def _exchange(one: Path, other: Path) -> None:
    """Lets two folders change names in one system call.

    Raises:
        OSError: The system or the file system cannot.
    """
    library: Any = ctypes.CDLL(None, use_errno=True) if sys.platform != "win32" else None
    names = os.fsencode(one), os.fsencode(other)
    if hasattr(library, "renameat2"):
        failed = library.renameat2(_AT_FDCWD, names[0], _AT_FDCWD, names[1], _RENAME_EXCHANGE)
    elif hasattr(library, "renamex_np"):
        failed = library.renamex_np(*names, _RENAME_SWAP)
    else:
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))
    if failed:
        code = ctypes.get_errno()
        raise OSError(code, os.strerror(code), str(other))
