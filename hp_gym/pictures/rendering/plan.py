"""What of a vehicle stands where: its components in a row, loops and lines of refrigerant above and below."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from hp_gym.pictures.rendering import positions as at

if TYPE_CHECKING:
    from hp_gym.vehicle_layout import Layout

ABOVE: Final = -1.0
BELOW: Final = 1.0
SIDES: Final = {"hot": ABOVE, "cold": BELOW, "condensing": ABOVE, "evaporating": BELOW}


@dataclass(frozen=True)
class Leg:
    """A pair of pipes between a line and a component."""

    member: str
    x: float
    flows: tuple[str, ...]
    """Columns of heat flows, which are added."""
    to_line: bool
    """Whether they count from the component to the line."""
    connection: str | None = None
    """Column of the component's connection; none where it is always connected."""
    recovery: str | None = None
    """Column of the heat flow from exhaust air, which passes here while the component is not connected."""
    series: bool = False
    exchanger: str | None = None
    """Label of the exchanger that refrigerant passes."""


@dataclass(frozen=True)
class Box:
    """An exchanger between the refrigerant loop and a line."""

    label: str
    flow: str
    level: str
    has_valve: bool


@dataclass(frozen=True)
class Line:
    """A coolant loop, or a line of refrigerant that reaches air."""

    name: str
    caption: str
    side: float
    """Direction from its supply to its return: above the components, or below."""
    number: float = 0.0
    """Value of a connection's column that means this loop."""
    supply: str | None = None
    back: str | None = None
    """Columns of its temperatures; none of a line of refrigerant."""
    level: str | None = None
    """Of a line of refrigerant: `condensing` or `evaporating`."""
    legs: tuple[Leg, ...] = ()
    boxes: tuple[Box, ...] = ()
    plates: tuple[float, ...] = ()
    """Right edges of the plates that it passes."""
    heaters: tuple[tuple[float, str, str], ...] = ()
    """Place, label and column of power of each heater."""
    track: int = 0
    left: float = 0.0
    right: float = 0.0
    from_left: bool = True
    """Whether it begins where all lines do; others have their temperatures beside their names."""

    @property
    def supply_y(self) -> float:
        """Where its supply lies."""
        return self.near_y + self.side * (at.FURTHER_RAIL if self.track else at.FIRST_RAIL)

    @property
    def return_y(self) -> float:
        """Where its return lies."""
        return self.supply_y + self.side * at.RAIL_DISTANCE

    @property
    def near_y(self) -> float:
        """Edge of the components, or return of the line before it."""
        beyond = self.track * at.RAIL_DISTANCE
        if self.track:
            beyond += at.FIRST_RAIL + (self.track - 1) * at.FURTHER_RAIL
        return self.member_y + self.side * beyond

    @property
    def member_y(self) -> float:
        """Edge of the components that its pipes lead to."""
        return at.MEMBER_TOP if self.side == ABOVE else at.MEMBER_BOTTOM


@dataclass(frozen=True)
class Place:
    """A component."""

    name: str
    label: tuple[str, ...]
    kind: str
    temperature: str | None
    left: float
    right: float
    heaters: tuple[tuple[float, str, str], ...]
    """Place, label and column of power of each heater that stands on it."""

    @property
    def x(self) -> float:
        """Its middle."""
        return 0.5 * (self.left + self.right)


@dataclass(frozen=True)
class Plan:
    """Where everything of a vehicle stands.

    Attributes:
        layout: What the vehicle is made of.
        places: Components from the left.
        lines: Coolant loops and lines of refrigerant, from the components outwards.
        rail_left: Where lines begin.
        marked: Components at which the direction of the flow is marked.
    """

    layout: Layout
    places: tuple[Place, ...]
    lines: tuple[Line, ...]
    rail_left: float
    marked: tuple[str, ...]

    @property
    def numbers_right(self) -> float:
        """Right end of the numbers before the first component."""
        return self.rail_left + at.NUMBERS_WIDTH

    @property
    def extent(self) -> tuple[float, float, float]:
        """Right end, top and bottom of all of it."""
        right = max([place.right for place in self.places] + [line.right for line in self.lines])
        above = [line.return_y for line in self.lines if line.side == ABOVE]
        below = [line.return_y for line in self.lines if line.side == BELOW]
        lowest = max([at.PLANT_BOTTOM, *(y + 40.0 for y in below)])
        return right, min([at.PLANT_TOP, *(y - 27.0 for y in above)]), lowest

    @property
    def scale(self) -> float:
        """How large the plant is drawn, at most 1."""
        right, top, bottom = self.extent
        return min(
            1.0,
            (at.PLANT_RIGHT - at.PLANT_LEFT) / (right - at.PLANT_LEFT),
            (at.PLANT_BOTTOM - at.PLANT_TOP) / (bottom - top),
        )

    @property
    def origin(self) -> tuple[float, float]:
        """Where the corner of the plant's own design units lies in those of the picture."""
        _, top, bottom = self.extent
        spare = at.PLANT_BOTTOM - at.PLANT_TOP - self.scale * (bottom - top)
        return at.PLANT_LEFT * (1.0 - self.scale), at.PLANT_TOP + 0.5 * spare - self.scale * top

    @property
    def leaves_room_for_legend(self) -> bool:
        """Whether the legend fits above the components at the right."""
        ends = [line.right for line in self.lines if line.side == ABOVE]
        ends += [x + at.HEATER_HALF_WIDTH for place in self.places for x, _, _ in place.heaters]
        x, y = self.origin
        free = max(ends, default=0.0) * self.scale + x < at.LEGEND_LEFT - 12.0
        return free and at.MEMBER_TOP * self.scale + y > at.LEGEND_BOTTOM

    def signals(self) -> tuple[str, ...]:
        """Names of the signals that a picture needs."""
        names = ["time_s", "speed_m_s", "soc", "battery_power_w", "ambient_temperature_degc"]
        if self.layout["refrigerates"]:
            names += ["cop", "compressor_power_w", "condensing_pressure_bar", "evaporating_pressure_bar"]
            names += ["condensing_temperature_degc", "evaporating_temperature_degc"]
        names += [heater["power"] for heater in self.layout["heaters"]]
        names += [each["flow"] for each in self.layout["exchangers"]]
        names += [place.temperature for place in self.places if place.temperature is not None]
        for line in self.lines:
            names += [name for name in (line.supply, line.back) if name is not None]
            for leg in line.legs:
                names += [*leg.flows, *([leg.connection] if leg.connection else [])]
        return tuple(dict.fromkeys(names))
