"""The plant: coolant loops, components and the heat that flows between them."""

from collections.abc import Mapping
from typing import Final

from hp_gym.pictures.rendering import colours, heat, loops
from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.canvas import Canvas
from hp_gym.pictures.rendering.colours import HEAT, INK, MUTED, OUTLINE, WHITE
from hp_gym.pictures.rendering.loops import CHILLER, HTC, Loop
from hp_gym.pictures.rendering.positions import MEMBERS, Member
from hp_gym.pictures.rendering.quantities import degc, kilowatt

NUMBER_OFFSET: Final = 15.0
"""From a rail to the number of a heat flow."""
ARROW_OFFSET: Final = 25.0
"""From a rail to the arrow of a heat flow."""
ARROW_MARGIN: Final = 5.0
"""From the arrow of a heat flow to the component."""


def draw(canvas: Canvas, now: Mapping[str, float]) -> None:
    """Draws loops and components."""
    for loop in loops.LOOPS:
        loops.draw(canvas, now, loop)
    loops.draw_exchanged(canvas, HTC, now["condenser_heat_flow_w"])
    loops.draw_exchanged(canvas, CHILLER, -now["evaporator_heat_flow_w"])
    for member in MEMBERS:
        _draw_member(canvas, member, now[member.temperature])
        _draw_heat_flows(canvas, now, member)
    _draw_ptc(canvas, now["ptc_power_w"])


def _draw_member(canvas: Canvas, member: Member, temperature_degc: float) -> None:
    fill = colours.of_temperature(temperature_degc)
    ink = colours.text_on(fill)
    half = at.MEMBER_HALF_WIDTH
    box = (member.x - half, at.MEMBER_TOP, member.x + half, at.MEMBER_BOTTOM)
    canvas.box(box, fill, radius=7.0, edge=OUTLINE, width=1.2)
    first_y = at.CENTRE_Y - (13.0 if len(member.label) == 1 else 19.0)
    for row, line in enumerate(member.label):
        canvas.text((member.x, first_y + 12.0 * row), line, 10.0, ink)
    canvas.text((member.x, at.CENTRE_Y + 14.0), degc(temperature_degc), 13.0, ink, bold=True)


def _draw_heat_flows(canvas: Canvas, now: Mapping[str, float], member: Member) -> None:
    if member.htc_heat is not None and loops.is_open(now, member, HTC):
        heat_w = now[member.htc_heat]
        _draw_heat(canvas, member.x, HTC, heat_w if member.feeds_htc else -heat_w)
    if loops.is_open(now, member, CHILLER):
        _draw_heat(canvas, member.x, CHILLER, sum(now[name] for name in member.chiller_heat))
    if loops.recovers_exhaust(now, member):
        canvas.text((member.x, at.CHILLER_RETURN_Y + at.CAPTION_OFFSET), "exhaust air", 9.0, MUTED)


def _draw_heat(canvas: Canvas, x: float, loop: Loop, heat_to_loop_w: float) -> None:
    """Draws a heat flow between a component and a loop, the number at the rail."""
    heat.draw_number(canvas, (x, loop.supply_y - NUMBER_OFFSET * loop.outward), heat_to_loop_w)
    member_end = (x, loop.member_y + ARROW_MARGIN * loop.outward)
    rail_end = (x, loop.supply_y - ARROW_OFFSET * loop.outward)
    heat.draw_arrow(canvas, member_end, rail_end, heat_to_loop_w)


def _draw_ptc(canvas: Canvas, power_w: float) -> None:
    on = power_w >= heat.VISIBLE_W
    fill, ink = (HEAT, INK) if on else (WHITE, MUTED)
    x, y = at.PTC_X, at.HTC_SUPPLY_Y
    canvas.box((x - 22.0, y - 15.0, x + 22.0, y + 15.0), fill, radius=4.0, edge=OUTLINE, width=1.2)
    canvas.text((x, y - 6.0), "PTC", 9.0, ink)
    canvas.text((x, y + 6.5), kilowatt(power_w) if on else "off", 9.0, ink, bold=on)
