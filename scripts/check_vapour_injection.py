# /// script
# requires-python = ">=3.11"
# dependencies = ["vclibpy==0.1.2", "CoolProp>=7.2,<9", "numpy", "scipy"]
# ///
"""Compares vapour injection of the Rust plant with vclibpy's flowsheets, at equal pressures and efficiencies.

vclibpy's flow sheets with injection give the states, CoolProp the properties. The flash tank is its phase
separator. Its own economiser (0.1.2) does not close the energy balance (`h_7 = h - dh * m`), so there the
class is derived with the balance and the effectiveness of ours; everything else is vclibpy's.

    uv run scripts/check_vapour_injection.py
"""

import math
import sys
from typing import Any

from rust_refrigeration import Point, efficiencies, rust_points
from scipy.optimize import brentq
from vclibpy import FlowsheetState, Inputs
from vclibpy.components.compressors import Compressor
from vclibpy.components.expansion_valves import Bernoulli
from vclibpy.components.heat_exchangers import HeatExchanger
from vclibpy.flowsheets import VaporInjectionPhaseSeparator
from vclibpy.flowsheets.vapor_injection import BaseVaporInjection
from vclibpy.media import CoolProp as Media

FLUIDS = ("R134a", "R1234yf", "R290", "R152A")
KINDS = ("economiser", "flash-tank")
TOLERANCE = 5e-3


def running_points(fluid: str, kind: str) -> tuple[dict[str, Any], list[Point]]:
    """Parameters and those operating points at which the machine runs."""
    parameters, points = rust_points(fluid, kind)
    return parameters, [point for point in points if point["mass_flow_kg_s"] > 0.0]


class GivenCompressor(Compressor):  # type: ignore[misc]  # vclibpy has no types
    """A stage with given efficiencies."""

    def __init__(self, displacement_m3: float, isentropic: float, volumetric: float) -> None:
        super().__init__(N_max=1.0, V_h=displacement_m3)
        self.isentropic, self.volumetric = isentropic, volumetric

    def get_lambda_h(self, **_: Any) -> float:
        """Volumetric efficiency."""
        return self.volumetric

    def get_eta_isentropic(self, **_: Any) -> float:
        """Isentropic efficiency."""
        return self.isentropic

    def get_eta_mech(self, **_: Any) -> float:
        """No loss of the motor."""
        return 1.0


class NoExchanger(HeatExchanger):  # type: ignore[misc]
    """Only its states count here."""

    def __init__(self) -> None:
        pass

    def calc(self, **_: Any) -> tuple[float, float]:
        """Is abstract and never called."""
        return 0.0, 0.0


class Economiser(BaseVaporInjection):  # type: ignore[misc]
    """Injection from an economiser of given effectiveness, with the energy balance closed."""

    flowsheet_name = "economiser of given effectiveness"
    effectiveness = 0.0
    superheat_k = 0.0

    def calc_injection(self) -> tuple[float, float, Any]:
        """Injected share of the whole flow, enthalpy of the gas, state of the cooled liquid."""
        liquid, wet = self.condenser.state_outlet, self.high_pressure_valve.state_outlet
        distance = liquid.T - wet.T
        superheat = distance / (1.0 + (distance / self.superheat_k) ** 4) ** 0.25
        gas = self.med_prop.calc_state("PT", wet.p, wet.T + superheat)
        cooled = self.med_prop.calc_state("PT", liquid.p, liquid.T - self.effectiveness * distance)
        per_suction = (liquid.h - cooled.h) / (gas.h - liquid.h)
        return per_suction / (1.0 + per_suction), gas.h, cooled


def stage_efficiency(
    media: Media, point: Point, pressures: tuple[float, float, float], whole: float
) -> float:
    """Efficiency of each stage with which both together, without injection, are the whole machine."""
    low, middle, high = pressures
    suction = media.calc_state("PT", low, point["evaporating_temperature_k"] + point["superheat_k"])
    work = (media.calc_state("PS", high, suction.s).h - suction.h) / whole
    first = media.calc_state("PS", middle, suction.s).h - suction.h

    def excess(efficiency: float) -> float:
        between = media.calc_state("PH", middle, suction.h + first / efficiency)
        second = media.calc_state("PS", high, between.s).h - between.h
        return float((first + second) / efficiency - work)

    return float(brentq(excess, whole, 1.0, xtol=1e-10))


