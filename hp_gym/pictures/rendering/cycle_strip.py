"""The drive cycle at the bottom, with a cursor."""

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.canvas import Canvas, Point
from hp_gym.pictures.rendering.colours import CARD, DRIVE, DRIVE_AHEAD, INK, MUTED, TRACK, WHITE, Colour
from hp_gym.pictures.rendering.quantities import number

LEFT: Final = 52.0
RIGHT: Final = at.WIDTH - 40.0
TOP: Final = at.STRIP_TOP + 22.0
BASE: Final = at.STRIP_TOP + 82.0
BOTTOM: Final = at.HEIGHT - 8.0
SPEED_STEP_KM_H: Final = 50.0
MOST_TIME_TICKS: Final = 9


class CycleStrip:
    """A drive cycle, one speed a second, and where its points lie.

    Args:
        speeds_m_s: Speed in every second.
    """

    def __init__(self, speeds_m_s: NDArray[np.float64]) -> None:
        self.duration_s = max(len(speeds_m_s) - 1, 1)
        speeds_km_h = 3.6 * speeds_m_s
        steps = max(math.ceil(float(speeds_km_h.max()) / SPEED_STEP_KM_H), 1)
        self.top_km_h = SPEED_STEP_KM_H * steps
        xs = LEFT + (RIGHT - LEFT) * np.arange(len(speeds_m_s)) / self.duration_s
        ys = BASE - (BASE - TOP) * speeds_km_h / self.top_km_h
        self._curve: list[Point] = list(zip(xs.tolist(), ys.tolist(), strict=True))

    def draw_frame(self, canvas: Canvas, *, driven: bool) -> None:
        """Draws the strip as it looks before it was driven, or after."""
        canvas.box((at.MARGIN, at.STRIP_TOP, at.WIDTH - at.MARGIN, BOTTOM), CARD, radius=8.0)
        canvas.text((LEFT, at.STRIP_TOP + 11.0), "Drive cycle [km/h]", 9.0, MUTED, anchor="lm")
        for speed_km_h in np.arange(0.0, self.top_km_h + 1.0, SPEED_STEP_KM_H).tolist():
            y = BASE - (BASE - TOP) * speed_km_h / self.top_km_h
            canvas.box((LEFT, y - 0.25, RIGHT, y + 0.25), TRACK)
            canvas.text((LEFT - 6.0, y), number(speed_km_h, 0), 9.0, MUTED, anchor="rm")
        for minute in range(0, self.duration_s // 60 + 1, self._minutes_per_tick()):
            x = LEFT + (RIGHT - LEFT) * 60.0 * minute / self.duration_s
            canvas.text((x, BASE + 11.0), f"{minute} min", 9.0, MUTED)
        fill: Colour = DRIVE if driven else DRIVE_AHEAD
        canvas.polygon([(LEFT, BASE), *self._curve, (RIGHT, BASE)], fill)

    def cursor_x(self, time_s: float) -> float:
        """Returns where a time lies."""
        return LEFT + (RIGHT - LEFT) * min(max(time_s / self.duration_s, 0.0), 1.0)

    def draw_cursor(self, canvas: Canvas, time_s: float, speed_m_s: float) -> None:
        """Draws the present moment."""
        x = self.cursor_x(time_s)
        canvas.box((x - 0.75, TOP - 4.0, x + 0.75, BASE), INK)
        if not math.isfinite(speed_m_s):
            return
        y = BASE - (BASE - TOP) * min(max(3.6 * speed_m_s / self.top_km_h, 0.0), 1.0)
        canvas.circle((x, y), 5.0, WHITE)
        canvas.circle((x, y), 3.8, INK)

    def _minutes_per_tick(self) -> int:
        minutes = self.duration_s / 60.0
        return next((step for step in (1, 2, 5, 10, 20, 30) if minutes / step <= MOST_TIME_TICKS), 60)
