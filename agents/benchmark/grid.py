"""The held-out trips: a file in configs/benchmark becomes explicit scenarios."""

from __future__ import annotations

import itertools
import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from hp_gym import _core
from hp_gym.files import atomic_write

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

DEFAULT_GRID: Final = "heldout-v0"


class GridError(ValueError):
    """A grid's file or a value in it is not right."""


@dataclass(frozen=True)
class Band:
    """A climate: ambient temperatures from `low_degc` up to but without the next band's."""

    name: str
    low_degc: float
    headline: bool


@dataclass(frozen=True)
class Variant:
    """How a trip begins and what the weather adds; soaked at ambient temperature where nothing is given."""

    name: str
    occupants: int
    state_of_charge_pct: float
    ambient_low_degc: float = -50.0
    ambient_high_degc: float = 60.0
    soak_temperature_degc: float | None = None
    solar_gain_w: float = 0.0
    parked_in_sun_k: float = 0.0


@dataclass(frozen=True)
class Scenario:
    """One trip of the grid."""

    name: str
    base: str
    cycle: str
    ambient_temperature_degc: float
    band: Band
    variant: Variant

    def to_toml(self) -> str:
        """The trip as a scenario file that `hp-gym run` takes."""
        variant, ambient_degc = self.variant, self.ambient_temperature_degc
        soak_degc = ambient_degc if variant.soak_temperature_degc is None else variant.soak_temperature_degc
        lines = [
            f'base = "{self.base}"',
            f'description = "Held out: {self.cycle} at {ambient_degc:g} degC, {variant.name}"',
            f'cycle = "{self.cycle}"',
            "",
            "[climate]",
            f"ambient_temperature_degc = {ambient_degc!r}",
            f"solar_gain_w = {variant.solar_gain_w!r}",
            f"occupants = {variant.occupants}",
            "",
            "[initial]",
            f"soak_temperature_degc = {soak_degc!r}",
            f"state_of_charge_pct = {variant.state_of_charge_pct!r}",
        ]
        if variant.parked_in_sun_k:
            lines.append(f"cabin_temperature_degc = {soak_degc + variant.parked_in_sun_k!r}")
        return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Front:
    """Set points that a family of rules is driven with, as offsets to its own."""

    family: str
    cabin_offsets_k: tuple[float, ...]
    htc_offsets_k: tuple[float, ...]


@dataclass(frozen=True)
class Grid:
    """All trips of a benchmark and how they are told apart."""

    name: str
    description: str
    bands: tuple[Band, ...]
    scenarios: tuple[Scenario, ...]
    shown: tuple[str, ...]
    fronts: tuple[Front, ...]

    def write(self, folder: Path) -> dict[str, Path]:
        """Writes every scenario into a folder and returns the files by the scenario's name.

        Raises:
            OSError: The folder cannot be written to.
        """
        folder.mkdir(parents=True, exist_ok=True)
        paths = {scenario.name: folder / f"{scenario.name}.toml" for scenario in self.scenarios}
        for scenario in self.scenarios:
            with atomic_write(paths[scenario.name]) as temporary:
                temporary.write_text(scenario.to_toml(), encoding="utf-8")
        return paths


def load(name: str = DEFAULT_GRID) -> Grid:
    """Loads a grid.

    Args:
        name: Name of a file in configs/benchmark, or a path.

    Raises:
        GridError: Something in the file is wrong; the message says where.
        ConfigurationError: There is no such file.
    """
    try:
        return parse(name, tomllib.loads(_core.config_text("benchmark", name)))
    except (tomllib.TOMLDecodeError, GridError) as error:
        raise GridError(f"benchmark `{name}`: {error}") from error


