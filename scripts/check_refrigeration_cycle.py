"""Compares the refrigeration loop of the Rust plant with independent calculations.

CoolProp: own equations on real properties, solved with SciPy; finds temperatures and speed by itself.
TESPy: a component network at the saturation temperatures and evaporator duty of the Rust solution.

    python scripts/check_refrigeration_cycle.py
"""

import math
import sys
from typing import Any

import CoolProp
import numpy as np
import rust_refrigeration
from CoolProp.CoolProp import AbstractState
from numpy.typing import NDArray
from rust_refrigeration import Point, efficiencies
from scipy.optimize import root
from tespy.components import Compressor, CycleCloser, SimpleHeatExchanger, Valve
from tespy.connections import Connection
from tespy.networks import Network

REFRIGERANTS = ("R134a", "R1234yf", "R290", "R152A")
"""Built-in refrigerants by CoolProp's names."""
TOLERANCE = 1e-3
LOSS_TO_GAS_SHARES = (0.0, 0.8)


def rust_points(refrigerant: str, loss_to_gas_share: float) -> tuple[dict[str, Any], list[Point]]:
    """Parameters and operating points of a refrigerant without injection."""
    parameters, points = rust_refrigeration.rust_points(refrigerant, "-", str(loss_to_gas_share))
    return {**parameters, "refrigerant": refrigerant}, points


def gas_heat_per_work(compressor: dict[str, float]) -> float:
    """Heat that the gas gets of the motor's loss, per work done on it."""
    return compressor["loss_to_gas_share"] * (1.0 / compressor["electrical_efficiency"] - 1.0)


def limited(target: float, room: float) -> float:
    """Superheat or subcooling that leaves the coolant room."""
    return float(room / (1.0 + (room / target) ** 4) ** 0.25)


def coolprop_cycle(parameters: dict[str, Any], point: Point) -> Point:
    """The same operating point from CoolProp properties."""
    fluid = AbstractState("HEOS", parameters["refrigerant"])
    compressor = parameters["compressor"]

    def conductance(rate: float, ua: float) -> float:
        return rate * (1.0 - math.exp(-ua / rate))

    hot = conductance(point["hot_capacity_rate_w_k"], parameters["condenser_ua_w_k"])
    cold = conductance(point["cold_capacity_rate_w_k"], parameters["evaporator_ua_w_k"])

    def cycle(evaporating: float, condensing: float, speed: float) -> Point:
        fluid.update(CoolProp.QT_INPUTS, 1.0, evaporating)
        low = fluid.p()
        superheat = limited(parameters["superheat_k"], point["cold_return_k"] - evaporating)
        fluid.update(CoolProp.PT_INPUTS, low, evaporating + superheat)
        suction, density, entropy = fluid.hmass(), fluid.rhomass(), fluid.smass()
        fluid.update(CoolProp.QT_INPUTS, 0.0, condensing)
        high = fluid.p()
        subcooling = limited(parameters["subcooling_k"], condensing - point["hot_return_k"])
        fluid.update(CoolProp.PT_INPUTS, high, condensing - subcooling)
        liquid = fluid.hmass()
        fluid.update(CoolProp.PSmass_INPUTS, high, entropy)
        volumetric, isentropic = efficiencies(compressor, high / low, speed)
        work = (fluid.hmass() - suction) / isentropic
        discharge = suction + work * (1.0 + gas_heat_per_work(compressor))
        fluid.update(CoolProp.HmassP_INPUTS, discharge, high)
        mass_flow = volumetric * density * compressor["displacement_cm3"] * 1e-6 * speed
        return {
            "evaporating_temperature_k": evaporating,
            "condensing_temperature_k": condensing,
            "speed_rev_s": speed,
            "mass_flow_kg_s": mass_flow,
            "electric_power_w": mass_flow * work / compressor["electrical_efficiency"],
            "condenser_heat_flow_w": mass_flow * (discharge - liquid),
            "evaporator_heat_flow_w": mass_flow * (suction - liquid),
            "discharge_temperature_k": fluid.T(),
            "isentropic_efficiency": isentropic,
        }

    def residuals(unknowns: NDArray[np.float64], /) -> list[float]:
        values = cycle(*map(float, unknowns))
        return [
            cold * (point["cold_return_k"] - unknowns[0]) - values["evaporator_heat_flow_w"],
            hot * (unknowns[1] - point["hot_return_k"]) - values["condenser_heat_flow_w"],
            values["electric_power_w"] - point["power_limit_w"],
        ]

    solution = root(residuals, [point["cold_return_k"] - 4.0, point["hot_return_k"] + 6.0, 40.0], tol=1e-10)
    if not max(abs(residual) for residual in residuals(solution.x)) < 1e-3:
        raise RuntimeError(f"SciPy found no solution: {solution.message}")
    return cycle(*map(float, solution.x))


