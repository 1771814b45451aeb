"""Figures in the text of the page: each knows where in the summary it stands."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from markupsafe import Markup

MINUS: Final = "\N{MINUS SIGN}"
THIN_SPACE: Final = "\N{NARROW NO-BREAK SPACE}"
NOTHING: Final = "\N{EN DASH}"


def decimal(value: float, decimals: int, *, signed: bool = False) -> str:
    """Returns a number as people read it: thousands apart, a true minus, no minus before zero."""
    text = f"{value:+,.{decimals}f}" if signed else f"{value:,.{decimals}f}"
    if not text.strip("+-0.,"):
        text = text.lstrip("+-")
    return text.replace("-", MINUS).replace(",", THIN_SPACE)


class Summary:
    """A summary to read figures from.

    Args:
        data: What `summary.json` holds.
    """

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.data = data

    def get(self, *path: str | int) -> Any:
        """Returns what stands at a place; None where there is nothing."""
        here: Any = self.data
        for key in path:
            if isinstance(here, Mapping):
                here = here.get(key)
            elif isinstance(here, Sequence) and not isinstance(here, str) and isinstance(key, int):
                here = here[key] if key < len(here) else None
            else:
                return None
        return here

    def number(self, *path: str | int) -> float | None:
        """Returns the finite number at a place; None where there is none."""
        value = self.get(*path)
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            return None
        return float(value)

    def show(self, *path: str | int, decimals: int, signed: bool = False) -> Markup:
        """Returns the number at a place for the page, marked with the place; a dash where there is none.

        The mark is a JSON pointer (RFC 6901) into the summary.
        """
        value = self.number(*path)
        if value is None:
            return Markup(NOTHING)
        text = decimal(value, decimals, signed=signed)
        return Markup('<data data-summary="{}" value="{}">{}</data>').format(
            pointer(*path), repr(value), text
        )


def pointer(*path: str | int) -> str:
    """Returns a place as a JSON pointer (RFC 6901)."""
    return "".join("/" + str(key).replace("~", "~0").replace("/", "~1") for key in path)
