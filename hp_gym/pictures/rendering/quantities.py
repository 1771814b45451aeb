"""Numbers as text, and the signals that the picture is made of."""

import math
from typing import Final

from hp_gym.pictures.rendering.positions import MEMBERS

UNKNOWN: Final = "\N{EN DASH}"

SIGNALS: Final[tuple[str, ...]] = (
    "time_s",
    "speed_m_s",
    "soc",
    "cop",
    "battery_power_w",
    "compressor_power_w",
    "ptc_power_w",
    "condenser_heat_flow_w",
    "evaporator_heat_flow_w",
    "condensing_pressure_bar",
    "evaporating_pressure_bar",
    "condensing_temperature_degc",
    "evaporating_temperature_degc",
    "htc_supply_temperature_degc",
    "htc_return_temperature_degc",
    "chiller_supply_temperature_degc",
    "chiller_return_temperature_degc",
    *(member.temperature for member in MEMBERS),
    *(member.connection for member in MEMBERS),
    *(member.htc_heat for member in MEMBERS if member.htc_heat is not None),
    *(name for member in MEMBERS for name in member.chiller_heat),
)
"""Signals that a picture needs."""


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