def tespy_cycle(parameters: dict[str, Any], point: Point) -> Point:
    """The same operating point as a TESPy network."""
    fluid = AbstractState("HEOS", parameters["refrigerant"])
    pressures = []
    for quality, name in ((1.0, "evaporating_temperature_k"), (0.0, "condensing_temperature_k")):
        fluid.update(CoolProp.QT_INPUTS, quality, point[name])
        pressures.append(fluid.p())
    low, high = pressures
    _, isentropic = efficiencies(parameters["compressor"], high / low, point["speed_rev_s"])

    network = Network(iterinfo=False)
    network.units.set_defaults(
        temperature="K", pressure="Pa", pressure_difference="Pa", enthalpy="J/kg", heat="W", power="W"
    )
    closer, valve = CycleCloser("closer"), Valve("valve")
    compressor, shell = Compressor("compressor"), SimpleHeatExchanger("shell")
    condenser, evaporator = SimpleHeatExchanger("condenser"), SimpleHeatExchanger("evaporator")
    suction = Connection(evaporator, "out1", closer, "in1")
    inlet = Connection(closer, "out1", compressor, "in1")
    compressed = Connection(compressor, "out1", shell, "in1")
    discharge = Connection(shell, "out1", condenser, "in1")
    liquid = Connection(condenser, "out1", valve, "in1")
    wet = Connection(valve, "out1", evaporator, "in1")
    network.add_conns(suction, inlet, compressed, discharge, liquid, wet)
    suction_k = point["evaporating_temperature_k"] + point["superheat_k"]
    inlet.set_attr(fluid={parameters["refrigerant"]: 1}, p=low, T=suction_k)
    liquid.set_attr(p=high, T=point["condensing_temperature_k"] - point["subcooling_k"])
    condenser.set_attr(pr=1)
    evaporator.set_attr(pr=1, Q=point["evaporator_heat_flow_w"])
    compressor.set_attr(eta_s=isentropic)
    shell.set_attr(pr=1, Q=0)
    # What the shell gets follows from the work, which does not depend on it.
    for _ in range(2):
        network.solve("design")
        if not network.converged:
            raise RuntimeError("TESPy did not converge")
        shell.set_attr(Q=compressor.P.val_SI * gas_heat_per_work(parameters["compressor"]))
    return {
        "mass_flow_kg_s": inlet.m.val_SI,
        "electric_power_w": compressor.P.val_SI / parameters["compressor"]["electrical_efficiency"],
        "condenser_heat_flow_w": -condenser.Q.val_SI,
        "discharge_temperature_k": discharge.T.val_SI,
    }


def deviations(actual: Point, expected: Point) -> dict[str, float]:
    """Relative deviations of what the plant uses."""

    def results(point: Point) -> dict[str, float]:
        heat = point["condenser_heat_flow_w"]
        return {
            "COP": heat / point["electric_power_w"],
            "Q_c": heat,
            "mass flow": point["mass_flow_kg_s"],
            "T_discharge": point["discharge_temperature_k"],
        }

    exact = results(expected)
    return {name: value / exact[name] - 1.0 for name, value in results(actual).items()}


def compare(refrigerant: str, loss_to_gas_share: float) -> list[float]:
    """Prints a table for one refrigerant; returns the largest deviation of each point."""
    parameters, points = rust_points(refrigerant, loss_to_gas_share)
    print(f"{refrigerant}, {loss_to_gas_share:.0%} of the motor's loss in the gas")
    print(
        "T_hot  T_cold  P[W]   COP   T_d   | CoolProp: COP      Q_c        m        T_d"
        "    | TESPy: COP      Q_c        m        T_d"
    )
    worst = []
    for point in points:
        if point["status"] != "Converged":
            continue  # A limit holds it back, so its power is not the one that is given.
        line = [deviations(point, cycle(parameters, point)) for cycle in (coolprop_cycle, tespy_cycle)]
        worst.append(max(abs(value) for result in line for value in result.values()))
        cop = point["condenser_heat_flow_w"] / point["electric_power_w"]
        discharge_degc = point["discharge_temperature_k"] - 273.15
        print(
            f"{point['hot_return_k'] - 273.15:5.1f}  {point['cold_return_k'] - 273.15:6.1f}"
            f"  {point['electric_power_w']:5.0f}  {cop:5.3f} {discharge_degc:5.1f} | "
            + " | ".join("  ".join(f"{value:+9.1e}" for value in result.values()) for result in line)
        )
    print(f"{refrigerant}: {len(worst)} points, largest deviation {max(worst):.1e}")
    return worst


def main() -> int:
    """Compares every built-in refrigerant; the exit status tells whether everything agrees."""
    worst = [
        deviation
        for refrigerant in REFRIGERANTS
        for share in LOSS_TO_GAS_SHARES
        for deviation in compare(refrigerant, share)
    ]
    print(f"{len(worst)} points, largest deviation {max(worst):.1e}, allowed {TOLERANCE:.0e}")
    return int(max(worst) > TOLERANCE or len(worst) < 120)


if __name__ == "__main__":
    sys.exit(main())
