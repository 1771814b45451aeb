"""The instruments at the right and the line at the top."""

import math
from collections.abc import Mapping
from typing import Final

from hp_gym.pictures.rendering import colours
from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.canvas import Box, Canvas, Point
from hp_gym.pictures.rendering.colours import CARD, ELECTRIC, HEAT, HEAT_EDGE, INK, MUTED, TRACK, WHITE
from hp_gym.pictures.rendering.heat import arrow_width
from hp_gym.pictures.rendering.quantities import clock, degc, kilowatt, number

CABIN_TOP: Final = 52.0
BATTERY_TOP: Final = 140.0
CHARGE_TOP: Final = 228.0
POWER_TOP: Final = 306.0
GAUGE_HEIGHT: Final = 78.0
CHARGE_HEIGHT: Final = 68.0
POWER_HEIGHT: Final = 108.0
PADDING: Final = 12.0

TITLE: Final = "EV heat pump"
HEADER_LINE: Final = 27.0
MODES: Final = {1.0: "heating", 2.0: "air conditioning"}
"""What the cabin's connection is for."""

GAUGE_RANGE_DEGC: Final = (-20.0, 60.0)
GAUGE_STRIPES: Final = 96
COMPRESSOR_FULL_W: Final = 6000.0
PTC_FULL_W: Final = 6000.0

LEFT: Final = at.SIDE_LEFT + PADDING
RIGHT: Final = at.SIDE_RIGHT - PADDING


def draw_frame(canvas: Canvas) -> None:
    """Draws what never changes: cards, names, legend."""
    canvas.text((at.MARGIN, HEADER_LINE), TITLE, 16.0, INK, bold=True, anchor="ls")
    canvas.box((at.MARGIN, at.HEADER_BASE, at.WIDTH - at.MARGIN, at.HEADER_BASE + 1.0), TRACK)
    for top, height, name in (
        (CABIN_TOP, GAUGE_HEIGHT, "Cabin"),
        (BATTERY_TOP, GAUGE_HEIGHT, "Battery"),
        (CHARGE_TOP, CHARGE_HEIGHT, "SOC"),
        (POWER_TOP, POWER_HEIGHT, ""),
    ):
        canvas.box((at.SIDE_LEFT, top, at.SIDE_RIGHT, top + height), CARD, radius=8.0)
        canvas.text((LEFT, top + 18.0), name, 11.0, INK, anchor="lm")
    for top in (CABIN_TOP, BATTERY_TOP):
        _draw_scale(canvas, (LEFT, top + 38.0, RIGHT, top + 46.0), GAUGE_RANGE_DEGC)
    _draw_legend(canvas)


def draw(
    canvas: Canvas, now: Mapping[str, float], cabin_target_degc: float, battery_target_degc: float
) -> None:
    """Draws the instruments."""
    _draw_header(canvas, now)
    _draw_gauge(canvas, CABIN_TOP, now["cabin_temperature_degc"], cabin_target_degc)
    _draw_gauge(canvas, BATTERY_TOP, now["battery_temperature_degc"], battery_target_degc)
    soc = now["soc"]
    _draw_bar(canvas, CHARGE_TOP + 34.0, soc, colours.REFRIGERANT)
    canvas.text((RIGHT, CHARGE_TOP + 18.0), f"{number(100.0 * soc)} %", 13.0, INK, bold=True, anchor="rm")
    power_w = now["battery_power_w"]
    text = f"{'charging' if power_w < 0.0 else 'discharging'} {kilowatt(abs(power_w))}"
    canvas.text((LEFT, CHARGE_TOP + 54.0), text, 9.0, MUTED, anchor="lm")
    for row, (name, column, full_w, colour) in enumerate(
        (
            ("Compressor", "compressor_power_w", COMPRESSOR_FULL_W, ELECTRIC),
            ("PTC heater", "ptc_power_w", PTC_FULL_W, HEAT),
        )
    ):
        y = POWER_TOP + 18.0 + 48.0 * row
        canvas.text((LEFT, y), name, 11.0, INK, anchor="lm")
        canvas.text((RIGHT, y), kilowatt(now[column]), 13.0, INK, bold=True, anchor="rm")
        _draw_bar(canvas, y + 16.0, now[column] / full_w, colour)


