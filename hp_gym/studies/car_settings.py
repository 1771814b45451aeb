"""What studies of whole cars share: weather, what the rules may use, and heat requests that bind nothing."""

from collections.abc import Mapping
from typing import Any, Final

from hp_gym import _core, toml_files

_SOURCES: Final = ("motor", "transmission", "front-end")


def climate(
    ambient_degc: float, relative_humidity: float, solar_gain_w: float, occupants: int
) -> dict[str, Any]:
    """Changes of a scenario's weather and of who is in the car."""
    return {
        "scenario.climate.ambient_temperature_degc": ambient_degc,
        "scenario.climate.relative_humidity": relative_humidity,
        "scenario.climate.solar_gain_w": solar_gain_w,
        "scenario.climate.occupants": occupants,
    }


def used(vehicle: str, strategy: Mapping[str, bool | str]) -> dict[str, Any]:
    """Changes of what the rules may use: all sources, no store, battery isolated; nothing limits heat flows.

    Args:
        vehicle: Name or path of the car.
        strategy: What differs.
    """
    members = _core.vehicle_layout(vehicle)["members"]
    sources = {
        member["name"]: True for member in members if member["kind"] in ("motor", "transmission", "front-end")
    }
    plain: dict[str, bool | str] = {
        "battery": "isolate",
        "climate_control": "heat",
        "ptc": True,
        "heat_pump": True,
    }
    requests = {
        f"scenario.heat_demand.{member['name']}_w": 20000.0
        for member in members
        if member["connection"] is not None and member["kind"] != "battery"
    }
    wanted = {**plain, **sources, **strategy}
    return {f"scenario.strategy.{key}": value for key, value in wanted.items()} | requests


def number(vehicle: str, section: str, key: str) -> float:
    """A number of a vehicle's file or of those that it is based on.

    Raises:
        KeyError: None of them has it.
    """
    tables = toml_files.load("vehicle", vehicle)
    if key in tables.get(section, {}):
        return float(tables[section][key])
    return number(tables["base"], section, key)
