"""What everything in the picture is drawn with: shapes and text in design units."""

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Final, TypeAlias

import matplotlib as mpl
from PIL import Image, ImageDraw, ImageFont

from hp_gym.pictures.rendering.colours import CLOSED, OUTLINE, WHITE, Colour

Point: TypeAlias = tuple[float, float]
Box: TypeAlias = tuple[float, float, float, float]

CLOSED_WIDTH: Final = 1.2
DASH: Final = (3.5, 3.0)
PIPE_EDGE: Final = 1.0
HALO: Final = 2.5


@lru_cache(maxsize=64)
def _font(bold: bool, pixels: float) -> ImageFont.FreeTypeFont:
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    path = Path(mpl.get_data_path()) / "fonts" / "ttf" / name
    # The basic layout is the same wherever Pillow was built.
    return ImageFont.truetype(path, pixels, layout_engine=ImageFont.Layout.BASIC)


class Canvas:
    """An image to draw on.

    Args:
        image: Image that receives what is drawn.
        scale: Pixels of the image per design unit.
        origin: Pixel at which the design's corner lies.
    """

    def __init__(self, image: Image.Image, scale: float, origin: Point) -> None:
        self.image = image
        self.scale = scale
        self.origin = origin
        self._draw = ImageDraw.Draw(image)

    def pixel(self, point: Point) -> Point:
        """Returns the pixel of a point."""
        return self.origin[0] + self.scale * point[0], self.origin[1] + self.scale * point[1]

    def within(self, scale: float, origin: Point) -> "Canvas":
        """Returns a canvas for a part of the design that has units of its own.

        Args:
            scale: Design units per unit of the part.
            origin: Where the part's corner lies.
        """
        return Canvas(self.image, self.scale * scale, self.pixel(origin))

    def pixel_box(self, box: Box) -> tuple[int, int, int, int]:
        """Returns the pixels of a box."""
        left, top = self.pixel(box[:2])
        right, bottom = self.pixel(box[2:])
        return round(left), round(top), round(right), round(bottom)

    def text(
        self, at: Point, text: str, size: float, colour: Colour, *, bold: bool = False, anchor: str = "mm"
    ) -> None:
        """Writes a line of text; the anchor is Pillow's: l, m, r across and t, m, s, b down."""
        self._draw.text(self.pixel(at), text, fill=colour, font=_font(bold, size * self.scale), anchor=anchor)

    def fitting_text(self, at: Point, text: str, size: float, colour: Colour, width: float) -> None:
        """Writes a line of text, smaller where it would be wider than that."""
        taken = self.text_width(text, size)
        self.text(at, text, size * min(1.0, width / max(taken, 1e-9)), colour)

    def text_width(self, text: str, size: float, *, bold: bool = False) -> float:
        """Returns the width that a line of text takes."""
        return float(_font(bold, size * self.scale).getlength(text)) / self.scale

    def box(
        self, box: Box, fill: Colour, *, radius: float = 0.0, edge: Colour | None = None, width: float = 1.0
    ) -> None:
        """Draws a box with round corners."""
        left, top, right, bottom = self.pixel_box(box)
        if right <= left or bottom <= top:
            return
        corners = (left, top, right - 1, bottom - 1)
        edge_pixels = 0 if edge is None else max(1, round(width * self.scale))
        self._draw.rounded_rectangle(corners, radius * self.scale, fill, edge, edge_pixels)

    def polygon(self, points: Sequence[Point], fill: Colour) -> None:
        """Draws a filled polygon."""
        self._draw.polygon([self.pixel(point) for point in points], fill=fill)

    def circle(self, centre: Point, radius: float, fill: Colour) -> None:
        """Draws a disc."""
        x, y = self.pixel(centre)
        size = radius * self.scale
        self._draw.ellipse((x - size, y - size, x + size, y + size), fill=fill)

    def line(self, points: Sequence[Point], colour: Colour, width: float) -> None:
        """Draws a line through points, round at its corners."""
        pixels = [self.pixel(point) for point in points]
        self._draw.line(pixels, fill=colour, width=max(1, round(width * self.scale)), joint="curve")

    def dashes(self, start: Point, end: Point, colour: Colour, width: float) -> None:
        """Draws a dashed line."""
        length = math.dist(start, end)
        step_x, step_y = (end[0] - start[0]) / length, (end[1] - start[1]) / length
        dash, gap = DASH
        for index in range(math.ceil(length / (dash + gap))):
            near = index * (dash + gap)
            far = min(near + dash, length)
            piece = [(start[0] + at * step_x, start[1] + at * step_y) for at in (near, far)]
            self.line(piece, colour, width)

    def pipes(
        self, runs: Iterable[Sequence[Point]], colour: Colour, width: float, *, halo: bool = False
    ) -> None:
        """Draws straight runs of pipe that are one where they meet.

        Args:
            runs: Corners of each run, horizontal or vertical in between.
            colour: Colour of the content.
            width: Width of the pipe.
            halo: Whether to keep what lies below at a distance.
        """
        legs = [leg for run in runs for leg in pairwise(run)]
        layers = [(WHITE, 0.5 * width + HALO)] if halo else []
        layers += [(OUTLINE, 0.5 * width + PIPE_EDGE), (colour, 0.5 * width)]
        for layer, half in layers:
            for (x, y), (x_end, y_end) in legs:
                left, right = sorted((x, x_end))
                top, bottom = sorted((y, y_end))
                # The ends of a halo stay open, so that it does not cut what the pipe leads to.
                across, along = half, 0.0 if layer is WHITE else half
                pad_x, pad_y = (along, across) if right - left > bottom - top else (across, along)
                self.box((left - pad_x, top - pad_y, right + pad_x, bottom + pad_y), layer)

    def closed_pipe(self, start: Point, end: Point) -> None:
        """Draws a pipe that nothing flows through."""
        self.dashes(start, end, CLOSED, CLOSED_WIDTH)

    def chevron(self, tip: Point, direction: Point, size: float, colour: Colour) -> None:
        """Draws a small mark of flow direction."""
        x, y = direction
        back = (tip[0] - size * x, tip[1] - size * y)
        left, right = (
            (back[0] - side * 0.8 * size * y, back[1] + side * 0.8 * size * x) for side in (1.0, -1.0)
        )
        self.polygon([left, tip, right], colour)

    def arrow(self, start: Point, end: Point, width: float, fill: Colour, edge: Colour) -> None:
        """Draws a block arrow; its head is a little wider than its shaft."""
        length = math.dist(start, end)
        along = ((end[0] - start[0]) / length, (end[1] - start[1]) / length)
        for grown, colour in ((1.0, edge), (0.0, fill)):
            half, head = 0.5 * width + grown, 0.5 * width + 3.5 + 1.6 * grown
            head_length = min(head + 1.0, 0.6 * length)
            outline = [
                (-grown, -half),
                (length - head_length - grown, -half),
                (length - head_length - grown, -head),
                (length + 1.2 * grown, 0.0),
                (length - head_length - grown, head),
                (length - head_length - grown, half),
                (-grown, half),
            ]
            self.polygon(
                [
                    (
                        start[0] + far * along[0] - aside * along[1],
                        start[1] + far * along[1] + aside * along[0],
                    )
                    for far, aside in outline
                ],
                colour,
            )
