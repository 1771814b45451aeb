"""The two coolant loops: rails, pipes to the components and temperatures."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, TypeAlias

from hp_gym.pictures.rendering import colours, heat
from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.canvas import Canvas, Point
from hp_gym.pictures.rendering.colours import CHILLER_NAME, HTC_NAME, INK, MUTED, Colour
from hp_gym.pictures.rendering.positions import MEMBERS, Member
from hp_gym.pictures.rendering.quantities import degc

Leg: TypeAlias = tuple[Point, Point]
"""A pipe between a rail and a component, from the rail."""

TURN_HALF_LENGTH: Final = 5.0


@dataclass(frozen=True)
class Loop:
    """A coolant loop."""

    name: str
    """How the names of its signals begin."""
    caption: str
    colour: Colour
    connected: float
    """Value of a connection's signal that means this loop."""
    supply_y: float
    return_y: float
    member_y: float
    """Edge of the components that its pipes lead to."""
    end_x: float
    outward: float
    """Direction from its supply to its return."""


HTC: Final = Loop(
    "htc",
    "High temperature circuit (HTC)",
    HTC_NAME,
    1.0,
    at.HTC_SUPPLY_Y,
    at.HTC_RETURN_Y,
    at.MEMBER_TOP,
    at.AMBIENT.x + at.LEG_OFFSET + at.RAIL_OVERHANG,
    -1.0,
)
CHILLER: Final = Loop(
    "chiller",
    "Chiller circuit",
    CHILLER_NAME,
    2.0,
    at.CHILLER_SUPPLY_Y,
    at.CHILLER_RETURN_Y,
    at.MEMBER_BOTTOM,
    at.TRANSMISSION.x + at.LEG_OFFSET + at.RAIL_OVERHANG,
    1.0,
)
LOOPS: Final = (HTC, CHILLER)


def recovers_exhaust(now: Mapping[str, float], member: Member) -> bool:
    """Whether the chiller loop takes heat from the cabin's exhaust air rather than from the cabin."""
    if member is not at.CABIN or now[member.connection] == CHILLER.connected:
        return False
    return now["exhaust_recovery_heat_flow_w"] > 0.0


def is_open(now: Mapping[str, float], member: Member, loop: Loop) -> bool:
    """Whether a loop's coolant flows through a component."""
    if now[member.connection] == loop.connected:
        return loop is CHILLER or member.htc_heat is not None
    return loop is CHILLER and recovers_exhaust(now, member)


def draw_labels(canvas: Canvas) -> None:
    """Draws what never changes: the names of the loops."""
    for loop in LOOPS:
        y = loop.return_y + at.CAPTION_OFFSET * loop.outward
        canvas.text((loop.end_x, y), loop.caption, 10.0, loop.colour, bold=True, anchor="rm")


def draw(canvas: Canvas, now: Mapping[str, float], loop: Loop) -> None:
    """Draws a loop."""
    supply, back = (
        colours.of_temperature(now[f"{loop.name}_{side}_temperature_degc"]) for side in ("supply", "return")
    )
    supply_legs: list[Leg] = []
    return_legs: list[Leg] = []
    for member in MEMBERS:
        if loop is HTC and member.htc_heat is None:
            continue
        first, last = _legs(member, loop)
        if not is_open(now, member, loop):
            canvas.closed_pipe(*first)
            canvas.closed_pipe(*last)
        else:
            supply_legs.append(first)
            (supply_legs if _in_series(member, loop) else return_legs).append(last)
    _draw_pipes(canvas, loop, (supply, back), (supply_legs, return_legs))
    _draw_directions(canvas, loop, (supply, back))
    _draw_temperatures(canvas, now, loop)


def _in_series(member: Member, loop: Loop) -> bool:
    return loop is HTC and member.feeds_htc


def _legs(member: Member, loop: Loop) -> tuple[Leg, Leg]:
    left, right = member.x - at.LEG_OFFSET, member.x + at.LEG_OFFSET
    right_y = loop.supply_y if _in_series(member, loop) else loop.return_y
    return ((left, loop.supply_y), (left, loop.member_y)), ((right, right_y), (right, loop.member_y))


def _draw_pipes(
    canvas: Canvas, loop: Loop, fills: tuple[Colour, Colour], legs: tuple[list[Leg], list[Leg]]
) -> None:
    middle = (loop.end_x, 0.5 * (loop.supply_y + loop.return_y))
    supply_rail, return_rail = (
        [(at.EXCHANGER_RIGHT, y), (loop.end_x, y), middle] for y in (loop.supply_y, loop.return_y)
    )
    canvas.pipes([supply_rail], fills[0], at.RAIL_WIDTH)
    canvas.pipes(legs[0], fills[0], at.BRANCH_WIDTH)
    # The pipes of the return bridge the supply.
    canvas.pipes(legs[1], fills[1], at.BRANCH_WIDTH, halo=True)
    canvas.pipes([return_rail], fills[1], at.RAIL_WIDTH)
    # No outline separates what flows together.
    half, rail_half = 0.5 * at.BRANCH_WIDTH, 0.5 * at.RAIL_WIDTH
    reach = (rail_half + 1.5) * -loop.outward
    for fill, some in zip(fills, legs, strict=True):
        for (x, y), _ in some:
            top, bottom = sorted((y, y + reach))
            canvas.box((x - half, top, x + half, bottom), fill)
    x, y = middle
    turn = (x - rail_half, y - TURN_HALF_LENGTH, x + rail_half, y + TURN_HALF_LENGTH)
    canvas.box(turn, colours.mean(*fills))


def _draw_directions(canvas: Canvas, loop: Loop, fills: tuple[Colour, Colour]) -> None:
    for fill, y, step in zip(fills, (loop.supply_y, loop.return_y), (1.0, -1.0), strict=True):
        for member in (at.CABIN, at.BATTERY, at.AMBIENT):
            tip = (member.x + 0.5 * at.CHEVRON * step, y)
            canvas.chevron(tip, (step, 0.0), at.CHEVRON, colours.text_on(fill))


def _draw_temperatures(canvas: Canvas, now: Mapping[str, float], loop: Loop) -> None:
    for side, y in (
        ("return", loop.return_y + at.CAPTION_OFFSET * loop.outward),
        ("supply", loop.supply_y - at.CAPTION_OFFSET * loop.outward),
    ):
        text = degc(now[f"{loop.name}_{side}_temperature_degc"])
        canvas.text((at.EXCHANGER_RIGHT + 8.0, y), side, 9.0, MUTED, anchor="lm")
        canvas.text((at.NUMBERS_RIGHT, y), text, 10.0, INK, bold=True, anchor="rm")


def draw_exchanged(canvas: Canvas, loop: Loop, heat_to_loop_w: float) -> None:
    """Draws the heat flow between the refrigerant and a loop."""
    near, far = at.EXCHANGER_RIGHT + 8.0, at.EXCHANGER_RIGHT + 42.0
    y = 0.5 * (loop.supply_y + loop.return_y)
    heat.draw_arrow(canvas, (near, y), (far, y), heat_to_loop_w)
    heat.draw_number(canvas, (at.NUMBERS_RIGHT, y), heat_to_loop_w, anchor="rm")
