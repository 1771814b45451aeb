"""Speed over time as files that the plant reads: rest, constant speed, cycles one after the other."""

import csv
from collections.abc import Sequence
from pathlib import Path

from hp_gym import _core


def write(path: Path, speeds_km_h: Sequence[float]) -> Path:
    """Writes a speed for each full second.

    Raises:
        OSError: The file cannot be written.
    """
    lines = [f"{second},{speed:.10g}" for second, speed in enumerate(speeds_km_h)]
    path.write_text("\n".join(["time_s,speed_km_h", *lines, ""]), encoding="utf-8")
    return path


def constant(speed_km_h: float, duration_s: int) -> list[float]:
    """A speed that is held, for as many seconds."""
    return [speed_km_h] * (duration_s + 1)


def cycle(name: str) -> list[float]:
    """Speed of a drive cycle at every full second [km/h].

    Raises:
        ConfigurationError: There is no such cycle.
        ValueError: It is not given second by second.
    """
    text = _core.config_text("drive cycle", name)
    rows = list(csv.reader(line for line in text.splitlines() if line and not line.startswith("#")))[1:]
    if [float(row[0]) for row in rows] != [float(second) for second in range(len(rows))]:
        message = f"cycle `{name}` must have a row for every second"
        raise ValueError(message)
    return [float(row[1]) for row in rows]


def repeated(names: Sequence[str], least_km: float) -> list[float]:
    """Cycles one after the other, again until so many kilometres are driven; once where that is 0."""
    once = [speed for name in names for speed in cycle(name)]
    length_km = sum(once) / 3600.0
    return once * max(1, round(least_km / length_km + 0.5))
