"""The refrigerant loop: evaporator, compressor, condenser and expansion valve."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from hp_gym.pictures.rendering import colours, loops
from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.colours import CLOSED, INK, MUTED, OUTLINE, REFRIGERANT, WHITE
from hp_gym.pictures.rendering.plan import ABOVE, BELOW
from hp_gym.pictures.rendering.quantities import UNKNOWN, degc, kilowatt, number

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hp_gym.pictures.rendering.canvas import Canvas
    from hp_gym.pictures.rendering.plan import Box, Line, Plan

COMPRESSOR_RADIUS: Final = 17.0
VALVE_SIZE: Final = 10.0
MARK: Final = 3.5
"""Size of a mark of flow direction."""
CONDENSER_BOTTOM: Final = at.MEMBER_TOP - at.FIRST_RAIL + at.EXCHANGER_MARGIN
EVAPORATOR_TOP: Final = at.MEMBER_BOTTOM + at.FIRST_RAIL - at.EXCHANGER_MARGIN
MIDDLE_X: Final = 0.5 * (at.COMPRESSOR_X + at.VALVE_X)


def draw_labels(canvas: Canvas) -> None:
    """Draws what never changes: names."""
    text_x = at.COMPRESSOR_X + 8.0
    canvas.text((text_x, at.CENTRE_Y - 27.0), "Compressor", 9.0, MUTED, anchor="lm")
    for row, line in enumerate(("Expansion", "valve")):
        canvas.text((at.VALVE_X + 16.0, at.CENTRE_Y - 6.0 + 12.0 * row), line, 9.0, MUTED, anchor="lm")
    canvas.text((MIDDLE_X + 4.0, at.CENTRE_Y + 12.0), "COP", 9.0, MUTED)


def draw(canvas: Canvas, now: Mapping[str, float], plan: Plan) -> None:
    """Draws the loop."""
    power_w = now["compressor_power_w"]
    running = power_w > 0.0
    _draw_pipes(canvas, now, plan, running=running)
    _draw_compressor(canvas, running=running)
    _draw_valve(canvas, running=running)
    for line in plan.lines:
        for box in line.boxes:
            flows = running and (not box.has_valve or now[box.flow] > 0.0)
            _draw_exchanger(canvas, line, box, now[f"{box.level}_temperature_degc"], running=flows)
    text = kilowatt(power_w) if running else "off"
    ink = INK if running else MUTED
    canvas.text((at.COMPRESSOR_X + 8.0, at.CENTRE_Y + 28.0), text, 10.0, ink, bold=True, anchor="lm")
    for name, y in (
        ("condensing_pressure_bar", CONDENSER_BOTTOM + 18.0),
        ("evaporating_pressure_bar", EVAPORATOR_TOP - 18.0),
    ):
        canvas.text((MIDDLE_X, y), f"{number(now[name]) if running else UNKNOWN} bar", 10.0, ink, bold=True)
    cop = number(now["cop"]) if running else UNKNOWN
    canvas.text((MIDDLE_X + 4.0, at.CENTRE_Y - 4.0), cop, 15.0, ink, bold=True)


def _end(lines: list[Line], side: float, *, compressor: bool) -> float:
    """Returns where the pipe of the compressor or the valve ends: at the last exchanger or rail of a side."""
    ends = []
    for line in lines:
        if line.side != side:
            continue
        if line.boxes:
            ends.append(line.supply_y - at.EXCHANGER_MARGIN * side)
        elif line.level is not None:
            ends.append(line.return_y if compressor else line.supply_y)
    return side * max((side * y for y in ends), default=side * at.CENTRE_Y)


def _draw_pipes(canvas: Canvas, now: Mapping[str, float], plan: Plan, *, running: bool) -> None:
    lines = list(plan.lines)
    to_air = [line for line in lines if line.level is not None]
    shut = [line for line in to_air if not any(loops.is_open(now, line, leg) for leg in line.legs)]
    flowing = [line for line in lines if line not in shut]
    for x, upwards in ((at.COMPRESSOR_X, True), (at.VALVE_X, False)):
        if shut or not running:
            ends = tuple((x, _end(lines, side, compressor=upwards)) for side in (ABOVE, BELOW))
            canvas.closed_pipe(*ends)
        if not running:
            continue
        ends = tuple((x, _end(flowing, side, compressor=upwards)) for side in (ABOVE, BELOW))
        canvas.pipes([ends], REFRIGERANT, at.RAIL_WIDTH)
        for line in to_air:
            if line not in shut:
                _join_rail(canvas, x, line.return_y if upwards else line.supply_y)
        for y in (CONDENSER_BOTTOM + 32.0, EVAPORATOR_TOP - 32.0):
            step = -1.0 if upwards else 1.0
            canvas.chevron((x, y + 0.5 * MARK * step), (0.0, step), MARK, WHITE)


def _join_rail(canvas: Canvas, x: float, y: float) -> None:
    """Takes away the outline where a pipe turns into a rail."""
    half = 0.5 * at.RAIL_WIDTH
    canvas.box((x - half, y - half, x + half + 2.0, y + half), REFRIGERANT)


def _draw_compressor(canvas: Canvas, *, running: bool) -> None:
    x, y = at.COMPRESSOR_X, at.CENTRE_Y
    radius = COMPRESSOR_RADIUS
    canvas.circle((x, y), radius, OUTLINE)
    canvas.circle((x, y), radius - 1.3, REFRIGERANT if running else WHITE)
    # The symbol of drawings: two lines that come closer as the gas is compressed.
    for side in (-1.0, 1.0):
        wide, narrow = (
            (x + side * 0.82 * radius, y + 0.5 * radius),
            (x + side * 0.42 * radius, y - 0.86 * radius),
        )
        canvas.line([wide, narrow], WHITE if running else CLOSED, 1.6)


def _draw_valve(canvas: Canvas, *, running: bool) -> None:
    x, y, size = at.VALVE_X, at.CENTRE_Y, VALVE_SIZE
    for grown, colour in ((1.3, OUTLINE), (0.0, REFRIGERANT if running else WHITE)):
        for side in (-1.0, 1.0):
            base = y + side * (size + grown)
            half = 0.8 * size + 1.6 * grown
            canvas.polygon([(x - half, base), (x + half, base), (x, y - 1.2 * side * grown)], colour)


def _draw_exchanger(canvas: Canvas, line: Line, box: Box, temperature_degc: float, *, running: bool) -> None:
    fill = colours.of_temperature(temperature_degc) if running else WHITE
    ink = colours.text_on(fill) if running else MUTED
    upper, lower = sorted((line.supply_y, line.return_y))
    top, bottom = upper - at.EXCHANGER_MARGIN, lower + at.EXCHANGER_MARGIN
    canvas.box(
        (at.EXCHANGER_LEFT, top, at.EXCHANGER_RIGHT, bottom), fill, radius=7.0, edge=OUTLINE, width=1.2
    )
    middle_x, middle_y = 0.5 * (at.EXCHANGER_LEFT + at.EXCHANGER_RIGHT), 0.5 * (top + bottom)
    canvas.text((middle_x, middle_y - 11.0), box.label, 10.0, ink)
    canvas.text(
        (middle_x, middle_y + 8.0), degc(temperature_degc) if running else "off", 13.0, ink, bold=True
    )
