"""Heat flows: arrows whose width follows the flow, and numbers."""

import math
from typing import Final

from hp_gym.pictures.rendering.canvas import Canvas, Point
from hp_gym.pictures.rendering.colours import HEAT, HEAT_EDGE, INK, MUTED
from hp_gym.pictures.rendering.quantities import kilowatt

VISIBLE_W: Final = 5.0
"""Smallest heat flow that gets an arrow."""
FULL_W: Final = 10_000.0
"""Heat flow with the widest arrow."""
NARROWEST: Final = 1.5
WIDEST: Final = 22.0


def is_visible(heat_w: float) -> bool:
    """Whether a heat flow gets an arrow."""
    return math.isfinite(heat_w) and abs(heat_w) >= VISIBLE_W


def arrow_width(heat_w: float) -> float:
    """Returns the width of a heat flow's arrow."""
    return NARROWEST + (WIDEST - NARROWEST) * min(abs(heat_w) / FULL_W, 1.0)


def draw_arrow(canvas: Canvas, start: Point, end: Point, heat_w: float) -> None:
    """Draws a heat flow, the other way round where it is negative."""
    if is_visible(heat_w):
        ends = (start, end) if heat_w > 0.0 else (end, start)
        canvas.arrow(*ends, arrow_width(heat_w), HEAT, HEAT_EDGE)


def draw_number(canvas: Canvas, at: Point, heat_w: float, *, anchor: str = "mm") -> None:
    """Writes how large a heat flow is."""
    colour = INK if is_visible(heat_w) else MUTED
    canvas.text(at, kilowatt(abs(heat_w)), 10.0, colour, bold=True, anchor=anchor)
