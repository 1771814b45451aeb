"""Writes the saturation-based property table of one subcritical refrigerant from CoolProp.

Everything is one-dimensional in saturation temperature; distances from saturation enter as polynomials whose
coefficients are columns of the table. `table_evaluator.py` documents how the columns are read.

    python configs/refrigerants/make_table.py R134a configs/refrigerants/r134a.csv \
        --reference rust_core/plant/tests/data/r134a_reference.csv
"""

import argparse
from pathlib import Path

import CoolProp
import numpy as np
from numpy.polynomial import chebyshev

LOWEST_SATURATION_K = 213.15
"""-60 degC, below the suction pressure of any automotive heat pump."""
DISTANCE_TO_CRITICAL_K = 5.5
"""Properties of the saturated fluid have unbounded slopes at the critical point."""
TARGET_STEP_K = 1.5
LARGEST_SATURATION_DISTANCE_K = 10.0
"""Superheat and subcooling that the polynomials cover."""
LARGEST_ENTROPY_DISTANCE_J_KG_K = 180.0
"""From dry saturated vapour at the condensing pressure; covers suction at -60 degC with 10 K superheat."""
HIGHEST_DISCHARGE_K = 430.0

COLUMNS = (
    "temperature_k",
    *(f"vapour_enthalpy_{k}" for k in range(4)),
    *(f"vapour_density_{k}" for k in range(4)),
    *(f"vapour_entropy_{k}" for k in range(4)),
    "pressure_pa",
    *(f"liquid_enthalpy_{k}" for k in range(6)),
    "dew_enthalpy",
    "dew_entropy",
    *(f"isobar_enthalpy_{k}" for k in range(2, 5)),
    *(f"isobar_temperature_{k}" for k in range(1, 8)),
    "isobar_range",
)

EXPLANATION = """\
# Saturation-based property table of {fluid}. Generated, do not edit.
# Source: CoolProp {version} (HEOS), command: python configs/refrigerants/make_table.py {fluid} <output>
# Every column is interpolated over temperature_k (saturation, uniform grid) with a not-a-knot cubic spline.
# vapour_{{enthalpy,density,entropy}}_k: coefficient of superheat^k, 0..10 K [J/kg, kg/m3, J/(kg K) per K^k]
# liquid_enthalpy_k: coefficient of subcooling^k, subcooling 0..10 K, at saturation pressure [J/kg per K^k]
# dew_enthalpy [J/kg], dew_entropy [J/(kg K)]: dry saturated vapour
# isobar_enthalpy_k: coefficient of (s - dew_entropy)^k in h(p_sat, s); 0 is dew_enthalpy, 1 temperature_k
# isobar_temperature_k: coefficient of (h - dew_enthalpy)^k in T(p_sat, h) - temperature_k [K per (J/kg)^k]
# isobar_range: largest h - dew_enthalpy of that polynomial, at {highest} K; linear beyond [J/kg]
"""


def chebyshev_points(count: int) -> np.ndarray:
    """Chebyshev nodes of the unit interval: least squares on them is close to minimax."""
    return 0.5 * (1.0 + chebyshev.chebpts1(count))


def fit(distance: np.ndarray, values: np.ndarray, degrees: range) -> np.ndarray:
    """Least-squares coefficients of the given powers of `distance`."""
    largest = distance.max()
    basis = np.stack([(distance / largest) ** k for k in degrees], axis=1)
    coefficients = np.linalg.lstsq(basis, values, rcond=None)[0]
    return coefficients / largest ** np.array(degrees)


def row(fluid: CoolProp.AbstractState, temperature_k: float) -> list[float]:
    """One line of the table."""
    fluid.update(CoolProp.QT_INPUTS, 1.0, temperature_k)
    pressure, dew_enthalpy, dew_entropy = fluid.p(), fluid.hmass(), fluid.smass()
    fluid.update(CoolProp.QT_INPUTS, 0.0, temperature_k)
    bubble_enthalpy = fluid.hmass()

    distance = chebyshev_points(24) * LARGEST_SATURATION_DISTANCE_K
    vapour, liquid = [], []
    for superheat in distance:
        fluid.update(CoolProp.PT_INPUTS, pressure, temperature_k + superheat)
        vapour.append((fluid.hmass(), fluid.rhomass(), fluid.smass()))
    for subcooling in distance:
        fluid.update(CoolProp.PT_INPUTS, pressure, temperature_k - subcooling)
        liquid.append(fluid.hmass() - bubble_enthalpy)

    entropy_distance = chebyshev_points(40) * LARGEST_ENTROPY_DISTANCE_J_KG_K
    isobar_enthalpy = []
    for sigma in entropy_distance:
        fluid.update(CoolProp.PSmass_INPUTS, pressure, dew_entropy + sigma)
        isobar_enthalpy.append(fluid.hmass() - dew_enthalpy - temperature_k * sigma)

    fluid.update(CoolProp.PT_INPUTS, pressure, HIGHEST_DISCHARGE_K)
    isobar_range = fluid.hmass() - dew_enthalpy
    enthalpy_distance = chebyshev_points(40) * isobar_range
    isobar_temperature = []
    for excess in enthalpy_distance:
        fluid.update(CoolProp.HmassP_INPUTS, dew_enthalpy + excess, pressure)
        isobar_temperature.append(fluid.T() - temperature_k)

    return [
        temperature_k,
        *(c for values in np.array(vapour).T for c in fit(distance, values, range(4))),
        pressure,
        bubble_enthalpy,
        *fit(distance, np.array(liquid), range(1, 6)),
        dew_enthalpy,
        dew_entropy,
        *fit(entropy_distance, np.array(isobar_enthalpy), range(2, 5)),
        *fit(enthalpy_distance, np.array(isobar_temperature), range(1, 8)),
        isobar_range,
    ]


