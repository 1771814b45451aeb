"""The modes of a vehicle: what feeds its heat pump, what takes heat, PTC, and how the battery is treated."""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

ISOLATED: Final = "isolated"

_FOLLOWED: Final = ("battery", "cabin", "plate")
"""Kinds of members that the rules connect: battery by treatment, cabin by need, plate with the battery."""

Layout = Mapping[str, Any]
"""What a vehicle is made of, as `_core.vehicle_layout` tells."""


@dataclass(frozen=True)
class Mode:
    """A combination that holds for a whole trip.

    Attributes:
        battery: Its treatment by the rules: `isolate`, `heat` or `source`.
        connections: Connection of each member that is held, by name.
        ptc: Whether heaters are allowed.
        heat_pump: Whether the compressor may run.
    """

    battery: str
    connections: tuple[tuple[str, str], ...]
    ptc: bool
    heat_pump: bool

    @property
    def name(self) -> str:
        """In words, as short as they go: `heat pump + PTC, battery heat, motor-chiller, ambient-chiller`."""
        machines = [word for word, used in (("heat pump", self.heat_pump), ("PTC", self.ptc)) if used]
        battery = [] if self.battery == "isolate" else [f"battery {self.battery}"]
        held = [f"{member}-{option}" for member, option in self.connections if option != ISOLATED]
        return ", ".join([" + ".join(machines), *battery, *held])

    def to_json(self) -> dict[str, Any]:
        """The mode as plain data."""
        return {
            "name": self.name,
            "battery": self.battery,
            "connections": dict(self.connections),
            "ptc": self.ptc,
            "heat_pump": self.heat_pump,
        }


def modes(layout: Layout) -> list[Mode]:
    """Lists all feasible modes of a vehicle.

    Feasible is what can move heat: a heat pump with a source for heating or a sink for cooling, or a heater.
    Members of loops without refrigerant (a radiator, what it cools) follow the rules.

    Args:
        layout: What the vehicle is made of.
    """
    return [*_with_heat_pump(layout), *_without_heat_pump(layout)]


def _with_heat_pump(layout: Layout) -> Iterator[Mode]:
    if not layout["refrigerates"]:
        return
    held = _held(layout)
    treatments, heaters = _treatments(layout), _heaters(layout)
    for battery, *rest in itertools.product(treatments, *held.values()):
        connections = tuple(zip(held, rest, strict=True))
        if _moves_heat(layout, battery, connections):
            for ptc in heaters:
                yield Mode(battery, connections, ptc, heat_pump=True)


def _without_heat_pump(layout: Layout) -> Iterator[Mode]:
    """A heater alone, with the battery heated or not and stores on its loop or not."""
    if not layout["heaters"]:
        return
    hot = {loop["name"] for loop in layout["loops"] if loop["side"] == "hot"}
    stores = {member["name"] for member in layout["members"] if member["kind"] == "store"}
    held = {
        member: [option for option in options if option == ISOLATED or (member in stores and option in hot)]
        for member, options in _held(layout).items()
    }
    treatments = [battery for battery in _treatments(layout) if battery != "source"]
    for battery, *rest in itertools.product(treatments, *held.values()):
        yield Mode(battery, tuple(zip(held, rest, strict=True)), ptc=True, heat_pump=False)


def _held(layout: Layout) -> dict[str, list[str]]:
    """Members whose connection is held, and their options: loops that refrigerant tempers."""
    tempered = {loop["name"] for loop in layout["loops"] if loop["exchanger"] is not None}
    found = {}
    for member in layout["members"]:
        if member["kind"] in _FOLLOWED or member["connection"] is None:
            continue
        options = [option for option in member["options"] if option == ISOLATED or option in tempered]
        if len(options) > 1:
            found[member["name"]] = options
    return found


def _treatments(layout: Layout) -> list[str]:
    """Ways to treat the battery that its connections allow."""
    batteries = {member["name"] for member in layout["members"] if member["kind"] == "battery"}
    branches = [branch for branch in layout["branches"] if branch["member"] in batteries]
    tempered = {loop["name"] for loop in layout["loops"] if loop["exchanger"] is not None}
    treatments = ["isolate"]
    if any(branch["direction"] == "out-of-loop" for branch in branches):
        treatments.append("heat")
    if any(branch["direction"] == "into-loop" and branch["loop"] in tempered for branch in branches):
        treatments.append("source")
    return treatments


def _heaters(layout: Layout) -> list[bool]:
    return [False, True] if layout["heaters"] else [False]


def _moves_heat(layout: Layout, battery: str, connections: tuple[tuple[str, str], ...]) -> bool:
    """Whether there is a source besides the cabin, or somewhere for the cabin's heat."""
    if battery == "source" or any(exchanger["side"] == "front-end" for exchanger in layout["exchangers"]):
        return True
    directions = {(branch["member"], branch["loop"]): branch for branch in layout["branches"]}
    sides = {loop["name"]: loop["side"] for loop in layout["loops"]}
    front_ends = {member["name"] for member in layout["members"] if member["kind"] == "front-end"}
    for member, option in connections:
        if option == ISOLATED:
            continue
        into_loop = directions[member, option]["direction"] == "into-loop"
        if (into_loop and sides[option] == "cold") or (not into_loop and member in front_ends):
            return True
    return False
