"""The plant: coolant loops, components and the heat that flows between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from hp_gym.pictures.rendering import colours, heat, loops
from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.colours import HEAT, INK, MUTED, OUTLINE, WHITE
from hp_gym.pictures.rendering.quantities import degc, kilowatt

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hp_gym.pictures.rendering.canvas import Canvas
    from hp_gym.pictures.rendering.plan import Leg, Line, Place, Plan

NUMBER_OFFSET: Final = 15.0
"""From a rail to the number of a heat flow."""
ARROW_OFFSET: Final = 25.0
"""From a rail to the arrow of a heat flow."""
ARROW_MARGIN: Final = 5.0
"""From the arrow of a heat flow to the component, or to the line before it."""
STANDING_HEATER_OFFSET: Final = 45.0
"""From a component to the middle of a heater on it."""


def draw(canvas: Canvas, now: Mapping[str, float], plan: Plan) -> None:
    """Draws loops and components."""
    for line in plan.lines:
        loops.draw(canvas, now, plan, line)
        loops.draw_exchanged(canvas, now, plan, line)
    for place in plan.places:
        _draw_place(canvas, place, None if place.temperature is None else now[place.temperature])
        for x, label, power in place.heaters:
            y = at.MEMBER_TOP - STANDING_HEATER_OFFSET
            _draw_heater(canvas, (x, y), label, now[power])
            ends = (x, y + at.HEATER_HALF_HEIGHT + 3.0), (x, at.MEMBER_TOP - ARROW_MARGIN)
            heat.draw_arrow(canvas, *ends, now[power])
    for line in plan.lines:
        for leg in line.legs:
            _draw_heat_flow(canvas, now, line, leg)
        for x, label, power in line.heaters:
            _draw_heater(canvas, (x, line.supply_y), label, now[power])


def _draw_place(canvas: Canvas, place: Place, temperature_degc: float | None) -> None:
    fill = WHITE if temperature_degc is None else colours.of_temperature(temperature_degc)
    ink = colours.text_on(fill)
    canvas.box(
        (place.left, at.MEMBER_TOP, place.right, at.MEMBER_BOTTOM), fill, radius=7.0, edge=OUTLINE, width=1.2
    )
    width = place.right - place.left - 6.0
    first_y = (
        at.CENTRE_Y - (13.0 if len(place.label) == 1 else 19.0) + (13.0 if temperature_degc is None else 0.0)
    )
    for row, line in enumerate(place.label):
        canvas.fitting_text((place.x, first_y + 12.0 * row), line, 10.0, ink, width)
    if temperature_degc is None:
        return
    if place.kind == "front-end":
        # It has no temperature of its own; this is that of the air around the vehicle.
        canvas.text((place.x, at.CENTRE_Y + 14.0), f"air {degc(temperature_degc)}", 11.0, ink, bold=True)
    else:
        canvas.text((place.x, at.CENTRE_Y + 14.0), degc(temperature_degc), 13.0, ink, bold=True)


def _draw_heat_flow(canvas: Canvas, now: Mapping[str, float], line: Line, leg: Leg) -> None:
    """Draws the heat flow between a component and a line, the number at the rail."""
    if not loops.is_open(now, line, leg):
        return
    heat_w = sum(now[flow] for flow in leg.flows)
    to_line_w = heat_w if leg.to_line else -heat_w
    heat.draw_number(canvas, (leg.x, line.supply_y - NUMBER_OFFSET * line.side), to_line_w)
    near_y = line.near_y + (ARROW_MARGIN + (4.0 if line.track else 0.0)) * line.side
    if leg.exchanger is not None and not line.track:
        near_y += loops.AIR_EXCHANGER_HEIGHT * line.side
    heat.draw_arrow(canvas, (leg.x, near_y), (leg.x, line.supply_y - ARROW_OFFSET * line.side), to_line_w)
    if loops.recovers_exhaust(now, line, leg):
        y = line.return_y + at.CAPTION_OFFSET * line.side
        canvas.text((leg.x, y), "exhaust air", 9.0, MUTED)


def _draw_heater(canvas: Canvas, middle: tuple[float, float], label: str, power_w: float) -> None:
    on = power_w >= heat.VISIBLE_W
    fill, ink = (HEAT, INK) if on else (WHITE, MUTED)
    x, y = middle
    half, height = at.HEATER_HALF_WIDTH, at.HEATER_HALF_HEIGHT
    canvas.box((x - half, y - height, x + half, y + height), fill, radius=4.0, edge=OUTLINE, width=1.2)
    canvas.fitting_text((x, y - 6.0), label, 9.0, ink, 2.0 * half - 6.0)
    canvas.text((x, y + 6.5), kilowatt(power_w) if on else "off", 9.0, ink, bold=on)
