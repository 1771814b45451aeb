"""Every value of a vehicle: what it is, what it rests on, and the file it comes from."""

import itertools
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from hp_gym import _core, provenance, toml_files
from hp_gym.key_units import unit_of
from hp_gym.provenance import Provenance

_NOT_VALUES: Final = ("description", "base")

_PLAIN_SECTIONS: Final = ("architecture", "refrigerant", "body", "regeneration", "battery", "controls")
"""What every vehicle has; the other sections come with its refrigerant and its architecture."""

REFERENCE_DEGC: Final = 25.0
"""Temperature at which the energy of a pack is told."""

_LIMITS: Final = (
    ("refrigeration", "maximum_pressure_bar"),
    ("refrigeration", "minimum_suction_pressure_bar"),
    ("refrigeration", "compressor", "maximum_discharge_temperature_degc"),
)
"""Limits that the refrigerant's table brings where the vehicle gives none (`FLUID_LIMITS` of the plant)."""


@dataclass(frozen=True)
class VehicleValue:
    """A value of a vehicle.

    Attributes:
        key: Dotted key; `share[2]` is an element of a list.
        value: A number, a text, or a list.
        unit: Its unit, `-` without one.
        provenance: What it rests on; None where the file does not say.
        file: Name or path of the file that gives it: of the vehicle, of a base, or of the refrigerant.
    """

    key: str
    value: Any
    unit: str
    provenance: Provenance | None
    file: str


@dataclass(frozen=True)
class VehicleSheet:
    """A vehicle and all its values.

    Attributes:
        name: Name or path.
        description: What it is, in a sentence.
        architecture: Name or path of its architecture.
        files: The vehicle's file, that of its base, and so on.
        values: All values that its architecture has use for.
        pack_energy_kwh: Charge times open-circuit voltage from empty to full, at 25 degC.
    """

    name: str
    description: str
    architecture: str
    files: tuple[str, ...]
    values: tuple[VehicleValue, ...]
    pack_energy_kwh: float


@dataclass(frozen=True)
class _File:
    name: str
    table: dict[str, Any]
    told: dict[provenance.Path, Provenance]


def sheet(vehicle: str) -> VehicleSheet:
    """Returns all values of a vehicle.

    Args:
        vehicle: Name or path.

    Raises:
        ConfigurationError: There is no such vehicle, or its file is not right; the message names it.
        FileError: A file is too large, too deep or no TOML.
        OSError: A file cannot be read.
    """
    layout = _core.vehicle_layout(vehicle)
    files = [
        _File(name, table, provenance.comments(_core.config_text("vehicle", name)))
        for name, table in toml_files.chain("vehicle", vehicle)
    ]
    owners = _owners(files)
    limits = _limits(owners) if layout["refrigerates"] else {}
    used = {path: owner for path, owner in {**limits, **owners}.items() if _is_used(path, layout)}
    values = itertools.chain.from_iterable(_values(path, owner) for path, owner in used.items())
    return VehicleSheet(
        name=vehicle,
        description=next(file.table["description"] for file in files if "description" in file.table),
        architecture=layout["architecture"],
        files=tuple(file.name for file in files),
        values=tuple(sorted(values, key=lambda value: _place(value.key, layout["sections"]))),
        pack_energy_kwh=_pack_energy_kwh({path: _at(owner.table, path) for path, owner in used.items()}),
    )


def _owners(files: Sequence[_File]) -> dict[provenance.Path, _File]:
    """File that each value comes from: the first of the chain that has it."""
    owners: dict[provenance.Path, _File] = {}
    refrigerant = ""
    for file in reversed(files):
        own = file.table.get("refrigerant", refrigerant)
        # Limits belong to the refrigerant: those of a base with another one do not count.
        if own.lower() != refrigerant.lower():
            for path in _LIMITS:
                owners.pop(path, None)
        refrigerant = own
        owners.update((path, file) for path, _ in provenance.leaves(file.table) if path[0] not in _NOT_VALUES)
    return owners


