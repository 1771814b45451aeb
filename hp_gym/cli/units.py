"""From a name with its unit to words and numbers for people."""

import math
from typing import Final

# Ending of a name, unit as people write it, decimals.
_ENDINGS: Final = (
    ("_kwh_per_100_km", "kWh/100 km", 2),
    ("_kwh", "kWh", 3),
    ("_pct", "%", 1),
    ("_degc", "°C", 1),
    ("_bar", "bar", 2),
    ("_km", "km", 2),
    ("_k", "K", 2),
    ("_s", "s", 0),
    ("_v", "V", 1),
    ("_w", "W", 0),
)
_COUNTS: Final = ("_breaches", "_starts", "_trips")
_LABELS: Final = {"energy_kwh_per_100_km": "Consumption"}
_ACRONYMS: Final = ("cop", "htc", "ptc", "soc")


def label(name: str) -> str:
    """Returns `Final SOC` for `final_soc_pct`."""
    if name in _LABELS:
        return _LABELS[name]
    stem = name
    for ending, _, _ in _ENDINGS:
        if name.endswith(ending):
            stem = name.removesuffix(ending)
            break
    words = [word.upper() if word in _ACRONYMS else word for word in stem.split("_")]
    text = " ".join(words)
    return text[:1].upper() + text[1:]


def quantity(name: str, value: float) -> tuple[str, str]:
    """Returns value and unit as text; a dash for a value that does not exist."""
    unit, decimals = next(
        ((unit, decimals) for ending, unit, decimals in _ENDINGS if name.endswith(ending)), ("", 3)
    )
    if not math.isfinite(value):
        return "-", unit
    if name.endswith("_residual"):
        return f"{value:.1e}", unit
    if name.endswith(_COUNTS):
        return f"{value:.0f}", unit
    return f"{value:.{decimals}f}", unit
