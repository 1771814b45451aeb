"""The held-out trips: a file in configs/benchmark becomes explicit scenarios."""

import itertools
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final

import numpy as np
import tomlkit
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hp_gym import _core, toml_files
from hp_gym.files import atomic_write
from hp_gym.messages import FileError, OneLineError
from hp_gym.pydantic_errors import one_line

DEFAULT_GRID: Final = "heldout-v1"

_CHECKED: Final = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
_Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9 ._-]+$")]


class GridError(OneLineError):
    """A grid's file or a value in it is not right."""


class Band(BaseModel):
    """A climate: ambient temperatures from `low_degc` up to but without the next band's."""

    model_config = _CHECKED

    name: _Name
    low_degc: float
    headline: bool
    """Whether the headline's figures are of it."""


class Cycle(BaseModel):
    """A drive cycle, driven whole."""

    model_config = _CHECKED

    name: str
    least_battery_temperature_degc: float = -50.0
    """Temperature that the battery is kept at until the start where the rest is colder."""


class Variant(BaseModel):
    """How a trip begins and what the weather adds; soaked at ambient temperature where nothing is given."""

    model_config = _CHECKED

    name: _Name
    occupants: Annotated[int, Field(ge=1)]
    state_of_charge_pct: Annotated[float, Field(gt=0.0, le=100.0)]
    ambient_low_degc: float = -50.0
    ambient_high_degc: float = 60.0
    soak_temperature_degc: float | None = None
    solar_gain_w: Annotated[float, Field(ge=0.0)] = 0.0
    parked_in_sun_k: Annotated[float, Field(ge=0.0)] = 0.0
    """By how much the cabin is warmer than all else."""
    humidity_offset: Annotated[float, Field(ge=-1.0, le=1.0)] = 0.0
    """Added to the relative humidity that belongs to the ambient temperature."""


class Front(BaseModel):
    """Set points that a family of rules is driven with, as offsets to its own; all combinations of them."""

    model_config = _CHECKED

    family: _Name
    cabin_offsets_k: Annotated[tuple[float, ...], Field(min_length=1)]
    htc_offsets_k: Annotated[tuple[float, ...], Field(min_length=1)]
    ptc_offsets_k: Annotated[tuple[float, ...], Field(min_length=1)] = (0.0,)
    """To the deviation of the cabin from which the PTC helps."""


class GridFile(BaseModel):
    """A grid as its file gives it."""

    model_config = _CHECKED

    description: str
    scenario: str
    """Scenario that gives vehicle, strategy and heat requests."""
    relative_humidity: tuple[tuple[float, Annotated[float, Field(ge=0.0, le=1.0)]], ...] = ()
    """Ambient temperatures [degC], rising, and relative humidity at each; lines between. None: dry."""
    cycles: Annotated[tuple[Cycle, ...], Field(min_length=1)]
    ambient_temperatures_degc: Annotated[tuple[float, ...], Field(min_length=1)]
    variants: Annotated[tuple[Variant, ...], Field(min_length=1)]
    bands: Annotated[tuple[Band, ...], Field(min_length=1)]
    shown: tuple[str, ...] = ()
    """Scenarios whose trajectories are kept."""
    fronts: tuple[Front, ...] = ()


@dataclass(frozen=True)
class Scenario:
    """One trip of the grid."""

    name: str
    base: str
    cycle: Cycle
    ambient_temperature_degc: float
    relative_humidity: float
    band: Band
    variant: Variant

    def to_toml(self) -> str:
        """The trip as a scenario file that `hp-gym run` takes."""
        variant, ambient_degc = self.variant, self.ambient_temperature_degc
        soak_degc = ambient_degc if variant.soak_temperature_degc is None else variant.soak_temperature_degc
        initial = {
            "soak_temperature_degc": soak_degc,
            "state_of_charge_pct": variant.state_of_charge_pct,
        }
        if variant.parked_in_sun_k:
            initial["cabin_temperature_degc"] = soak_degc + variant.parked_in_sun_k
        if self.cycle.least_battery_temperature_degc > soak_degc:
            initial["battery_temperature_degc"] = self.cycle.least_battery_temperature_degc
        return tomlkit.dumps(
            {
                "base": self.base,
                "description": f"Held out: {self.cycle.name} at {ambient_degc:g} degC, {variant.name}",
                "cycle": self.cycle.name,
                "climate": {
                    "ambient_temperature_degc": ambient_degc,
                    "relative_humidity": self.relative_humidity,
                    "solar_gain_w": variant.solar_gain_w,
                    "occupants": variant.occupants,
                },
                "initial": initial,
            }
        )


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
            with atomic_write(paths[scenario.name], durable=False) as temporary:
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
        return parse(name, toml_files.load("benchmark", name))
    except FileError as error:
        raise GridError(str(error)) from error
    except GridError as error:
        raise GridError(f"benchmark `{name}`: {error}") from error