def grid(fluid: CoolProp.AbstractState) -> np.ndarray:
    """Uniform saturation temperatures from the lowest to near the critical point [K]."""
    highest = np.floor(fluid.T_critical() - 273.15 - DISTANCE_TO_CRITICAL_K) + 273.15
    intervals = int(np.ceil((highest - LOWEST_SATURATION_K) / TARGET_STEP_K))
    return np.linspace(LOWEST_SATURATION_K, highest, intervals + 1)


def write_table(name: str, path: Path) -> None:
    """Computes and writes the table."""
    fluid = CoolProp.AbstractState("HEOS", name)
    lines = [",".join(COLUMNS)]
    lines += [",".join(f"{value:.11g}" for value in row(fluid, t)) for t in grid(fluid)]
    explanation = EXPLANATION.format(fluid=name, version=CoolProp.__version__, highest=HIGHEST_DISCHARGE_K)
    path.write_text(explanation + "\n".join(lines) + "\n")


REFERENCE_COLUMNS = (
    "evaporating_k,superheat_k,evaporating_pressure_pa,suction_enthalpy,suction_density,suction_entropy,"
    "condensing_k,subcooling_k,condensing_pressure_pa,liquid_enthalpy,isentropic_enthalpy,discharge_enthalpy,"
    "discharge_k"
)


def reference_states(name: str, count: int, seed: int) -> np.ndarray:
    """Random cycle states straight from CoolProp, columns as in REFERENCE_COLUMNS.

    Discharge temperatures stay between the dew point and 150 degC.
    """
    fluid = CoolProp.AbstractState("HEOS", name)
    nodes = grid(fluid)
    random = np.random.default_rng(seed)
    states: list[tuple[float, ...]] = []
    while len(states) < count:
        evaporating = random.uniform(nodes[0], 333.15)
        condensing = random.uniform(max(evaporating + 1.0, 223.15), nodes[-1])
        superheat, subcooling = random.uniform(0.01, LARGEST_SATURATION_DISTANCE_K, 2)
        efficiency = random.uniform(0.3, 0.9)
        fluid.update(CoolProp.QT_INPUTS, 1.0, evaporating)
        low = fluid.p()
        fluid.update(CoolProp.PT_INPUTS, low, evaporating + superheat)
        suction = (fluid.hmass(), fluid.rhomass(), fluid.smass())
        fluid.update(CoolProp.QT_INPUTS, 1.0, condensing)
        high = fluid.p()
        fluid.update(CoolProp.PT_INPUTS, high, condensing - subcooling)
        liquid = fluid.hmass()
        fluid.update(CoolProp.PSmass_INPUTS, high, suction[2])
        isentropic = fluid.hmass()
        discharge = suction[0] + (isentropic - suction[0]) / efficiency
        fluid.update(CoolProp.HmassP_INPUTS, discharge, high)
        discharge_k = fluid.T()
        if discharge_k > 423.15:
            continue
        states.append(
            (
                *(evaporating, superheat, low, *suction),
                *(condensing, subcooling, high, liquid),
                *(isentropic, discharge, discharge_k),
            )
        )
    return np.array(states)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fluid", help="CoolProp name, for example R134a or R1234yf")
    parser.add_argument("output", type=Path, help="table to write")
    parser.add_argument("--reference", type=Path, help="also write random CoolProp states for the Rust test")
    arguments = parser.parse_args()
    write_table(arguments.fluid, arguments.output)
    if arguments.reference:
        states = reference_states(arguments.fluid, 400, seed=134)
        header = (
            f"# {arguments.fluid}, CoolProp {CoolProp.__version__}, SI units, by make_table.py --reference\n"
        )
        lines = [",".join(f"{value:.11g}" for value in state) for state in states]
        arguments.reference.parent.mkdir(parents=True, exist_ok=True)
        arguments.reference.write_text(header + REFERENCE_COLUMNS + "\n" + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
