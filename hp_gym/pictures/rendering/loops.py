"""Coolant loops, and lines of refrigerant to air: rails, pipes to the components and temperatures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from hp_gym.pictures.rendering import colours, heat
from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.canvas import Canvas, Point
from hp_gym.pictures.rendering.colours import (
    CHILLER_NAME,
    HTC_NAME,
    INK,
    MUTED,
    OUTLINE,
    REFRIGERANT,
    WHITE,
    Colour,
)
from hp_gym.pictures.rendering.plan import ABOVE
from hp_gym.pictures.rendering.quantities import degc

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hp_gym.pictures.rendering.plan import Leg, Line, Plan

Pipe: TypeAlias = tuple[Point, Point]
"""A pipe between a rail and a component, from the rail."""

TURN_HALF_LENGTH: Final = 5.0
MOST_MARKS: Final = 3
"""Marks of flow direction on a rail."""
AIR_EXCHANGER_HEIGHT: Final = 15.0
AIR_EXCHANGER_HALF_WIDTH: Final = 34.0


def recovers_exhaust(now: Mapping[str, float], line: Line, leg: Leg) -> bool:
    """Whether a loop takes heat from a cabin's exhaust air rather than from the cabin."""
    if leg.recovery is None or (leg.connection is not None and now[leg.connection] == line.number):
        return False
    return now[leg.recovery] > 0.0


def is_open(now: Mapping[str, float], line: Line, leg: Leg) -> bool:
    """Whether a line's coolant or refrigerant flows through a component."""
    if line.level is not None:
        return now["compressor_power_w"] > 0.0 and any(now[flow] > 0.0 for flow in leg.flows)
    if leg.connection is None or now[leg.connection] == line.number:
        return True
    return recovers_exhaust(now, line, leg)


def colour_of(line: Line) -> Colour:
    """Returns the colour of a line's name."""
    if line.level is not None:
        return REFRIGERANT
    return HTC_NAME if line.side == ABOVE else CHILLER_NAME


def draw_labels(canvas: Canvas, plan: Plan) -> None:
    """Draws what never changes: the names of the lines."""
    for line in plan.lines:
        beyond = any((other.side, other.track) == (line.side, line.track + 1) for other in plan.lines)
        y = line.return_y + at.CAPTION_OFFSET * line.side
        if line.from_left and beyond:
            # Left of all pipes that lead to the line beyond.
            x, y = plan.rail_left + 8.0, y + at.SECOND_ROW * line.side
            canvas.text((x, y), line.caption, 10.0, colour_of(line), bold=True, anchor="lm")
        elif line.from_left:
            canvas.text((line.right, y), line.caption, 10.0, colour_of(line), bold=True, anchor="rm")
        else:
            canvas.text((line.left, y), line.caption, 10.0, colour_of(line), bold=True, anchor="lm")


def draw(canvas: Canvas, now: Mapping[str, float], plan: Plan, line: Line) -> None:
    """Draws a line."""
    supply_legs: list[Pipe] = []
    return_legs: list[Pipe] = []
    for leg in line.legs:
        first, last = _pipes(line, leg)
        if not is_open(now, line, leg):
            canvas.closed_pipe(*first)
            canvas.closed_pipe(*last)
        else:
            supply_legs.append(first)
            (supply_legs if leg.series else return_legs).append(last)
    fills = _fills(now, line)
    _draw_pipes(
        canvas, line, fills, (supply_legs, return_legs), flows=bool(supply_legs) or line.level is None
    )
    if line.level is None:
        _draw_directions(canvas, plan, line, fills)
        _draw_temperatures(canvas, now, plan, line)
    for leg in line.legs:
        if leg.exchanger is not None:
            _draw_air_exchanger(canvas, now, line, leg)


def _fills(now: Mapping[str, float], line: Line) -> tuple[Colour, Colour]:
    if line.supply is None or line.back is None:
        fill = REFRIGERANT if now["compressor_power_w"] > 0.0 else WHITE
        return fill, fill
    return colours.of_temperature(now[line.supply]), colours.of_temperature(now[line.back])


def _pipes(line: Line, leg: Leg) -> tuple[Pipe, Pipe]:
    left, right = leg.x - at.LEG_OFFSET, leg.x + at.LEG_OFFSET
    right_y = line.supply_y if leg.series else line.return_y
    end_y = line.member_y + (line.side * AIR_EXCHANGER_HEIGHT if leg.exchanger is not None else 0.0)
    return ((left, line.supply_y), (left, end_y)), ((right, right_y), (right, end_y))


def _rails(line: Line) -> tuple[list[Point], list[Point]]:
    """Supply and return from their left ends; refrigerant comes from where its own pipes are."""
    middle_y = 0.5 * (line.supply_y + line.return_y)
    turn = (line.right, middle_y)
    lefts = (line.left, line.left)
    if line.level is not None:
        lefts = (at.VALVE_X, at.COMPRESSOR_X)
    elif line.plates and not line.from_left:
        lefts = (line.plates[0] + at.PLATE_PIPES[1], line.plates[0] + at.PLATE_PIPES[0])
    supply, back = (
        [(left, y), (line.right, y), turn]
        for left, y in zip(lefts, (line.supply_y, line.return_y), strict=True)
    )
    closed = not line.boxes and line.level is None and not (line.plates and not line.from_left)
    if closed:
        supply.insert(0, (line.left, middle_y))
        back.insert(0, (line.left, middle_y))
    return supply, back