def parse(name: str, tables: Mapping[str, Any]) -> Grid:
    """Makes a grid of the tables of its file.

    Raises:
        GridError: A value is missing, unknown or not allowed, or scenarios or bands are not told apart.
    """
    try:
        file = GridFile.model_validate(tables)
    except ValidationError as error:
        raise GridError(one_line(error)) from error
    _known("cycles", [cycle.name for cycle in file.cycles], _core.names("drive cycle"))
    _known("scenario", [file.scenario], _core.names("scenario"))
    lows_degc = [band.low_degc for band in file.bands]
    if lows_degc != sorted(set(lows_degc)):
        raise GridError("`bands` must go from cold to warm")
    humid_degc = [ambient_degc for ambient_degc, _ in file.relative_humidity]
    if humid_degc != sorted(set(humid_degc)):
        raise GridError("the temperatures of `relative_humidity` must rise")
    scenarios = tuple(
        Scenario(
            name=_file_name(cycle, ambient_degc, variant),
            base=file.scenario,
            cycle=cycle,
            ambient_temperature_degc=ambient_degc,
            relative_humidity=_humidity(file.relative_humidity, ambient_degc, variant),
            band=_band(file.bands, ambient_degc),
            variant=variant,
        )
        for cycle, ambient_degc, variant in itertools.product(
            file.cycles, file.ambient_temperatures_degc, file.variants
        )
        if variant.ambient_low_degc <= ambient_degc <= variant.ambient_high_degc
    )
    if not scenarios:
        raise GridError("there is no scenario: every variant excludes every ambient temperature")
    names = [scenario.name for scenario in scenarios]
    for what, those in (
        ("bands", [band.name for band in file.bands]),
        ("fronts", [front.family for front in file.fronts]),
        ("scenarios", names),
    ):
        _once(what, those)
    _known("shown", file.shown, names)
    return Grid(name, file.description, file.bands, scenarios, file.shown, file.fronts)


def _known(what: str, wanted: Iterable[str], known: Sequence[str]) -> None:
    for name in wanted:
        if name not in known:
            others = f" and {len(known) - 8} more" if len(known) > 8 else ""
            raise GridError(f"`{what}` names `{name}`; available: {', '.join(known[:8])}{others}")


def _band(bands: Sequence[Band], ambient_degc: float) -> Band:
    fitting = [band for band in bands if band.low_degc <= ambient_degc]
    if not fitting:
        raise GridError(f"no band holds an ambient temperature of {ambient_degc:g} degC")
    return fitting[-1]


def _humidity(by_ambient: Sequence[tuple[float, float]], ambient_degc: float, variant: Variant) -> float:
    """Relative humidity of a trip's outside air [-]; dry where the grid gives none."""
    if not by_ambient:
        return 0.0
    at_degc, humidities = [point[0] for point in by_ambient], [point[1] for point in by_ambient]
    humidity = float(np.interp(ambient_degc, at_degc, humidities)) + variant.humidity_offset
    return round(min(max(humidity, 0.0), 1.0), 4)


def _file_name(cycle: Cycle, ambient_degc: float, variant: Variant) -> str:
    sign = "minus" if ambient_degc < 0.0 else ""
    return f"{sign}{abs(ambient_degc):g}-{cycle.name}-{variant.name}"


def _once(what: str, names: Iterable[str]) -> None:
    for name, count in Counter(names).items():
        if count > 1:
            raise GridError(f"`{what}` has `{name}` {count} times")