def parse(name: str, tables: Mapping[str, Any]) -> Grid:
    """Makes a grid of the tables of its file.

    Raises:
        GridError: A key is missing, unknown or of the wrong kind, or scenarios or bands are not told apart.
    """
    top = _checked("file", tables, _TOP)
    bands = tuple(Band(**_checked("bands", table, _BAND)) for table in top["bands"])
    variants = [Variant(**_checked("variants", table, _VARIANT)) for table in top["variants"]]
    fronts = tuple(
        Front(
            table["family"],
            tuple(_numbers("cabin_offsets_k", table["cabin_offsets_k"])),
            tuple(_numbers("htc_offsets_k", table["htc_offsets_k"])),
        )
        for table in (_checked("fronts", table, _FRONT) for table in top.get("fronts", []))
    )
    if not bands or list(bands) != sorted(bands, key=lambda band: band.low_degc):
        raise GridError("`bands` must be there, from cold to warm")
    for what, names in (("bands", bands), ("variants", variants)):
        _once(what, (item.name for item in names))
    _once("fronts", (front.family for front in fronts))
    cycles = _known_cycles(top["cycles"])
    ambients_degc = _numbers("ambient_temperatures_degc", top["ambient_temperatures_degc"])
    scenarios = tuple(
        Scenario(
            _file_name(cycle, ambient_degc, variant), top["scenario"], cycle, ambient_degc,
            _band(bands, ambient_degc), variant,
        )
        for cycle, ambient_degc, variant in itertools.product(cycles, ambients_degc, variants)
        if variant.ambient_low_degc <= ambient_degc <= variant.ambient_high_degc
    )  # fmt: skip
    names = [scenario.name for scenario in scenarios]
    _once("scenarios", names)
    shown = tuple(top.get("shown", []))
    if not scenarios:
        raise GridError("there is no scenario: every variant excludes every ambient temperature")
    for scenario in shown:
        if scenario not in names:
            raise GridError(f"`shown` names `{scenario}`, which is no scenario, unlike for example `{names[0]}`")
    return Grid(name, top["description"], bands, scenarios, shown, fronts)


_TOP: Final[Mapping[str, type]] = {
    "description": str,
    "scenario": str,
    "cycles": list,
    "ambient_temperatures_degc": list,
    "shown?": list,
    "variants": list,
    "bands": list,
    "fronts?": list,
}
_BAND: Final[Mapping[str, type]] = {"name": str, "low_degc": float, "headline": bool}
_FRONT: Final[Mapping[str, type]] = {"family": str, "cabin_offsets_k": list, "htc_offsets_k": list}
_VARIANT: Final[Mapping[str, type]] = {
    "name": str,
    "occupants": int,
    "state_of_charge_pct": float,
    "ambient_low_degc?": float,
    "ambient_high_degc?": float,
    "soak_temperature_degc?": float,
    "solar_gain_w?": float,
    "parked_in_sun_k?": float,
}


def _checked(where: str, table: object, keys: Mapping[str, type]) -> dict[str, Any]:
    """The values of a table by key; a key that ends with `?` may be absent."""
    if not isinstance(table, dict):
        raise GridError(f"`{where}` holds {table!r}, but must hold tables")
    kinds = {key.removesuffix("?"): kind for key, kind in keys.items()}
    for key in table:
        if key not in kinds:
            raise GridError(f"{where}: unknown `{key}`, expected one of {', '.join(kinds)}")
    values = {}
    for key, kind in keys.items():
        name = key.removesuffix("?")
        if name not in table:
            if not key.endswith("?"):
                raise GridError(f"{where}: `{name}` is missing")
            continue
        value = table[name]
        if kind is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if type(value) is not kind:
            raise GridError(f"{where}: `{name}` is {value!r}, but must be of type {kind.__name__}")
        values[name] = value
    if values.get("occupants", 1) < 1:
        raise GridError(f"{where}: `occupants` is {values['occupants']}, but somebody must drive")
    return values


def _numbers(where: str, values: Iterable[object]) -> list[float]:
    numbers = []
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise GridError(f"`{where}` holds {value!r}, but must hold numbers")
        numbers.append(float(value))
    if not numbers:
        raise GridError(f"`{where}` is empty")
    return numbers


def _known_cycles(cycles: Iterable[str]) -> list[str]:
    known = _core.names("drive cycle")
    for cycle in cycles:
        if cycle not in known:
            raise GridError(f"`cycles` names `{cycle}`; available: {', '.join(known)}")
    return list(cycles)


def _band(bands: Iterable[Band], ambient_degc: float) -> Band:
    fitting = [band for band in bands if band.low_degc <= ambient_degc]
    if not fitting:
        raise GridError(f"no band holds an ambient temperature of {ambient_degc:g} degC")
    return fitting[-1]


def _file_name(cycle: str, ambient_degc: float, variant: Variant) -> str:
    sign = "minus" if ambient_degc < 0.0 else ""
    return f"{sign}{abs(ambient_degc):g}-{cycle}-{variant.name}"


def _once(what: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise GridError(f"`{what}` has `{name}` twice")
        seen.add(name)