def vclibpy_cycle(fluid: str, kind: str, parameters: dict[str, Any], point: Point) -> dict[str, float]:
    """The same operating point from vclibpy's flow sheet."""
    media = Media(fluid_name=fluid)
    low = media.calc_state("TQ", point["evaporating_temperature_k"], 1.0).p
    high = media.calc_state("TQ", point["condensing_temperature_k"], 0.0).p
    if parameters["injection"]["pressure_position"] != 0.5:
        msg = "vclibpy 0.1.2 injects at the geometric mean: another factor in its inputs is no number for it"
        raise ValueError(msg)
    middle = math.sqrt(low * high)
    machine = parameters["compressor"]
    volumetric, whole = efficiencies(machine, high / low, point["speed_rev_s"])
    isentropic = stage_efficiency(media, point, (low, middle, high), whole)
    stages = [GivenCompressor(machine["displacement_cm3"] * 1e-6, isentropic, volumetric) for _ in range(2)]
    kinds = {"economiser": Economiser, "flash-tank": VaporInjectionPhaseSeparator}
    sheet = kinds[kind](
        high_pressure_compressor=stages[1],
        low_pressure_compressor=stages[0],
        high_pressure_valve=Bernoulli(A=1.0),
        low_pressure_valve=Bernoulli(A=1.0),
        evaporator=NoExchanger(),
        condenser=NoExchanger(),
        fluid=fluid,
    )
    if kind == "economiser":
        sheet.effectiveness = parameters["injection"]["economiser"]["effectiveness"]
        sheet.superheat_k = parameters["injection"]["economiser"]["superheat_k"]
    for part in sheet.get_all_components():
        part.med_prop = media
    sheet.med_prop = media
    inputs = Inputs(
        n=point["speed_rev_s"],
        dT_eva_superheating=point["superheat_k"],
        dT_con_subcooling=point["subcooling_k"],
    )
    sheet.calc_states(low, high, inputs, FlowsheetState())
    return results(sheet, machine["electrical_efficiency"])


def results(sheet: BaseVaporInjection, electrical_efficiency: float) -> dict[str, float]:
    """What the plant uses, from the states of a flow sheet.

    The flow sheet has a displacement for the upper stage too; ours is one machine, whose suction flow counts.
    """
    low, high = sheet.low_pressure_compressor, sheet.high_pressure_compressor
    flow = low.m_flow
    mixed = high.state_inlet
    # Both flows from the enthalpies of mixing.
    gas = sheet_gas_enthalpy(sheet)
    total = flow * (low.state_outlet.h - gas) / (mixed.h - gas)
    work = flow * (low.state_outlet.h - low.state_inlet.h) + total * (high.state_outlet.h - mixed.h)
    heat = total * (high.state_outlet.h - sheet.condenser.state_outlet.h)
    return {
        "mass_flow_kg_s": flow,
        "injected_mass_flow_kg_s": total - flow,
        "evaporator_heat_flow_w": flow * (sheet.evaporator.state_outlet.h - sheet.evaporator.state_inlet.h),
        "condenser_heat_flow_w": heat,
        "electric_power_w": work / electrical_efficiency,
        "discharge_temperature_k": high.state_outlet.T,
    }


def sheet_gas_enthalpy(sheet: BaseVaporInjection) -> float:
    """Enthalpy of the injected gas."""
    return float(sheet.calc_injection()[1])


def main() -> int:
    """Prints the largest deviations; the exit status tells whether everything agrees."""
    worst = 0.0
    for fluid in FLUIDS:
        for kind in KINDS:
            parameters, points = running_points(fluid, kind)
            largest: dict[str, float] = {}
            for point in points:
                expected = vclibpy_cycle(fluid, kind, parameters, point)
                for name, value in expected.items():
                    error = (
                        abs(point[name] - value) / 100.0  # Half a kelvin as half a per cent.
                        if name == "discharge_temperature_k"
                        else abs(point[name] / value - 1.0)
                    )
                    largest[name] = max(largest.get(name, 0.0), error)
                cop = point["condenser_heat_flow_w"] / point["electric_power_w"]
                expected_cop = expected["condenser_heat_flow_w"] / expected["electric_power_w"]
                largest["COP"] = max(largest.get("COP", 0.0), abs(cop / expected_cop - 1.0))
            worst = max(worst, *largest.values())
            shown = ", ".join(f"{name} {value:.1e}" for name, value in largest.items())
            print(f"{fluid} {kind}, {len(points)} points: {shown}")
    print(f"largest deviation {worst:.1e}, allowed {TOLERANCE:.0e}")
    return int(worst > TOLERANCE)


if __name__ == "__main__":
    sys.exit(main())