def _draw_pipes(
    canvas: Canvas,
    line: Line,
    fills: tuple[Colour, Colour],
    legs: tuple[list[Pipe], list[Pipe]],
    *,
    flows: bool,
) -> None:
    supply_rail, return_rail = _rails(line)
    at_plates = [
        [
            [
                (right, at.CENTRE_Y - port * line.side),
                (right + x, at.CENTRE_Y - port * line.side),
                (right + x, y),
            ]
            for right in line.plates
        ]
        for x, y, port in (
            (at.PLATE_PIPES[1], line.supply_y, at.PLATE_PORT),
            (at.PLATE_PIPES[0], line.return_y, -at.PLATE_PORT),
        )
    ]
    if not flows:
        for start, end, _ in (supply_rail, return_rail):
            canvas.closed_pipe(start, end)
        return
    canvas.pipes([supply_rail], fills[0], at.RAIL_WIDTH)
    # Pipes bridge the lines between their own and the components, those of the return the supply too.
    canvas.pipes([*legs[0], *at_plates[0]], fills[0], at.BRANCH_WIDTH, halo=line.track > 0)
    canvas.pipes([*legs[1], *at_plates[1]], fills[1], at.BRANCH_WIDTH, halo=True)
    canvas.pipes([return_rail], fills[1], at.RAIL_WIDTH)
    _join(canvas, line, fills, legs)
    if supply_rail[0] == return_rail[0]:
        _draw_turn(canvas, supply_rail[0], fills)
    _draw_turn(canvas, supply_rail[-1], fills)


def _join(
    canvas: Canvas, line: Line, fills: tuple[Colour, Colour], legs: tuple[Sequence[Pipe], Sequence[Pipe]]
) -> None:
    """Takes away the outline where pipes meet rails."""
    half, rail_half = 0.5 * at.BRANCH_WIDTH, 0.5 * at.RAIL_WIDTH
    reach = (rail_half + 1.5) * -line.side
    for fill, some in zip(fills, legs, strict=True):
        for (x, y), _ in some:
            top, bottom = sorted((y, y + reach))
            canvas.box((x - half, top, x + half, bottom), fill)


def _draw_turn(canvas: Canvas, end: Point, fills: tuple[Colour, Colour]) -> None:
    x, y = end
    half = 0.5 * at.RAIL_WIDTH
    canvas.box((x - half, y - TURN_HALF_LENGTH, x + half, y + TURN_HALF_LENGTH), colours.mean(*fills))


def _draw_directions(canvas: Canvas, plan: Plan, line: Line, fills: tuple[Colour, Colour]) -> None:
    marks = [leg.x for leg in line.legs if leg.member in plan.marked][:MOST_MARKS]
    for fill, y, step in zip(fills, (line.supply_y, line.return_y), (1.0, -1.0), strict=True):
        for x in marks:
            tip = (x + 0.5 * at.CHEVRON * step, y)
            canvas.chevron(tip, (step, 0.0), at.CHEVRON, colours.text_on(fill))


def _draw_temperatures(canvas: Canvas, now: Mapping[str, float], plan: Plan, line: Line) -> None:
    assert line.supply is not None, "only coolant has temperatures"
    assert line.back is not None, "only coolant has temperatures"
    if not line.from_left:
        x, y = line.left, line.return_y + (at.CAPTION_OFFSET + at.SECOND_ROW) * line.side
        for word, column in (("supply", line.supply), ("return", line.back)):
            canvas.text((x, y), word, 9.0, MUTED, anchor="lm")
            canvas.text((x + 35.0, y), degc(now[column]), 10.0, INK, bold=True, anchor="lm")
            x += 92.0
        return
    for word, column, y in (
        ("return", line.back, line.return_y + at.CAPTION_OFFSET * line.side),
        ("supply", line.supply, line.supply_y - at.CAPTION_OFFSET * line.side),
    ):
        canvas.text((plan.rail_left + 8.0, y), word, 9.0, MUTED, anchor="lm")
        canvas.text((plan.numbers_right, y), degc(now[column]), 10.0, INK, bold=True, anchor="rm")


def _draw_air_exchanger(canvas: Canvas, now: Mapping[str, float], line: Line, leg: Leg) -> None:
    """Draws where refrigerant meets air, at the component's edge."""
    assert leg.exchanger is not None, "only refrigerant meets air"
    fill = colours.of_temperature(now[f"{line.level}_temperature_degc"]) if is_open(now, line, leg) else WHITE
    top, bottom = sorted((line.member_y, line.member_y + line.side * AIR_EXCHANGER_HEIGHT))
    half = AIR_EXCHANGER_HALF_WIDTH
    canvas.box((leg.x - half, top, leg.x + half, bottom), fill, radius=3.0, edge=OUTLINE, width=1.2)
    ink = MUTED if fill is WHITE else colours.text_on(fill)
    canvas.fitting_text((leg.x, 0.5 * (top + bottom)), leg.exchanger, 9.0, ink, 2.0 * half - 5.0)


def draw_exchanged(canvas: Canvas, now: Mapping[str, float], plan: Plan, line: Line) -> None:
    """Draws the heat flow between the refrigerant and a loop."""
    if not line.boxes:
        return
    to_loop_w = sum(now[box.flow] if box.level == "condensing" else -now[box.flow] for box in line.boxes)
    near, far = plan.rail_left + 8.0, plan.rail_left + 42.0
    y = 0.5 * (line.supply_y + line.return_y)
    heat.draw_arrow(canvas, (near, y), (far, y), to_loop_w)
    heat.draw_number(canvas, (plan.numbers_right, y), to_loop_w, anchor="rm")
