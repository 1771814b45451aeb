"""The plant: components, coolant loops and the heat that flows between them."""

import math
from collections.abc import Mapping
from typing import Final

from hp_gym.rendering import colours
from hp_gym.rendering import layout as at
from hp_gym.rendering.canvas import Canvas, Point
from hp_gym.rendering.colours import CHILLER_NAME, HEAT, HEAT_EDGE, HTC_NAME, INK, MUTED, OUTLINE, WHITE
from hp_gym.rendering.layout import MEMBERS, Member
from hp_gym.rendering.quantities import degc, kilowatt

HTC: Final = 1.0
CHILLER: Final = 2.0

NUMBERS_RIGHT: Final = at.THERMAL_BATTERY.x - at.LEG_OFFSET - 5.0
"""Right end of the numbers between the exchangers and the first component."""
HTC_END_X: Final = at.AMBIENT.x + at.LEG_OFFSET + at.RAIL_OVERHANG
CHILLER_END_X: Final = at.TRANSMISSION.x + at.LEG_OFFSET + at.RAIL_OVERHANG

VISIBLE_HEAT_W: Final = 5.0
"""Smallest heat flow that gets an arrow."""
FULL_HEAT_W: Final = 8000.0
"""Heat flow with the widest arrow."""
ARROW_WIDTHS: Final = (1.5, 24.0)


def arrow_width(heat_w: float, widest: float = ARROW_WIDTHS[1]) -> float:
    """Returns the width of a heat flow's arrow."""
    narrowest = ARROW_WIDTHS[0]
    share = min(abs(heat_w) / FULL_HEAT_W, 1.0)
    return min(narrowest + (ARROW_WIDTHS[1] - narrowest) * share, widest)


def draw_labels(canvas: Canvas) -> None:
    """Draws what never changes: the names of the loops."""
    for x, y, name, colour in (
        (HTC_END_X, at.HTC_RETURN_Y - at.CAPTION_OFFSET, "High temperature circuit (HTC)", HTC_NAME),
        (CHILLER_END_X, at.CHILLER_RETURN_Y + at.CAPTION_OFFSET, "Chiller circuit", CHILLER_NAME),
    ):
        canvas.text((x, y), name, 10.0, colour, bold=True, anchor="rm")


def draw(canvas: Canvas, now: Mapping[str, float]) -> None:
    """Draws loops and components."""
    _draw_htc(canvas, now)
    _draw_chiller(canvas, now)
    for member in MEMBERS:
        _draw_member(canvas, now, member)
    _draw_ptc(canvas, now["ptc_power_w"])


def _draw_htc(canvas: Canvas, now: Mapping[str, float]) -> None:
    supply = colours.of_temperature(now["htc_supply_temperature_degc"])
    back = colours.of_temperature(now["htc_return_temperature_degc"])
    supply_y, return_y = at.HTC_SUPPLY_Y, at.HTC_RETURN_Y
    down: list[list[Point]] = []
    up: list[list[Point]] = []
    for member in MEMBERS:
        if member.htc_heat is None:
            continue
        left, right = member.x - at.LEG_OFFSET, member.x + at.LEG_OFFSET
        right_y = supply_y if member.feeds_htc else return_y
        legs = [[(left, supply_y), (left, at.MEMBER_TOP)], [(right, right_y), (right, at.MEMBER_TOP)]]
        if now[member.connection] != HTC:
            for start, end in legs:
                canvas.closed_pipe(start, end)
        elif member.feeds_htc:
            down += legs
        else:
            down.append(legs[0])
            up.append(legs[1])
    middle = (HTC_END_X, 0.5 * (supply_y + return_y))
    canvas.pipes([[(at.EXCHANGER_RIGHT, supply_y), (HTC_END_X, supply_y), middle]], supply, at.RAIL_WIDTH)
    canvas.pipes(down, supply, at.BRANCH_WIDTH)
    canvas.pipes(up, back, at.BRANCH_WIDTH, halo=True)
    canvas.pipes([[(at.EXCHANGER_RIGHT, return_y), (HTC_END_X, return_y), middle]], back, at.RAIL_WIDTH)
    _draw_turn(canvas, middle, colours.mean(supply, back))
    _draw_junctions(canvas, down, supply)
    _draw_junctions(canvas, up, back)
    _draw_directions(canvas, supply_y, return_y)
    _draw_loop_numbers(canvas, now, "htc", (return_y - at.CAPTION_OFFSET, supply_y + at.CAPTION_OFFSET))
    heat_w = now["condenser_heat_flow_w"]
    _draw_exchanged(canvas, heat_w, 0.5 * (supply_y + return_y), towards_loop=heat_w >= 0.0)


