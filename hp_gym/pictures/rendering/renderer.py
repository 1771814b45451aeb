"""The picture as a whole."""

import math
import operator
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from hp_gym import vehicle_layout
from hp_gym.pictures.rendering import instruments, loops, refrigerant, schematic
from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.canvas import Canvas
from hp_gym.pictures.rendering.colours import WHITE
from hp_gym.pictures.rendering.cycle_strip import CycleStrip
from hp_gym.pictures.rendering.instruments import Instruments
from hp_gym.pictures.rendering.planner import plan_of

FINE_PIXELS: Final = 1280 * 720
"""Largest picture that is drawn three times as large, for smooth edges; others are drawn twice as large."""
SMALLEST: Final = (480, 270)
LARGEST: Final = (2560, 1440)


class Renderer:
    """Draws the plant at one moment, in the manner of Figures 2 and 6 to 9 of Jeffs et al. 2019.

    Args:
        width: Width of the picture in pixels, 480 to 2560.
        height: Height of the picture in pixels, 270 to 1440. The drawing is 16 to 9; the rest stays white.

    Raises:
        ValueError: The size is out of range.
        TypeError: The size is not of whole numbers.
    """

    def __init__(self, width: int = 960, height: int = 540) -> None:
        self.width = _pixels("width", width, SMALLEST[0], LARGEST[0])
        self.height = _pixels("height", height, SMALLEST[1], LARGEST[1])
        self._oversampling = 3 if self.width * self.height <= FINE_PIXELS else 2
        self._scale = self._oversampling * min(self.width / at.WIDTH, self.height / at.HEIGHT)
        self._origin = (
            0.5 * (self._oversampling * self.width - self._scale * at.WIDTH),
            0.5 * (self._oversampling * self.height - self._scale * at.HEIGHT),
        )
        self._told: Mapping[str, Any] | None = None

    def render(
        self,
        now: Mapping[str, float],
        speeds_m_s: Sequence[float] | NDArray[np.float64],
        target_degc: float = 22.0,
        battery_target_degc: float = math.nan,
        *,
        layout: Mapping[str, Any] | None = None,
    ) -> NDArray[np.uint8]:
        """Draws one moment.

        Args:
            now: Signals by name, such as `hp_gym.observe(run)` returns.
            speeds_m_s: The whole drive cycle, one speed a second.
            target_degc: Cabin temperature wanted.
            battery_target_degc: Battery temperature wanted, if any; the paper's rules heat it up to 20 degC.
            layout: What the vehicle is made of, as `Experiment.layout()` tells it; by default it is that of
                the default architecture.

        Returns:
            The picture, height x width x RGB; a new array each time.

        Raises:
            KeyError: A signal is missing.
            ValueError: The drive cycle is empty or holds something that is no speed.
        """
        self._plan_for(layout or {})
        missing = [name for name in self._plan.signals() if name not in now]
        if missing:
            msg = f"the picture needs signals that `now` lacks: {', '.join(missing)}"
            raise KeyError(msg)
        self._prepare(np.asarray(speeds_m_s, dtype=np.float64))
        image = self._ahead.copy()
        canvas = self._canvas(image)
        time_s = now["time_s"]
        if math.isfinite(time_s):
            driven = canvas.pixel_box((0.0, at.STRIP_TOP, self._strip.cursor_x(time_s), at.HEIGHT))
            image.paste(self._driven.crop(driven), driven[:2])
            self._strip.draw_cursor(canvas, time_s, now["speed_m_s"])
        plant = canvas.within(self._plan.scale, self._plan.origin)
        schematic.draw(plant, now, self._plan)
        if self._plan.layout["refrigerates"]:
            refrigerant.draw(plant, now, self._plan)
        instruments.draw(
            canvas, now, self._plan.layout, self._instruments, (target_degc, battery_target_degc)
        )
        return np.array(image.reduce(self._oversampling))

    def _plan_for(self, told: Mapping[str, Any]) -> None:
        """Draws what stays the same as long as the vehicle does."""
        if told == self._told:
            return
        self._plan = plan_of(vehicle_layout.typed(told))
        self._instruments = Instruments.of(self._plan.layout)
        self._frame = self._blank()
        canvas = self._canvas(self._frame)
        plant = canvas.within(self._plan.scale, self._plan.origin)
        loops.draw_labels(plant, self._plan)
        if self._plan.layout["refrigerates"]:
            refrigerant.draw_labels(plant)
        instruments.draw_frame(
            canvas, self._instruments, legend_above_components=self._plan.leaves_room_for_legend
        )
        self._told, self._cycle_key = told, b""

    def _prepare(self, speeds_m_s: NDArray[np.float64]) -> None:
        """Draws what stays the same as long as the drive cycle does."""
        if speeds_m_s.ndim != 1 or not speeds_m_s.size:
            msg = (
                f"speeds_m_s is one speed for each second of the drive cycle; its shape is {speeds_m_s.shape}"
            )
            raise ValueError(msg)
        if not np.isfinite(speeds_m_s).all() or speeds_m_s.min() < 0.0:
            msg = "speeds_m_s holds a speed that is negative or not finite"
            raise ValueError(msg)
        key = speeds_m_s.tobytes()
        if key == self._cycle_key:
            return
        self._strip = CycleStrip(speeds_m_s)
        self._ahead, self._driven = self._frame.copy(), self._blank()
        self._strip.draw_frame(self._canvas(self._ahead), driven=False)
        self._strip.draw_frame(self._canvas(self._driven), driven=True)
        self._cycle_key = key

    def _blank(self) -> Image.Image:
        return Image.new("RGB", (self._oversampling * self.width, self._oversampling * self.height), WHITE)

    def _canvas(self, image: Image.Image) -> Canvas:
        return Canvas(image, self._scale, self._origin)


def _pixels(name: str, size: int, lowest: int, highest: int) -> int:
    try:
        pixels = operator.index(size)
    except TypeError:
        msg = f"{name} is a whole number of pixels, not {size!r}"
        raise TypeError(msg) from None
    if not lowest <= pixels <= highest:
        msg = f"{name} is {pixels} pixels; {lowest} to {highest} are possible"
        raise ValueError(msg)
    return pixels
