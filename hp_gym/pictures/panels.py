"""What the picture of a run shows of a vehicle: panels, curves and their colours."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import cycle
from typing import TYPE_CHECKING, Final

from hp_gym.vehicle_layout import exchanger_label, in_order, short_heater, short_loop, spelled

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hp_gym.vehicle_layout import Branch, Layout, Loop

# Okabe and Ito's palette: distinct for colour-blind readers too.
BLACK, GREY, LIGHT = "#000000", "#7f7f7f", "#dddddd"
ORANGE, SKY, GREEN, BLUE, RED, PURPLE = "#e69f00", "#56b4e9", "#009e73", "#0072b2", "#d55e00", "#cc79a7"

_FIRST_LOOP: Final = {"hot": (RED, ORANGE), "cold": (BLUE, SKY)}
"""Colours of supply and return of the first loop of a side."""
_OTHER_LOOPS: Final = (GREEN, PURPLE, BLACK, GREY)

_EXCHANGER_COLOURS: Final = {"condensing": RED, "evaporating": BLUE}
_EXCHANGER_STYLES: Final = ("-", "--", "-.", ":")

_BRANCH_LOOKS: Final = {
    ("cabin", "hot"): (ORANGE, "-"),
    ("battery", "hot"): (PURPLE, "-"),
    ("front-end", "cold"): (SKY, "-"),
    ("front-end", "hot"): (SKY, "--"),
    ("motor", "cold"): (BLACK, "-"),
    ("battery", "cold"): (GREEN, "-"),
    ("cabin", "cold"): (GREY, "-"),
    ("transmission", "cold"): (PURPLE, "--"),
    ("store", "hot"): (GREEN, "--"),
    ("store", "cold"): (BLUE, "--"),
    ("plate", "cold"): (RED, "--"),
}
"""Colour and style of a branch by the kind of its member and the side of its loop."""
_FURTHER_STYLES: Final = ("-.", ":")
_HEATER_COLOURS: Final = (RED, ORANGE, PURPLE, BLACK)
_MASS_COLOURS: Final = (ORANGE, PURPLE, GREEN, BLUE, BLACK, RED)


@dataclass(frozen=True)
class Curve:
    """A column in a panel."""

    column: str
    label: str
    colour: str
    style: str = "-"
    width: float = 1.3


@dataclass(frozen=True)
class Panel:
    """Some curves with one axis."""

    title: str
    unit: str
    curves: Sequence[Curve]
    scale: float = 1.0
    limits: Sequence[str] = ()
    """Names of limits to draw as lines, where the vehicle has them."""
    only_while_running: bool = False
    """Whether the curves mean something only while the compressor runs."""
    hide_idle: bool = False
    """Whether to leave out curves that are zero throughout."""
    area: bool = False
    """Whether the first curve is filled down to zero."""
    comfort_band: bool = False
    """Whether the range in which the cabin is comfortable shows."""


@dataclass(frozen=True)
class Connections:
    """The last panel: which loop each member is connected to over time."""

    members: Sequence[tuple[str, str]]
    """Column and label of each member."""
    loops: Sequence[tuple[float, str, str]]
    """Value of the columns, label and colour of each loop."""


SPEED: Final = Panel("Speed", "km/h", [Curve("speed_m_s", "vehicle", GREY)], scale=3.6, area=True)
CHARGE: Final = Panel("State of charge", "%", [Curve("soc", "usable", GREEN)], scale=100.0)
DRIVE_POWERS: Final = Panel(
    "Drive",
    "kW",
    [Curve("battery_power_w", "battery", GREEN), Curve("traction_power_w", "traction", BLACK, width=0.8)],
    scale=1e-3,
)
PRESSURES: Final = Panel(
    "Refrigerant pressures, compressor on",
    "bar",
    [
        Curve("condensing_pressure_bar", "condensing", RED),
        Curve("evaporating_pressure_bar", "evaporating", BLUE),
    ],
    limits=("condensing_pressure_highest_bar",),
    only_while_running=True,
)


def of(layout: Layout) -> list[Panel | Connections]:
    """Returns the panels of a vehicle, row by row in two columns."""
    panels: list[Panel | Connections] = [SPEED, CHARGE, _comfort(layout), DRIVE_POWERS]
    if layout["loops"]:
        panels.append(_loop_temperatures(layout))
    panels.append(_thermal_powers(layout))
    if layout["refrigerates"]:
        panels.append(PRESSURES)
    heat_flows = _heat_flows(layout)
    if heat_flows.curves:
        panels.append(heat_flows)
    panels.append(_masses(layout))
    connections = _connections(layout)
    if connections.members:
        panels.append(connections)
    return panels


def loop_colours(layout: Layout) -> list[str]:
    """Returns a colour for each loop."""
    return [supply for (supply, _), _ in _loop_looks(layout["loops"])]


def _loop_looks(loops: Sequence[Loop]) -> list[tuple[tuple[str, str], str]]:
    """Colours of supply and return of each loop, and the style of the return."""
    looks, seen = [], set()
    others = cycle(_OTHER_LOOPS)
    for loop in loops:
        if loop["side"] in seen:
            colour = next(others)
            looks.append(((colour, colour), "--"))
        else:
            looks.append((_FIRST_LOOP[loop["side"]], "-"))
        seen.add(loop["side"])
    return looks


def _comfort(layout: Layout) -> Panel:
    cabins = [member for member in layout["members"] if member["kind"] == "cabin"]
    batteries = [member for member in layout["members"] if member["kind"] == "battery"]
    curves = [
        Curve(str(member["temperature"]), member["label"], colour)
        for members, colours in ((cabins, (RED, ORANGE, PURPLE, BLACK)), (batteries, (BLUE, SKY)))
        for member, colour in zip(members, cycle(colours), strict=False)
    ]
    curves.append(Curve("ambient_temperature_degc", "ambient", GREY, "--"))
    return Panel("Cabin and battery", "°C", curves, comfort_band=True)


def _masses(layout: Layout) -> Panel:
    masses = [
        member
        for member in layout["members"]
        if member["temperature"] is not None and member["kind"] not in {"cabin", "battery"}
    ]
    title = " and ".join(["Powertrain", *(member["label"] for member in masses if member["kind"] == "store")])
    curves = [
        Curve(str(member["temperature"]), spelled(member["name"]), colour)
        for member, colour in zip(masses, cycle(_MASS_COLOURS), strict=False)
    ]
    return Panel(title, "°C", curves)


def _loop_temperatures(layout: Layout) -> Panel:
    curves = []
    for loop, (colours, style) in zip(layout["loops"], _loop_looks(layout["loops"]), strict=True):
        name = short_loop(layout, loop)
        curves.append(Curve(loop["supply"], f"{name} supply", colours[0]))
        curves.append(Curve(loop["return"], f"{name} return", colours[1], style))
    limits = [
        f"{loop['name']}_supply_{end}_degc" for loop in layout["loops"] for end in ("highest", "lowest")
    ]
    return Panel("Coolant loops", "°C", curves, limits=limits)


def _thermal_powers(layout: Layout) -> Panel:
    curves = [
        Curve(heater["power"], short_heater(heater), colour)
        for heater, colour in zip(layout["heaters"], cycle(_HEATER_COLOURS), strict=False)
    ]
    if layout["refrigerates"]:
        curves.append(Curve("compressor_power_w", "compressor", BLUE))
    curves.append(Curve("auxiliary_power_w", "auxiliary", GREY))
    return Panel("Electrical power of the thermal system", "kW", curves, scale=1e-3)


def _heat_flows(layout: Layout) -> Panel:
    curves: list[Curve] = []
    for level, colour in _EXCHANGER_COLOURS.items():
        exchangers = [each for each in layout["exchangers"] if each["level"] == level]
        curves += [
            Curve(each["flow"], exchanger_label(layout, each), colour, style)
            for each, style in zip(exchangers, cycle(_EXCHANGER_STYLES), strict=False)
        ]
    taken: dict[tuple[str, str], int] = {}
    for branch in layout["branches"]:
        kind = next(each["kind"] for each in layout["members"] if each["name"] == branch["member"])
        side = next(each["side"] for each in layout["loops"] if each["name"] == branch["loop"])
        colour, style = _BRANCH_LOOKS.get((kind, side), (BLACK, "--"))
        count = taken[kind, side] = taken.get((kind, side), 0) + 1
        if count > 1:
            style = _FURTHER_STYLES[count % 2]
        curves.append(Curve(branch["flow"], _branch_label(layout, branch, kind), colour, style))
    return Panel("Heat flows", "kW", curves, scale=1e-3, hide_idle=True)


def _branch_label(layout: Layout, branch: Branch, kind: str) -> str:
    """Says from or to whom heat flows, and which loop it is where that leaves a choice."""
    loop = next(short_loop(layout, each) for each in layout["loops"] if each["name"] == branch["loop"])
    name = spelled(branch["member"])
    if kind == "store":
        return f"{name}, {loop}"
    alike = [
        each
        for each in layout["branches"]
        if (each["member"], each["direction"]) == (branch["member"], branch["direction"])
    ]
    words = f"{'to' if branch['direction'] == 'out-of-loop' else 'from'} {name}"
    return words if len(alike) == 1 else f"{words}, {loop}"


def _connections(layout: Layout) -> Connections:
    return Connections(
        [
            (member["connection"], spelled(member["name"]))
            for member in in_order(layout)
            if member["connection"] is not None
        ],
        [
            (number, loop["label"], colour)
            for number, (loop, colour) in enumerate(
                zip(layout["loops"], loop_colours(layout), strict=True), start=1
            )
        ],
    )
