"""Where the energy of a run went: the plant's flows as links between places.

Every place that is neither a source nor a sink gives away what it takes in, as the plant's energy ledger
demands; what a place stores or releases shows as a link of its own. Which places there are follows from the
vehicle's layout.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from hp_gym.studies.benchmark.report.heat_places import HeatPlaces

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

    from hp_gym.vehicle_layout import Layout

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


BUS: Final = "High-voltage bus"
REFRIGERANT: Final = "Refrigerant"


def electricity(layout: Layout) -> Diagram:
    """Returns the places between the battery's cells and what draws from them."""
    fans = [row["flow"] for row in layout["flows"] if row["flow"].endswith("fan_power_w")]
    return Diagram(
        [
            Flow("battery_loss_w", "Cells", "Battery losses"),
            Flow("battery_power_w", "Cells", BUS, (BUS, "Cells, charged")),
            Flow("unserved_power_w", "Not served", BUS),
            Flow("traction_power_w", BUS, "Traction", ("Traction, recovered", BUS)),
            *([Flow("compressor_power_w", BUS, "Compressor")] if layout["refrigerates"] else []),
            *(Flow(heater["power"], BUS, heater["label"]) for heater in layout["heaters"]),
            *(Flow(loop["pump_power"], BUS, "Pumps") for loop in layout["loops"]),
            *(Flow(cabin["blower_power"], BUS, "Blower") for cabin in layout["cabins"]),
            *(Flow(fan, BUS, "Fan") for fan in fans),
            Flow("low_voltage_power_w", BUS, "12 V loads"),
            Flow("drag_power_w", "Traction", "Aerodynamic drag", ("Wind from behind", "Traction")),
            Flow("rolling_resistance_power_w", "Traction", "Rolling resistance"),
            Flow("kinetic_power_w", "Traction", "Kinetic energy", ("Kinetic energy, start", "Traction")),
            Flow("climb_power_w", "Traction", "Height", ("Height, start", "Traction")),
            Flow("friction_brake_power_w", "Traction", "Friction brakes"),
            Flow("motor_loss_w", "Traction", "Motor and inverter losses"),
            Flow("transmission_loss_w", "Traction", "Transmission losses"),
        ]
    )


def heat(layout: Layout) -> Diagram:
    """Returns the places that heat passes: refrigerant, coolant loops, air of the cabins."""
    places = HeatPlaces(layout)
    flows = [Flow(*row) for link in places.links() for row in places.of_link(link)]
    flows += [Flow(*row) for source in layout["sources"] for row in places.of_source(source)]
    for exchanger in layout["exchangers"]:
        flows += [Flow(*row) for row in places.of_exchanger(exchanger, REFRIGERANT)]
    if layout["refrigerates"]:
        flows.append(Flow("compressor_power_w", "Compressor", REFRIGERANT))
        flows.append(Flow("compressor_loss_w", REFRIGERANT, "Compressor losses"))
    return Diagram(flows, places.stores())


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