def _draw_chiller(canvas: Canvas, now: Mapping[str, float]) -> None:
    supply = colours.of_temperature(now["chiller_supply_temperature_degc"])
    back = colours.of_temperature(now["chiller_return_temperature_degc"])
    supply_y, return_y = at.CHILLER_SUPPLY_Y, at.CHILLER_RETURN_Y
    down: list[list[Point]] = []
    up: list[list[Point]] = []
    for member in MEMBERS:
        left, right = member.x - at.LEG_OFFSET, member.x + at.LEG_OFFSET
        up_leg = [(left, at.MEMBER_BOTTOM), (left, supply_y)]
        down_leg = [(right, at.MEMBER_BOTTOM), (right, return_y)]
        if feeds_chiller(now, member):
            up.append(up_leg)
            down.append(down_leg)
        else:
            for start, end in (up_leg, down_leg):
                canvas.closed_pipe(start, end)
    middle = (CHILLER_END_X, 0.5 * (supply_y + return_y))
    canvas.pipes([[(at.EXCHANGER_RIGHT, supply_y), (CHILLER_END_X, supply_y), middle]], supply, at.RAIL_WIDTH)
    canvas.pipes(up, supply, at.BRANCH_WIDTH)
    canvas.pipes(down, back, at.BRANCH_WIDTH, halo=True)
    canvas.pipes([[(at.EXCHANGER_RIGHT, return_y), (CHILLER_END_X, return_y), middle]], back, at.RAIL_WIDTH)
    _draw_turn(canvas, middle, colours.mean(supply, back))
    _draw_junctions(canvas, up, supply)
    _draw_junctions(canvas, down, back)
    _draw_directions(canvas, supply_y, return_y)
    _draw_loop_numbers(canvas, now, "chiller", (return_y + at.CAPTION_OFFSET, supply_y - at.CAPTION_OFFSET))
    heat_w = now["evaporator_heat_flow_w"]
    _draw_exchanged(canvas, heat_w, 0.5 * (supply_y + return_y), towards_loop=heat_w < 0.0)


def recovers_exhaust(now: Mapping[str, float], member: Member) -> bool:
    """Whether the chiller loop takes heat from the cabin's exhaust air rather than from the cabin."""
    return (
        member is at.CABIN and now[member.connection] != CHILLER and now["exhaust_recovery_heat_flow_w"] > 0.0
    )


def feeds_chiller(now: Mapping[str, float], member: Member) -> bool:
    """Whether a component is connected to the chiller loop."""
    return now[member.connection] == CHILLER or recovers_exhaust(now, member)


def _draw_junctions(canvas: Canvas, legs: list[list[Point]], colour: colours.Colour) -> None:
    # The outline is open where a pipe meets the rail: what flows is one.
    half, reach = 0.5 * at.BRANCH_WIDTH, 0.5 * at.RAIL_WIDTH + 1.5
    for leg in legs:
        for x, y in leg:
            if y < at.MEMBER_TOP:
                canvas.box((x - half, y, x + half, y + reach), colour)
            elif y > at.MEMBER_BOTTOM:
                canvas.box((x - half, y - reach, x + half, y), colour)


def _draw_turn(canvas: Canvas, middle: Point, colour: colours.Colour) -> None:
    """Draws where supply becomes return; it hides the outline between the two."""
    (x, y), half = middle, 0.5 * at.RAIL_WIDTH
    canvas.box((x - half, y - 5.0, x + half, y + 5.0), colour)


def _draw_directions(canvas: Canvas, supply_y: float, return_y: float) -> None:
    outward, homeward = (1.0, 0.0), (-1.0, 0.0)
    for x in (at.CABIN.x, at.BATTERY.x, at.AMBIENT.x):
        canvas.chevron((x + 0.5 * at.CHEVRON, supply_y), outward, at.CHEVRON, OUTLINE)
        canvas.chevron((x - 0.5 * at.CHEVRON, return_y), homeward, at.CHEVRON, OUTLINE)


