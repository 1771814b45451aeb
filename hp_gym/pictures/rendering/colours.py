"""Colours of the picture; all of them can be told apart by colour-blind readers."""

import math
from typing import Final, TypeAlias

import matplotlib as mpl

Colour: TypeAlias = tuple[int, int, int]

WHITE: Final[Colour] = (255, 255, 255)
CARD: Final[Colour] = (244, 246, 248)
TRACK: Final[Colour] = (222, 227, 232)
CLOSED: Final[Colour] = (178, 186, 194)
MUTED: Final[Colour] = (94, 106, 118)
OUTLINE: Final[Colour] = (64, 74, 84)
INK: Final[Colour] = (28, 36, 44)

# Okabe and Ito's palette, as in `hp_gym.pictures.panels`.
HEAT: Final[Colour] = (230, 159, 0)
HEAT_EDGE: Final[Colour] = (158, 104, 0)
HTC_NAME: Final[Colour] = (190, 78, 0)
CHILLER_NAME: Final[Colour] = (0, 96, 160)
REFRIGERANT: Final[Colour] = (0, 158, 115)
ELECTRIC: Final[Colour] = (204, 121, 167)
DRIVE: Final[Colour] = (86, 120, 150)
DRIVE_AHEAD: Final[Colour] = (206, 214, 222)

LOWEST_DEGC: Final = -20.0
NEUTRAL_DEGC: Final = 22.0
HIGHEST_DEGC: Final = 85.0

# Moreland's diverging map: steps look equally large, and blue against red stays distinct.
_MAP: Final[list[Colour]] = [
    (int(red), int(green), int(blue))
    for red, green, blue, _ in mpl.colormaps["coolwarm"](range(256), bytes=True).tolist()
]


def of_temperature(temperature_degc: float) -> Colour:
    """Returns the colour of a temperature: blue below 22 degC, red above, grey where it is not known."""
    if not math.isfinite(temperature_degc):
        return TRACK
    span_k = (
        (NEUTRAL_DEGC - LOWEST_DEGC) if temperature_degc < NEUTRAL_DEGC else (HIGHEST_DEGC - NEUTRAL_DEGC)
    )
    share = 0.5 + 0.5 * (temperature_degc - NEUTRAL_DEGC) / span_k
    return _MAP[round(255 * min(max(share, 0.0), 1.0))]


def mean(one: Colour, other: Colour) -> Colour:
    """Returns the colour half-way between two."""
    red, green, blue = ((a + b) // 2 for a, b in zip(one, other, strict=True))
    return red, green, blue


def text_on(colour: Colour) -> Colour:
    """Returns the colour of text that can be read on another colour."""
    red, green, blue = colour
    return INK if 0.299 * red + 0.587 * green + 0.114 * blue > 138 else WHITE
