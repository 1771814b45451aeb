"""Where everything stands, in design units: the picture is 960 of them wide and 540 high."""

from dataclasses import dataclass
from typing import Final

WIDTH: Final = 960
HEIGHT: Final = 540

HEADER_BASE: Final = 40.0
MARGIN: Final = 16.0

# Refrigerant loop, at the left.
COMPRESSOR_X: Final = 44.0
VALVE_X: Final = 122.0
EXCHANGER_LEFT: Final = 16.0
EXCHANGER_RIGHT: Final = 148.0
EXCHANGER_MARGIN: Final = 12.0
"""How far an exchanger reaches beyond the rails of its loop."""

# Rails of the coolant loops, HTC above the components and chiller loop below.
CAPTION_OFFSET: Final = 19.0
"""From a rail to the line of text beyond it."""
HTC_RETURN_Y: Final = 77.0
HTC_SUPPLY_Y: Final = 118.0
CHILLER_SUPPLY_Y: Final = 344.0
CHILLER_RETURN_Y: Final = 385.0
CENTRE_Y: Final = 231.0
RAIL_WIDTH: Final = 6.0
BRANCH_WIDTH: Final = 4.5
LEG_OFFSET: Final = 26.0
"""From the middle of a component to each of its two pipes."""
RAIL_OVERHANG: Final = 15.0
"""From the last pipe to the end of the rail."""

CHEVRON: Final = 5.0
"""Size of a mark of flow direction."""

MEMBER_HALF_WIDTH: Final = 39.5
MEMBER_TOP: Final = 198.0
MEMBER_BOTTOM: Final = 264.0
PTC_X: Final = 330.0

# Instruments, at the right.
SIDE_LEFT: Final = 778.0
SIDE_RIGHT: Final = 944.0

# Legend, above the components that the HTC does not reach.
LEGEND_LEFT: Final = 614.0
LEGEND_RIGHT: Final = 758.0

STRIP_TOP: Final = 428.0


@dataclass(frozen=True)
class Member:
    """A component that can be connected to the coolant loops."""

    label: tuple[str, ...]
    x: float
    temperature: str
    connection: str
    chiller_heat: tuple[str, ...]
    """Heat flows to the chiller loop, which are added."""
    htc_heat: str | None = None
    """Heat flow between HTC and component; none where there is no such connection."""
    feeds_htc: bool = False
    """Whether the heat flow counts from the component to the HTC, which it then passes in series."""


THERMAL_BATTERY: Final = Member(
    ("Thermal", "battery"),
    274.0,
    "thermal_battery_temperature_degc",
    "thermal_battery_connection",
    ("thermal_battery_chiller_heat_flow_w",),
    "thermal_battery_htc_heat_flow_w",
    feeds_htc=True,
)
CABIN: Final = Member(
    ("Cabin",),
    386.0,
    "cabin_temperature_degc",
    "cabin_connection",
    ("cabin_chiller_heat_flow_w", "exhaust_recovery_heat_flow_w"),
    "cabin_htc_heat_flow_w",
)
BATTERY: Final = Member(
    ("Battery",),
    470.0,
    "battery_temperature_degc",
    "battery_connection",
    ("battery_chiller_heat_flow_w",),
    "battery_htc_heat_flow_w",
)
AMBIENT: Final = Member(
    ("Ambient",),
    554.0,
    "ambient_temperature_degc",
    "ambient_connection",
    ("ambient_chiller_heat_flow_w",),
    "ambient_htc_heat_flow_w",
)
MOTOR: Final = Member(
    ("Motor and", "inverter"),
    638.0,
    "motor_temperature_degc",
    "motor_connection",
    ("motor_chiller_heat_flow_w",),
)
TRANSMISSION: Final = Member(
    ("Transmission",),
    722.0,
    "transmission_temperature_degc",
    "transmission_connection",
    ("transmission_chiller_heat_flow_w",),
)
NUMBERS_RIGHT: Final = THERMAL_BATTERY.x - LEG_OFFSET - 5.0
"""Right end of the numbers between the exchangers and the first component."""

MEMBERS: Final = (THERMAL_BATTERY, CABIN, BATTERY, AMBIENT, MOTOR, TRANSMISSION)
