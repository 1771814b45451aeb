"""Rules with other set points: each a controller file of its own, so that anybody can run it."""

from __future__ import annotations

import itertools
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import tomlkit

from agents.controllers.rules import rules
from hp_gym import _core
from hp_gym.files import atomic_write

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agents.benchmark.grid import Front
    from agents.controllers import Controller

CABIN_KEY: Final = "cabin_set_point_degc"
HTC_KEY: Final = "htc_set_point_degc"

# Above, the plant limits the HTC itself; below, it could hardly heat a cabin.
_HTC_RANGE_DEGC: Final = (30.0, 90.0)
_CABIN_RANGE_DEGC: Final = (10.0, 30.0)


@dataclass(frozen=True)
class Setting:
    """Rules with their set points moved.

    Attributes:
        family: Rules.
        cabin_offset_k: By how much the cabin set point is moved.
        htc_offset_k: By how much the HTC set point is moved.
        cabin_set_point_degc: Cabin set point of the file itself, before its ambient bands.
        htc_set_point_degc: HTC set point, likewise.
        controller: The controller.
    """

    family: str
    cabin_offset_k: float
    htc_offset_k: float
    cabin_set_point_degc: float
    htc_set_point_degc: float
    controller: Controller


def settings(front: Front, folder: Path) -> list[Setting]:
    """Writes a controller file for each pair of offsets.

    Args:
        front: Family and offsets.
        folder: Where to.

    Raises:
        ConfigurationError: There is no such family.
        OSError: The folder cannot be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    values = _values(front.family)
    made = []
    for cabin_k, htc_k in itertools.product(front.cabin_offsets_k, front.htc_offsets_k):
        moved = _moved(values, cabin_k, htc_k)
        name = f"{Path(front.family).stem}-cabin{cabin_k:+g}-htc{htc_k:+g}"
        path = folder / f"{name}.toml"
        # Tables of ambient bands replace those of the base as a whole, so only what moved need be written.
        changed = {key: value for key, value in moved.items() if value != values[key]}
        with atomic_write(path) as temporary:
            temporary.write_text(tomlkit.dumps({"base": front.family, **changed}), encoding="utf-8")
        made.append(
            Setting(front.family, cabin_k, htc_k, moved[CABIN_KEY], moved[HTC_KEY], rules(name, path))
        )
    return made


def _values(name: str) -> dict[str, Any]:
    """All values of a controller file, those of its bases included."""
    tables = tomllib.loads(_core.config_text("controller", name))
    base = tables.pop("base", None)
    return tables if base is None else _merged(_values(base), tables)


def _merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    both = dict(below)
    for key, value in above.items():
        old = both.get(key)
        both[key] = _merged(old, value) if isinstance(old, dict) and isinstance(value, dict) else value
    return both


def _moved(value: Any, cabin_k: float, htc_k: float) -> Any:
    """A copy with every set point moved, in ambient bands too."""
    if isinstance(value, list):
        return [_moved(item, cabin_k, htc_k) for item in value]
    if not isinstance(value, dict):
        return value
    offsets = {CABIN_KEY: (cabin_k, _CABIN_RANGE_DEGC), HTC_KEY: (htc_k, _HTC_RANGE_DEGC)}
    copy = {}
    for key, item in value.items():
        if key in offsets:
            offset_k, (low, high) = offsets[key]
            copy[key] = min(max(item + offset_k, low), high)
        else:
            copy[key] = _moved(item, cabin_k, htc_k)
    return copy
