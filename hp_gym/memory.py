"""How much memory there is, to refuse what cannot fit before any of it is asked for."""

import os
from pathlib import Path
from typing import Final

_CGROUP_FILES: Final = (
    ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
    ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
)
"""Limit and use of a container, newer and older."""


def available_bytes() -> int | None:
    """Returns memory that this process can still get; None where the system does not tell."""
    told = [found for found in (_of_system(), *map(_of_container, _CGROUP_FILES)) if found is not None]
    return min(told, default=None)


def shortage(needed_bytes: int) -> str | None:
    """Returns words for a message if so much memory cannot be had, else None."""
    there = available_bytes()
    if there is None or needed_bytes <= there:
        return None
    return f"needs about {needed_bytes // 2**20:,} MiB of memory, but {there // 2**20:,} MiB are free"


def _of_system() -> int | None:
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return 1024 * int(line.split()[1])
    except (OSError, ValueError, IndexError):
        pass
    try:
        return int(os.sysconf("SC_PHYS_PAGES")) * int(os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return None


def _of_container(files: tuple[str, str]) -> int | None:
    try:
        limit, used = (int(Path(file).read_text(encoding="ascii")) for file in files)
    except (OSError, ValueError):
        return None
    return max(limit - used, 0)
