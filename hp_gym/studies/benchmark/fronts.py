"""Rules with other set points: each a controller file of its own, so that anybody can run it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import tomlkit

from hp_gym import _core, toml_files
from hp_gym.agents.controllers.rule_based import rules
from hp_gym.files import atomic_write

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hp_gym.agents.controllers import Controller
    from hp_gym.studies.benchmark.grid import Front

DIALS: Final[Mapping[str, tuple[str, tuple[float, float]]]] = {
    # Below 30 degC the HTC could hardly heat a cabin; above 90 degC the plant limits it itself.
    "cabin_offset_k": ("cabin_set_point_degc", (10.0, 30.0)),
    "htc_offset_k": ("htc_set_point_degc", (30.0, 90.0)),
    "ptc_offset_k": ("ptc_from_deviation_k", (-100.0, 40.0)),
}
"""What is moved: name of the offset, key in the controller file, and its range."""

OFFSETS: Final = tuple(DIALS)


@dataclass(frozen=True)
class Setting:
    """Rules with their set points moved.

    Attributes:
        family: Rules.
        offsets_k: By how much each of `DIALS` is moved.
        controller: The controller.
    """

    family: str
    offsets_k: Mapping[str, float]
    controller: Controller

    def columns(self) -> dict[str, str | float]:
        """Returns what tells it from others, as columns of a table."""
        return {"family": self.family, **self.offsets_k}


def settings(front: Front, folder: Path) -> list[Setting]:
    """Writes a controller file for each combination of offsets.

    Args:
        front: Family and offsets.
        folder: Where to.

    Raises:
        ConfigurationError: There is no such family.
        OSError: The folder cannot be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    values = toml_files.merged("controller", front.family)
    # A path in a file counts from that file's folder.
    base = front.family if front.family in _core.names("controller") else str(Path(front.family).resolve())
    made = []
    for offsets in itertools.product(front.cabin_offsets_k, front.htc_offsets_k, front.ptc_offsets_k):
        offsets_k = dict(zip(OFFSETS, offsets, strict=True))
        moved = _moved(values, {key: (offsets_k[name], limits) for name, (key, limits) in DIALS.items()})
        name = f"{Path(front.family).stem}-cabin{offsets[0]:+g}-htc{offsets[1]:+g}-ptc{offsets[2]:+g}"
        path = folder / f"{name}.toml"
        # Tables of ambient bands replace those of the base as a whole, so only what moved need be written.
        changed = {key: value for key, value in moved.items() if value != values[key]}
        with atomic_write(path, durable=False) as temporary:
            temporary.write_text(tomlkit.dumps({"base": base, **changed}), encoding="utf-8")
        made.append(Setting(front.family, offsets_k, rules(name, path)))
    return made


def _moved(value: Any, offsets: Mapping[str, tuple[float, tuple[float, float]]]) -> Any:
    """A copy with every set point moved within its range, in ambient bands too."""
    if isinstance(value, list):
        return [_moved(item, offsets) for item in value]
    if not isinstance(value, dict):
        return value
    copy = {}
    for key, item in value.items():
        if key in offsets:
            offset_k, (low, high) = offsets[key]
            copy[key] = min(max(item + offset_k, low), high)
        else:
            copy[key] = _moved(item, offsets)
    return copy
