"""Where the energy of a run went: the plant's flows as links between places.

Every place that is neither a source nor a sink gives away what it takes in, as the plant's energy ledger
demands; what a place stores or releases shows as a link of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

JOULE_PER_KWH: Final = 3.6e6
SMALLEST_KWH: Final = 0.005
"""Links below this are left out: they would be thinner than a line."""

Link = tuple[str, str, float]
"""From, to, kWh; never negative."""


@dataclass(frozen=True)
class Flow:
    """A column of powers [W] as a link between two places.

    Attributes:
        column: Column of a trajectory, positive from `source` to `target`.
        source: Where positive values come from.
        target: Where positive values go.
        back: Source and target where the net flow is negative; none where it cannot be.
    """

    column: str
    source: str
    target: str
    back: tuple[str, str] | None = None


@dataclass(frozen=True)
class Diagram:
    """Links of one Sankey diagram.

    Attributes:
        flows: Links that are columns.
        stores: Places that can hold energy, with the name of what they kept and of what they gave.
    """

    flows: Sequence[Flow]
    stores: Sequence[tuple[str, str, str]] = ()


ELECTRICITY: Final = Diagram(
    [
        Flow("battery_loss_w", "Cells", "Battery losses"),
        Flow("battery_power_w", "Cells", "High-voltage bus", ("High-voltage bus", "Cells, charged")),
        Flow("unserved_power_w", "Not served", "High-voltage bus"),
        Flow("traction_power_w", "High-voltage bus", "Traction", ("Traction, recovered", "High-voltage bus")),
        Flow("compressor_power_w", "High-voltage bus", "Compressor"),
        Flow("ptc_power_w", "High-voltage bus", "PTC heater"),
        Flow("htc_pump_power_w", "High-voltage bus", "Pumps"),
        Flow("chiller_pump_power_w", "High-voltage bus", "Pumps"),
        Flow("blower_power_w", "High-voltage bus", "Blower"),
        Flow("fan_power_w", "High-voltage bus", "Fan"),
        Flow("low_voltage_power_w", "High-voltage bus", "12 V loads"),
        Flow("drag_power_w", "Traction", "Aerodynamic drag"),
        Flow("rolling_resistance_power_w", "Traction", "Rolling resistance"),
        Flow("kinetic_power_w", "Traction", "Kinetic energy", ("Kinetic energy, start", "Traction")),
        Flow("friction_brake_power_w", "Traction", "Friction brakes"),
        Flow("motor_loss_w", "Traction", "Motor and inverter losses"),
        Flow("transmission_loss_w", "Traction", "Transmission losses"),
    ]
)

HEAT: Final = Diagram(
    [
        Flow(
            "ambient_chiller_heat_flow_w", "Ambient air", "Chiller loop", ("Chiller loop", "To ambient air")
        ),
        Flow("motor_chiller_heat_flow_w", "Motor, inverter", "Chiller loop", ("Chiller loop", "To motor")),
        Flow(
            "transmission_chiller_heat_flow_w",
            "Transmission",
            "Chiller loop",
            ("Chiller loop", "To transmission"),
        ),
        Flow("battery_chiller_heat_flow_w", "Battery", "Chiller loop", ("Chiller loop", "To battery")),
        Flow(
            "exhaust_recovery_heat_flow_w", "Exhaust air", "Chiller loop", ("Chiller loop", "To exhaust air")
        ),
        Flow("cabin_chiller_heat_flow_w", "Cabin", "Chiller loop", ("Chiller loop", "To cabin")),
        Flow(
            "thermal_battery_chiller_heat_flow_w",
            "Thermal battery",
            "Chiller loop",
            ("Chiller loop", "To thermal battery"),
        ),
        Flow("chiller_pump_power_w", "Pumps", "Chiller loop"),
        Flow(
            "chiller_supply_hose_heat_flow_w",
            "Chiller loop",
            "To ambient air",
            ("Ambient air", "Chiller loop"),
        ),
        Flow(
            "chiller_return_hose_heat_flow_w",
            "Chiller loop",
            "To ambient air",
            ("Ambient air", "Chiller loop"),
        ),
        Flow("evaporator_heat_flow_w", "Chiller loop", "Refrigerant"),
        Flow("compressor_power_w", "Compressor", "Refrigerant"),
        Flow("compressor_loss_w", "Refrigerant", "Compressor losses"),
        Flow("condenser_heat_flow_w", "Refrigerant", "HTC"),
        Flow("ptc_power_w", "PTC heater", "HTC"),
        Flow("htc_pump_power_w", "Pumps", "HTC"),
        Flow("thermal_battery_htc_heat_flow_w", "Thermal battery", "HTC", ("HTC", "To thermal battery")),
        Flow("cabin_htc_heat_flow_w", "HTC", "Cabin air", ("Cabin air", "HTC")),
        Flow("battery_htc_heat_flow_w", "HTC", "To battery", ("Battery", "HTC")),
        Flow("ambient_htc_heat_flow_w", "HTC", "To ambient air", ("Ambient air", "HTC")),
        Flow("htc_supply_hose_heat_flow_w", "HTC", "HTC hoses", ("Ambient air", "HTC")),
        Flow("htc_return_hose_heat_flow_w", "HTC", "HTC hoses", ("Ambient air", "HTC")),
        Flow("blower_power_w", "Blower", "Cabin air"),
        Flow("solar_heat_flow_w", "Sun", "Cabin air"),
        Flow("occupant_heat_flow_w", "Occupants", "Cabin air"),
        Flow("cabin_chiller_heat_flow_w", "Cabin air", "To chiller loop", ("From chiller loop", "Cabin air")),
        Flow("cabin_panel_heat_flow_w", "Cabin air", "Cabin panels", ("Warm panels", "Cabin air")),
        Flow("cabin_exhaust_heat_flow_w", "Cabin air", "Ventilation", ("Warm fresh air", "Cabin air")),
        Flow("soft_furnishings_heat_flow_w", "Cabin air", "Furnishings", ("Warm furnishings", "Cabin air")),
        Flow("hard_furnishings_heat_flow_w", "Cabin air", "Furnishings", ("Warm furnishings", "Cabin air")),
    ],
    [
        ("Chiller loop", "Chiller coolant, warmed", "Chiller coolant, cooled"),
        ("HTC", "HTC coolant, warmed", "HTC coolant, cooled"),
        ("Cabin air", "Air, warmed", "Air, cooled"),
    ],
)


def links(trajectory: pd.DataFrame, diagram: Diagram) -> list[Link]:
    """Returns the links of a run in the order of the diagram, those with the same ends added up.

    Raises:
        KeyError: The trajectory lacks a column.
    """
    energy: dict[tuple[str, str], float] = {}
    for flow in diagram.flows:
        net_kwh = float(trajectory[flow.column].sum()) / JOULE_PER_KWH
        ends = (flow.source, flow.target) if net_kwh >= 0.0 or flow.back is None else flow.back
        sign = 1.0 if ends == (flow.source, flow.target) else -1.0
        energy[ends] = energy.get(ends, 0.0) + sign * net_kwh
    for place, kept, given in diagram.stores:
        surplus = balance(energy, place)
        ends = (place, kept) if surplus >= 0.0 else (given, place)
        energy[ends] = abs(surplus)
    return [(*ends, kwh) for ends, kwh in energy.items() if kwh >= SMALLEST_KWH]


def balance(energy: dict[tuple[str, str], float], place: str) -> float:
    """Returns what a place takes in less what it gives away [kWh]."""
    taken = sum(kwh for (_, target), kwh in energy.items() if target == place)
    return taken - sum(kwh for (source, _), kwh in energy.items() if source == place)
