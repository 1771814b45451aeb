"""Numbers as text."""

import math
from typing import Final

UNKNOWN: Final = "\N{EN DASH}"


def number(value: float, digits: int = 1) -> str:
    """Returns a number as text, without a sign before zero; a dash where it is not known."""
    if not math.isfinite(value):
        return UNKNOWN
    # Adding zero turns minus zero into zero.
    return f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "\N{MINUS SIGN}")


def degc(value: float, digits: int = 1) -> str:
    """Returns a temperature as text."""
    return f"{number(value, digits)} °C"


def kilowatt(power_w: float) -> str:
    """Returns a power as text, in kW."""
    return f"{number(1e-3 * power_w)} kW"


def clock(time_s: float) -> str:
    """Returns a time as text, in minutes and seconds."""
    if not math.isfinite(time_s):
        return UNKNOWN
    minutes, seconds = divmod(int(time_s), 60)
    return f"{minutes:02d}:{seconds:02d}"
