"""The instruments at the right and the line at the top."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from hp_gym.pictures.rendering import colours
from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.colours import CARD, ELECTRIC, HEAT, HEAT_EDGE, INK, MUTED, TRACK, WHITE
from hp_gym.pictures.rendering.heat import arrow_width
from hp_gym.pictures.rendering.quantities import clock, degc, kilowatt, number
from hp_gym.vehicle_layout import capitalised

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hp_gym.pictures.rendering.canvas import Box, Canvas, Point
    from hp_gym.vehicle_layout import Layout

CABIN_TOP: Final = 52.0
BATTERY_TOP: Final = 140.0
CHARGE_TOP: Final = 228.0
POWER_TOP: Final = 306.0
GAUGE_HEIGHT: Final = 78.0
CHARGE_HEIGHT: Final = 68.0
POWER_ROW: Final = 48.0
POWERS_HEIGHT: Final = 2.0 * POWER_ROW
"""What the rows of powers take; more than two stand closer."""
PADDING: Final = 12.0

TITLE: Final = "EV heat pump"
HEADER_LINE: Final = 27.0
MODES: Final = {"hot": "heating", "cold": "air conditioning"}
"""What a loop is for that the cabin is connected to."""

GAUGE_RANGE_DEGC: Final = (-20.0, 60.0)
GAUGE_STRIPES: Final = 96
FULL_W: Final = 6000.0

LEFT: Final = at.SIDE_LEFT + PADDING
RIGHT: Final = at.SIDE_RIGHT - PADDING


@dataclass(frozen=True)
class Instruments:
    """What the instruments of a vehicle show.

    Attributes:
        cabin: Label and column of the temperature of the cabin that counts for comfort.
        battery: Label and column of the temperature of the battery.
        powers: Label, column and colour of each power.
    """

    cabin: tuple[str, str]
    battery: tuple[str, str]
    powers: tuple[tuple[str, str, colours.Colour], ...]

    @classmethod
    def of(cls, layout: Layout) -> Instruments:
        """Returns those of a vehicle."""
        cabin = next(each for each in layout["cabins"] if each["comfort"])
        labels = {each["name"]: capitalised(each["label"]) for each in layout["members"]}
        battery = next(each for each in layout["members"] if each["kind"] == "battery")
        compressor = [("Compressor", "compressor_power_w", ELECTRIC)] if layout["refrigerates"] else []
        heaters = [(capitalised(each["label"]), each["power"], HEAT) for each in layout["heaters"]]
        return cls(
            (labels[cabin["member"]], cabin["air"]),
            (capitalised(battery["label"]), str(battery["temperature"])),
            (*compressor, *heaters),
        )

    @property
    def row(self) -> float:
        """Height of a row of powers."""
        return min(POWER_ROW, POWERS_HEIGHT / max(len(self.powers), 1))


def draw_frame(canvas: Canvas, shown: Instruments, *, legend_above_components: bool) -> None:
    """Draws what never changes: cards, names, legend."""
    canvas.text((at.MARGIN, HEADER_LINE), TITLE, 16.0, INK, bold=True, anchor="ls")
    canvas.box((at.MARGIN, at.HEADER_BASE, at.WIDTH - at.MARGIN, at.HEADER_BASE + 1.0), TRACK)
    cards = [
        (CABIN_TOP, GAUGE_HEIGHT, shown.cabin[0]),
        (BATTERY_TOP, GAUGE_HEIGHT, shown.battery[0]),
        (CHARGE_TOP, CHARGE_HEIGHT, "SOC"),
    ]
    if shown.powers:
        cards.append((POWER_TOP, 12.0 + shown.row * len(shown.powers), ""))
    for top, height, name in cards:
        canvas.box((at.SIDE_LEFT, top, at.SIDE_RIGHT, top + height), CARD, radius=8.0)
        canvas.text((LEFT, top + 18.0), name, 11.0, INK, anchor="lm")
    for top in (CABIN_TOP, BATTERY_TOP):
        _draw_scale(canvas, (LEFT, top + 38.0, RIGHT, top + 46.0), GAUGE_RANGE_DEGC)
    (_draw_legend if legend_above_components else _draw_legend_in_header)(canvas)


def draw(
    canvas: Canvas,
    now: Mapping[str, float],
    layout: Layout,
    shown: Instruments,
    targets_degc: tuple[float, float],
) -> None:
    """Draws the instruments; the targets are those of cabin and battery."""
    _draw_header(canvas, now, layout)
    _draw_gauge(canvas, CABIN_TOP, now[shown.cabin[1]], targets_degc[0])
    _draw_gauge(canvas, BATTERY_TOP, now[shown.battery[1]], targets_degc[1])
    soc = now["soc"]
    _draw_bar(canvas, CHARGE_TOP + 34.0, soc, colours.REFRIGERANT)
    canvas.text((RIGHT, CHARGE_TOP + 18.0), f"{number(100.0 * soc)} %", 13.0, INK, bold=True, anchor="rm")
    power_w = now["battery_power_w"]
    text = f"{'charging' if power_w < 0.0 else 'discharging'} {kilowatt(abs(power_w))}"
    canvas.text((LEFT, CHARGE_TOP + 54.0), text, 9.0, MUTED, anchor="lm")
    share = shown.row / POWER_ROW
    for row, (name, column, colour) in enumerate(shown.powers):
        y = POWER_TOP + 2.0 + (16.0 + POWER_ROW * row) * share
        canvas.text((LEFT, y), name, 11.0, INK, anchor="lm")
        canvas.text((RIGHT, y), kilowatt(now[column]), 13.0, INK, bold=True, anchor="rm")
        _draw_bar(canvas, y + max(16.0 * share, 9.0), now[column] / FULL_W, colour)


def _mode(now: Mapping[str, float], layout: Layout) -> str:
    """Says what is done for the cabin that counts for comfort."""
    cabin = next(each["member"] for each in layout["cabins"] if each["comfort"])
    connection = next(each["connection"] for each in layout["members"] if each["name"] == cabin)
    if connection is not None and now[connection] > 0.0:
        place = int(now[connection]) - 1
        return MODES[layout["loops"][place]["side"]] if place < len(layout["loops"]) else ""
    into_air = {
        "condensing": MODES["hot"],
        "evaporating": MODES["cold"],
    }
    for exchanger in layout["exchangers"]:
        if exchanger["on"] == cabin and now[exchanger["flow"]] > 0.0:
            return into_air[exchanger["level"]]
    return ""


def _draw_header(canvas: Canvas, now: Mapping[str, float], layout: Layout) -> None:
    cells = (
        (clock(now["time_s"]), "min"),
        (number(3.6 * now["speed_m_s"], 0), "km/h"),
        (number(now["ambient_temperature_degc"], 0), "°C outside"),
    )
    mode = _mode(now, layout)
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


def _draw_legend_in_header(canvas: Canvas) -> None:
    """Draws the legend in one line, where the plant needs its place."""
    x, y = 258.0, HEADER_LINE - 5.0
    lowest, neutral, highest = colours.LOWEST_DEGC, colours.NEUTRAL_DEGC, colours.HIGHEST_DEGC
    middle, right = x + 50.0, x + 100.0
    _draw_scale(canvas, (x, y - 8.0, middle, y - 1.0), (lowest, neutral))
    _draw_scale(canvas, (middle, y - 8.0, right, y - 1.0), (neutral, highest))
    for value, place, anchor in ((lowest, x, "lm"), (neutral, middle, "mm"), (highest, right, "rm")):
        canvas.text((place, y + 6.0), f"{number(value, 0)}", 8.0, MUTED, anchor=anchor)
    canvas.text((right + 5.0, y - 4.5), "°C", 9.0, MUTED, anchor="lm")
    x = right + 36.0
    for heat_kw in (1.0, 5.0):
        canvas.arrow((x, y), (x + 20.0, y), arrow_width(1e3 * heat_kw), HEAT, HEAT_EDGE)
        canvas.text((x + 25.0, y), f"{number(heat_kw, 0)} kW", 9.0, MUTED, anchor="lm")
        x += 62.0
    canvas.pipes([[(x + 8.0, y), (x + 26.0, y)]], colours.of_temperature(50.0), at.BRANCH_WIDTH)
    canvas.text((x + 33.0, y), "open", 9.0, MUTED, anchor="lm")
    canvas.closed_pipe((x + 66.0, y), (x + 84.0, y))
    canvas.text((x + 89.0, y), "shut", 9.0, MUTED, anchor="lm")