def _limits(owners: dict[provenance.Path, _File]) -> dict[provenance.Path, _File]:
    """Limits of the refrigerant's table, as a file of their own."""
    owner = owners[("refrigerant",)]
    name = owner.table["refrigerant"]
    beside = Path(owner.name).parent / name
    place = str(beside) if name not in _core.names("refrigerant") and beside.exists() else name
    header = [
        line[2:] for line in _core.config_text("refrigerant", place).splitlines() if line.startswith("#:")
    ]
    found = tomllib.loads("\n".join(header))
    table: dict[str, Any] = {"refrigeration": {"compressor": {}}}
    file = _File(
        place, table, {("refrigeration",): Provenance("derived", "limits in the refrigerant's table")}
    )
    limits: dict[provenance.Path, _File] = {}
    for path in _LIMITS:
        if path[-1] in found:
            _at(table, path[:-1])[path[-1]] = found[path[-1]]
            limits[path] = file
    return limits


def _at(table: Any, path: provenance.Path) -> Any:
    for key in path:
        table = table[key]
    return table


def _is_used(path: provenance.Path, layout: dict[str, Any]) -> bool:
    """Whether the vehicle's architecture has use for a value; what only a base has is left out otherwise."""
    section = path[0]
    if section in ("refrigerant", "refrigeration"):
        is_conductance = len(path) == 2 and str(path[1]).endswith("_ua_w_k")
        exchangers = {f"{exchanger['name']}_ua_w_k" for exchanger in layout["exchangers"]}
        return layout["refrigerates"] and (not is_conductance or path[1] in exchangers)
    if section not in (*_PLAIN_SECTIONS, *layout["sections"]):
        return False
    if len(path) == 4 and path[1:3] == ("circuit", "branch_shares") and path[3] != "closed_branches":
        return any((branch["loop"], branch["member"]) == (section, path[3]) for branch in layout["branches"])
    # Exchangers that share their air have it in a section of its own, whatever their base says.
    sharing = {end["section"] for end in layout["front_ends"] if end["air_stream"]}
    return not (section in sharing and len(path) > 2 and path[1] == "air")


def _values(path: provenance.Path, file: _File) -> Iterator[VehicleValue]:
    """The value at a path; a row for each element where they have comments of their own."""
    value, key = _at(file.table, path), ".".join(str(part) for part in path)
    if isinstance(value, list) and any((*path, place) in file.told for place in range(len(value))):
        for place, element in enumerate(value):
            said = provenance.of(file.told, (*path, place))
            yield VehicleValue(f"{key}[{place}]", element, unit_of(key), said, file.name)
        return
    yield VehicleValue(key, value, unit_of(key), provenance.of(file.told, path), file.name)


def _place(key: str, sections: Sequence[str]) -> int:
    """Where a section stands on the sheet; within it values are as in the files."""
    order = [*_PLAIN_SECTIONS[:-1], *(s for s in sections if s != "battery"), "refrigeration", "controls"]
    return order.index(key.partition(".")[0])


def _pack_energy_kwh(values: dict[provenance.Path, Any]) -> float:
    battery = {path[1:]: value for path, value in values.items() if path[0] == "battery"}
    cells = battery[("cells_in_series",)] * battery[("strings_in_parallel",)]
    share = np.interp(
        REFERENCE_DEGC,
        battery[("usable_capacity", "temperature_degc")],
        battery[("usable_capacity", "share")],
    )
    charge = np.asarray(battery[("open_circuit_voltage", "state_of_charge")], dtype=np.float64)
    voltage_v = np.asarray(battery[("open_circuit_voltage", "voltage_v")], dtype=np.float64)
    mean_v = float(np.sum(np.diff(charge) * (voltage_v[1:] + voltage_v[:-1]) / 2.0))
    return float(cells * battery[("cell_capacity_ah",)] * share * mean_v / 1000.0)