def _draw_header(canvas: Canvas, now: Mapping[str, float]) -> None:
    cells = (
        (clock(now["time_s"]), "min"),
        (number(3.6 * now["speed_m_s"], 0), "km/h"),
        (number(now["ambient_temperature_degc"], 0), "°C outside"),
    )
    mode = MODES.get(now["cabin_connection"], "")
    canvas.text(
        (at.MARGIN + canvas.text_width(TITLE, 16.0, bold=True) + 12.0, HEADER_LINE),
        mode,
        12.0,
        MUTED,
        anchor="ls",
    )
    x = at.WIDTH - at.MARGIN
    for value, unit in cells:
        canvas.text((x, HEADER_LINE), unit, 10.0, MUTED, anchor="rs")
        x -= canvas.text_width(unit, 10.0) + 5.0
        canvas.text((x, HEADER_LINE), value, 16.0, INK, bold=True, anchor="rs")
        x -= canvas.text_width(value, 16.0, bold=True) + 26.0


def _draw_scale(canvas: Canvas, box: Box, ends_degc: Point) -> None:
    """Draws a bar in the colours of temperature."""
    left, top, right, bottom = box
    step = (right - left) / GAUGE_STRIPES
    low, high = ends_degc
    for stripe in range(GAUGE_STRIPES):
        middle = low + (high - low) * (stripe + 0.5) / GAUGE_STRIPES
        canvas.box(
            (left + stripe * step, top, left + (stripe + 1) * step, bottom), colours.of_temperature(middle)
        )


def _draw_gauge(canvas: Canvas, top: float, temperature_degc: float, target_degc: float) -> None:
    canvas.text((RIGHT, top + 18.0), degc(temperature_degc), 13.0, INK, bold=True, anchor="rm")
    low, high = GAUGE_RANGE_DEGC

    def along(value_degc: float) -> float:
        return LEFT + (RIGHT - LEFT) * min(max((value_degc - low) / (high - low), 0.0), 1.0)

    if math.isfinite(target_degc):
        x = along(target_degc)
        canvas.box((x - 1.0, top + 34.0, x + 1.0, top + 51.0), INK)
        canvas.text((x, top + 61.0), f"target {number(target_degc, 0)} °C", 9.0, MUTED)
    if math.isfinite(temperature_degc):
        x = along(temperature_degc)
        canvas.circle((x, top + 42.0), 6.5, WHITE)
        canvas.circle((x, top + 42.0), 5.5, INK)
        canvas.circle((x, top + 42.0), 4.0, colours.of_temperature(temperature_degc))


def _draw_bar(canvas: Canvas, y: float, share: float, colour: colours.Colour) -> None:
    canvas.box((LEFT, y, RIGHT, y + 8.0), TRACK, radius=4.0)
    if math.isfinite(share) and share > 0.0:
        length = max((RIGHT - LEFT) * min(share, 1.0), 8.0)
        canvas.box((LEFT, y, LEFT + length, y + 8.0), colour, radius=4.0)


def _draw_legend(canvas: Canvas) -> None:
    left, right = at.LEGEND_LEFT, at.LEGEND_RIGHT
    canvas.text((left, 62.0), "Temperature [°C]", 9.0, MUTED, anchor="lm")
    middle = 0.5 * (left + right)
    lowest, neutral, highest = colours.LOWEST_DEGC, colours.NEUTRAL_DEGC, colours.HIGHEST_DEGC
    _draw_scale(canvas, (left, 72.0, middle, 80.0), (lowest, neutral))
    _draw_scale(canvas, (middle, 72.0, right, 80.0), (neutral, highest))
    for value, x, anchor in ((lowest, left, "lm"), (neutral, middle, "mm"), (highest, right, "rm")):
        canvas.text((x, 90.0), number(value, 0), 9.0, MUTED, anchor=anchor)
    canvas.text((left, 116.0), "Heat flow", 9.0, MUTED, anchor="lm")
    for heat_kw, x in ((1.0, left + 56.0), (5.0, left + 106.0)):
        canvas.arrow((x, 116.0), (x + 20.0, 116.0), arrow_width(1e3 * heat_kw), HEAT, HEAT_EDGE)
        canvas.text((x + 12.0, 136.0), f"{number(heat_kw, 0)} kW", 9.0, MUTED)
    canvas.text((left, 160.0), "Pipe", 9.0, MUTED, anchor="lm")
    canvas.pipes(
        [[(left + 32.0, 160.0), (left + 50.0, 160.0)]], colours.of_temperature(50.0), at.BRANCH_WIDTH
    )
    canvas.text((left + 58.0, 160.0), "open", 9.0, MUTED, anchor="lm")
    canvas.closed_pipe((left + 92.0, 160.0), (left + 111.0, 160.0))
    canvas.text((left + 115.0, 160.0), "shut", 9.0, MUTED, anchor="lm")
