"""One colour, symbol and line for each controller, the same in every figure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

# Okabe and Ito's palette, as in `hp_gym.pictures.panels`.
_OWN: Final[Mapping[str, str]] = {
    "hpcu": "#d55e00",
    "hpcu-best-mode": "#e69f00",
    "hpcu-tuned": "#009e73",
    "hpcu-tuned-strict": "#00563f",
    "hpcu-modern": "#b59a00",
    "ppo": "#0072b2",
    "ptc-only": "#cc79a7",
    "random": "#9a9a9a",
    "off": "#5a5a5a",
}
_OTHERS: Final = ("#56b4e9", "#000000", "#8c6d31", "#7b3294", "#a6761d")
_SYMBOLS: Final = ("diamond", "square", "triangle-up", "cross", "star", "hexagon")
_PATTERNS: Final = ("", "/", ".", "x", "-", "|")


@dataclass(frozen=True)
class Style:
    """How a controller looks.

    Attributes:
        colour: As `#rrggbb`.
        symbol: Marker of plotly.
        pattern: Hatching of plotly's bars; empty for none.
    """

    colour: str
    symbol: str = "circle"
    pattern: str = ""


def styles(controllers: Iterable[str]) -> dict[str, Style]:
    """Returns the look of each controller; known ones keep theirs, whoever else is there."""
    given: dict[str, Style] = {}
    others = 0
    for name in controllers:
        if name in _OWN:
            given[name] = Style(_OWN[name])
        else:
            turn = others // len(_OTHERS)
            given[name] = Style(
                _OTHERS[others % len(_OTHERS)],
                _SYMBOLS[others % len(_SYMBOLS)],
                _PATTERNS[turn % len(_PATTERNS)],
            )
            others += 1
    return given