def _draw_loop_numbers(
    canvas: Canvas, now: Mapping[str, float], loop: str, rows_y: tuple[float, float]
) -> None:
    for name, y in zip(("return", "supply"), rows_y, strict=True):
        temperature_degc = now[f"{loop}_{name}_temperature_degc"]
        canvas.text((at.EXCHANGER_RIGHT + 8.0, y), name, 9.0, MUTED, anchor="lm")
        canvas.text((NUMBERS_RIGHT, y), degc(temperature_degc), 10.0, INK, bold=True, anchor="rm")


def _draw_exchanged(canvas: Canvas, heat_w: float, y: float, *, towards_loop: bool) -> None:
    """Draws the heat flow between a loop and the refrigerant."""
    near, far = at.EXCHANGER_RIGHT + 8.0, at.EXCHANGER_RIGHT + 42.0
    visible = math.isfinite(heat_w) and abs(heat_w) >= VISIBLE_HEAT_W
    if visible:
        start, end = (near, far) if towards_loop else (far, near)
        canvas.arrow((start, y), (end, y), arrow_width(heat_w, 15.0), HEAT, HEAT_EDGE)
    ink = INK if visible else MUTED
    canvas.text((NUMBERS_RIGHT, y), kilowatt(abs(heat_w)), 10.0, ink, bold=True, anchor="rm")


def _draw_member(canvas: Canvas, now: Mapping[str, float], member: Member) -> None:
    temperature_degc = now[member.temperature]
    fill = colours.of_temperature(temperature_degc)
    ink = colours.text_on(fill)
    box = (
        member.x - at.MEMBER_HALF_WIDTH,
        at.MEMBER_TOP,
        member.x + at.MEMBER_HALF_WIDTH,
        at.MEMBER_BOTTOM,
    )
    canvas.box(box, fill, radius=7.0, edge=OUTLINE, width=1.2)
    first_y = at.CENTRE_Y - (13.0 if len(member.label) == 1 else 19.0)
    for row, line in enumerate(member.label):
        canvas.text((member.x, first_y + 12.0 * row), line, 10.0, ink)
    canvas.text((member.x, at.CENTRE_Y + 14.0), degc(temperature_degc), 13.0, ink, bold=True)
    if member.htc_heat is not None and now[member.connection] == HTC:
        heat_w = now[member.htc_heat]
        downwards = (heat_w < 0.0) == member.feeds_htc
        _draw_heat(canvas, member.x, heat_w, (at.HTC_SUPPLY_Y, at.MEMBER_TOP), downwards=downwards)
    if feeds_chiller(now, member):
        heat_w = sum(now[name] for name in member.chiller_heat)
        rows = (at.CHILLER_SUPPLY_Y, at.MEMBER_BOTTOM)
        _draw_heat(canvas, member.x, heat_w, rows, downwards=heat_w >= 0.0)
    if recovers_exhaust(now, member):
        canvas.text((member.x, at.CHILLER_RETURN_Y + at.CAPTION_OFFSET), "exhaust air", 9.0, MUTED)


def _draw_heat(
    canvas: Canvas, x: float, heat_w: float, rows: tuple[float, float], *, downwards: bool
) -> None:
    """Draws a heat flow between a rail and a component, the number at the rail."""
    rail_y, member_y = rows
    inward = 1.0 if member_y > rail_y else -1.0
    canvas.text((x, rail_y + 15.0 * inward), kilowatt(abs(heat_w)), 10.0, INK, bold=True)
    if not math.isfinite(heat_w) or abs(heat_w) < VISIBLE_HEAT_W:
        return
    ends = sorted((rail_y + 25.0 * inward, member_y - 5.0 * inward))
    top, bottom = ends
    start, end = (top, bottom) if downwards else (bottom, top)
    canvas.arrow((x, start), (x, end), arrow_width(heat_w), HEAT, HEAT_EDGE)


def _draw_ptc(canvas: Canvas, power_w: float) -> None:
    on = power_w > VISIBLE_HEAT_W
    y = at.HTC_SUPPLY_Y
    fill, ink = (HEAT, INK) if on else (WHITE, MUTED)
    canvas.box(
        (at.PTC_X - 22.0, y - 15.0, at.PTC_X + 22.0, y + 15.0), fill, radius=4.0, edge=OUTLINE, width=1.2
    )
    canvas.text((at.PTC_X, y - 6.0), "PTC", 9.0, ink)
    canvas.text((at.PTC_X, y + 6.5), kilowatt(power_w) if on else "off", 9.0, ink, bold=on)
