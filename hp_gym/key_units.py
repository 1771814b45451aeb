"""The unit that a name ends with: of configuration keys, totals and signals."""

from typing import Final

_UNITS: Final = {
    "kwh_per_100_km": "kWh/100 km",
    "j_m2_kg_k": "J/(m2 kg K)",
    "w_s_m3_k": "W s/(m3 K)",
    "w_s_k_m": "W s/(K m)",
    "w_s_m": "W s/m",
    "per_h": "1/h",
    "per_k": "1/K",
    "per_w": "1/W",
    "rev_s2": "1/s2",
    "w_m2_k": "W/(m2 K)",
    "w_m_k": "W/(m K)",
    "j_kg_k": "J/(kg K)",
    "kg_m3": "kg/m3",
    "m2_k_w": "m2 K/W",
    "k_h": "K h",
    "j_k": "J/K",
    "w_k": "W/K",
    "w_m2": "W/m2",
    "kg_s": "kg/s",
    "kg_m2": "kg m2",
    "m_s2": "m/s2",
    "m_s": "m/s",
    "m3_s": "m3/s",
    "rev_s": "1/s",
    "km_h": "km/h",
    "kwh": "kWh",
    "wh": "Wh",
    "ah": "Ah",
    "pct": "%",
    "degc": "degC",
    "bar": "bar",
    "ohm": "ohm",
    "deg": "deg",
    "km": "km",
    "kg": "kg",
    "kw": "kW",
    "nm": "N m",
    "pa": "Pa",
    "hz": "Hz",
    "m2": "m2",
    "m3": "m3",
    "mm": "mm",
    "cm3": "cm3",
    "ppm": "ppm",
    "k": "K",
    "s": "s",
    "v": "V",
    "w": "W",
    "a": "A",
    "m": "m",
    "n": "N",
    "j": "J",
    "f": "F",
}
"""Unit by ending, longer endings before those that they end with."""


def unit_of(name: str) -> str:
    """Returns the unit that the last part of a dotted name ends with; `-` where it has none."""
    last = name.rpartition(".")[2].partition("[")[0]
    return next((unit for ending, unit in _UNITS.items() if last.endswith(f"_{ending}")), "-")


def titled(name: str) -> str:
    """A name as a title: words, and its unit in brackets."""
    unit = unit_of(name)
    words = name.removesuffix(f"_{unit.lower()}").replace("_", " ")
    return words if unit == "-" else f"{words} [{unit}]"
