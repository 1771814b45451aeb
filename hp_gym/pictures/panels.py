"""What the picture of a run shows: panels, curves and their colours."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

# Okabe and Ito's palette: distinct for colour-blind readers too.
BLACK, GREY, LIGHT = "#000000", "#7f7f7f", "#dddddd"
ORANGE, SKY, GREEN, BLUE, RED, PURPLE = "#e69f00", "#56b4e9", "#009e73", "#0072b2", "#d55e00", "#cc79a7"

# Loop by value of a connection column.
LOOPS: Final = {1.0: ("HTC", RED), 2.0: ("chiller loop", BLUE)}
MEMBERS: Final = ("cabin", "battery", "motor", "transmission", "ambient", "thermal_battery")


@dataclass(frozen=True)
class Curve:
    """A column in a panel."""

    column: str
    label: str
    colour: str
    style: str = "-"
    width: float = 1.3


@dataclass(frozen=True)
class Panel:
    """Some curves with one axis."""

    title: str
    unit: str
    curves: Sequence[Curve]
    scale: float = 1.0
    limits: Sequence[str] = ()
    """Names of limits to draw as lines."""
    only_while_running: bool = False
    """Whether the curves mean something only while the compressor runs."""
    hide_idle: bool = False
    """Whether to leave out curves that are zero throughout."""


SPEED = Panel("Speed", "km/h", [Curve("speed_m_s", "vehicle", GREY)], scale=3.6)
CHARGE = Panel("State of charge", "%", [Curve("soc", "usable", GREEN)], scale=100.0)
COMFORT = Panel(
    "Cabin and battery",
    "°C",
    [
        Curve("cabin_temperature_degc", "cabin", RED),
        Curve("battery_temperature_degc", "battery", BLUE),
        Curve("ambient_temperature_degc", "ambient", GREY, "--"),
    ],
)
POWERTRAIN = Panel(
    "Powertrain and thermal battery",
    "°C",
    [
        Curve("motor_temperature_degc", "motor", ORANGE),
        Curve("transmission_temperature_degc", "transmission", PURPLE),
        Curve("thermal_battery_temperature_degc", "thermal battery", GREEN),
    ],
)
LOOP_TEMPERATURES = Panel(
    "Coolant loops",
    "°C",
    [
        Curve("htc_supply_temperature_degc", "HTC supply", RED),
        Curve("htc_return_temperature_degc", "HTC return", ORANGE),
        Curve("chiller_supply_temperature_degc", "chiller supply", BLUE),
        Curve("chiller_return_temperature_degc", "chiller return", SKY),
    ],
    limits=("htc_supply_highest_degc", "chiller_supply_lowest_degc"),
)
DRIVE_POWERS = Panel(
    "Drive",
    "kW",
    [Curve("battery_power_w", "battery", GREEN), Curve("traction_power_w", "traction", BLACK, width=0.8)],
    scale=1e-3,
)
PRESSURES = Panel(
    "Refrigerant pressures, compressor on",
    "bar",
    [
        Curve("condensing_pressure_bar", "condensing", RED),
        Curve("evaporating_pressure_bar", "evaporating", BLUE),
    ],
    limits=("condensing_pressure_highest_bar",),
    only_while_running=True,
)
THERMAL_POWERS = Panel(
    "Electrical power of the thermal system",
    "kW",
    [
        Curve("ptc_power_w", "PTC", RED),
        Curve("compressor_power_w", "compressor", BLUE),
        Curve("auxiliary_power_w", "auxiliary", GREY),
    ],
    scale=1e-3,
)
HEAT_FLOWS = Panel(
    "Heat flows",
    "kW",
    [
        Curve("condenser_heat_flow_w", "condenser", RED),
        Curve("evaporator_heat_flow_w", "evaporator", BLUE),
        Curve("cabin_htc_heat_flow_w", "to cabin", ORANGE),
        Curve("battery_htc_heat_flow_w", "to battery", PURPLE),
        Curve("ambient_chiller_heat_flow_w", "from ambient", SKY),
        Curve("ambient_htc_heat_flow_w", "to ambient", SKY, "--"),
        Curve("motor_chiller_heat_flow_w", "from motor", BLACK),
        Curve("battery_chiller_heat_flow_w", "from battery", GREEN),
        Curve("cabin_chiller_heat_flow_w", "from cabin", GREY),
        Curve("thermal_battery_htc_heat_flow_w", "thermal battery, HTC", GREEN, "--"),
        Curve("thermal_battery_chiller_heat_flow_w", "thermal battery, chiller", BLUE, "--"),
    ],
    scale=1e-3,
    hide_idle=True,
)

# Two columns, read from the top; the last place is that of the connections.
LAYOUT: Final = (
    (SPEED, CHARGE),
    (COMFORT, DRIVE_POWERS),
    (LOOP_TEMPERATURES, THERMAL_POWERS),
    (PRESSURES, HEAT_FLOWS),
    (POWERTRAIN, None),
)
