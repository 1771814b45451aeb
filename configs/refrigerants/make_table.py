"""Writes the saturation-based property table of one subcritical refrigerant, with its limits, from CoolProp.

Everything is one-dimensional in saturation temperature; distances from saturation enter as polynomials whose
coefficients are columns of the table. `table_evaluator.py` documents how the columns are read. The limits
stand in the header: a vehicle gets those that it does not give itself together with the fluid.

    python configs/refrigerants/make_table.py R134a configs/refrigerants/r134a.csv \
        --reference rust_core/plant/tests/data/r134a_reference.csv
    python configs/refrigerants/make_table.py "R1234ze(E)" my-fluid.csv --maximum-pressure-bar 22
"""

import argparse
import shlex
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import CoolProp
import CoolProp.CoolProp
import numpy as np
from numpy.polynomial import chebyshev

LOWEST_SATURATION_K = 213.15
"""-60 degC, below the suction pressure of any automotive heat pump."""
DISTANCE_TO_CRITICAL_K = 5.5
"""Properties of the saturated fluid have unbounded slopes at the critical point."""
LARGEST_LIQUID_ERROR_J_KG = 15.0
"""Of the subcooling polynomial in the highest row; the table ends where it would be larger."""
TARGET_STEP_K = 1.5
LARGEST_SATURATION_DISTANCE_K = 10.0
"""Superheat and subcooling that the polynomials cover."""
LEAST_ENTROPY_DISTANCE_J_KG_K = 180.0
"""From dry saturated vapour at the condensing pressure; more where suction at -60 degC needs it."""
HIGHEST_DISCHARGE_K = 430.0
LOWEST_CRITICAL_DEGC = 60.0
"""A fluid whose critical point lies lower cannot condense at the temperatures of a heat pump's hot side."""


@dataclass(frozen=True)
class Limits:
    """What a vehicle with this fluid keeps unless its file says otherwise."""

    maximum_pressure_bar: float
    """Highest condensing pressure of usual components."""
    minimum_suction_pressure_bar: float
    """Lowest suction pressure; 1 bar keeps air out."""
    maximum_discharge_temperature_degc: float
    """Highest temperature of the gas that leaves the compressor, by oil and fluid."""
    source: str
    """Where they come from."""


USUAL = Limits(30.0, 1.0, 125.0, "usual of automotive components, not known for this fluid")
"""For a fluid that is not listed; its pressure is also kept within its table."""

LIMITS = {
    "R134a": Limits(
        30.0, 1.0, 130.0, "high-pressure switches of R134a cars open at 30 bar; POE oil: 120..130 degC"
    ),
    "R1234yf": Limits(
        29.0, 1.0, 120.0, "components of R134a, kept below the critical 33.8 bar; POE oil: 115..125"
    ),
    "R290": Limits(
        30.0, 1.0, 120.0, "components of PS 30..32 bar; oil thinned by dissolved propane: 110..125 degC"
    ),
    "R152A": Limits(
        30.0, 1.0, 130.0, "components and oil of R134a; the gas leaves hotter, so this limit acts first"
    ),
}
"""Limits of the built-in fluids, assumed from usual practice; ranges in the words."""

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
# Source: CoolProp {version} (HEOS), command: python configs/refrigerants/make_table.py {quoted} <output>
# Every column is interpolated over temperature_k (saturation, uniform grid) with a not-a-knot cubic spline.
# vapour_{{enthalpy,density,entropy}}_k: coefficient of superheat^k, 0..10 K [J/kg, kg/m3, J/(kg K) per K^k]
# liquid_enthalpy_k: coefficient of subcooling^k, subcooling 0..10 K, at saturation pressure [J/kg per K^k]
# dew_enthalpy [J/kg], dew_entropy [J/(kg K)]: dry saturated vapour
# isobar_enthalpy_k: coefficient of (s - dew_entropy)^k in h(p_sat, s); 0 is dew_enthalpy, 1 temperature_k
# isobar_temperature_k: coefficient of (h - dew_enthalpy)^k in T(p_sat, h) - temperature_k [K per (J/kg)^k]
# isobar_range: largest h - dew_enthalpy of that polynomial, at {highest} K; linear beyond [J/kg]
# Lines with "#:" are TOML: critical point, and limits of a vehicle with this fluid that gives none itself.
# Limits: {limits.source}
#: critical_temperature_degc = {critical_degc:.2f}
#: critical_pressure_bar = {critical_bar:.3f}
#: maximum_pressure_bar = {limits.maximum_pressure_bar}
#: minimum_suction_pressure_bar = {limits.minimum_suction_pressure_bar}
#: maximum_discharge_temperature_degc = {limits.maximum_discharge_temperature_degc}
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


def liquid_polynomial(fluid: CoolProp.AbstractState, temperature_k: float) -> tuple[np.ndarray, float]:
    """Coefficients of enthalpy below the bubble point over subcooling, and their largest error [J/kg]."""
    fluid.update(CoolProp.QT_INPUTS, 0.0, temperature_k)
    pressure, bubble_enthalpy = fluid.p(), fluid.hmass()
    distance = chebyshev_points(24) * LARGEST_SATURATION_DISTANCE_K
    enthalpy = []
    for subcooling in distance:
        fluid.update(CoolProp.PT_INPUTS, pressure, temperature_k - subcooling)
        enthalpy.append(fluid.hmass() - bubble_enthalpy)
    coefficients = fit(distance, np.array(enthalpy), range(1, 6))
    fitted = sum(c * distance**k for k, c in enumerate(coefficients, start=1))
    return coefficients, float(np.abs(fitted - enthalpy).max())


def entropy_distance(fluid: CoolProp.AbstractState) -> float:
    """Largest entropy above dry saturated vapour that the polynomials cover, for all rows [J/(kg K)]."""
    nodes = grid(fluid)
    fluid.update(CoolProp.QT_INPUTS, 1.0, nodes[0])
    fluid.update(CoolProp.PT_INPUTS, fluid.p(), nodes[0] + LARGEST_SATURATION_DISTANCE_K)
    highest = fluid.smass()
    fluid.update(CoolProp.QT_INPUTS, 1.0, nodes[-1])
    return max(LEAST_ENTROPY_DISTANCE_J_KG_K, 10.0 * float(np.floor((highest - fluid.smass()) / 10.0)))


def row(fluid: CoolProp.AbstractState, temperature_k: float, largest_entropy_distance: float) -> list[float]:
    """One line of the table."""
    fluid.update(CoolProp.QT_INPUTS, 1.0, temperature_k)
    pressure, dew_enthalpy, dew_entropy = fluid.p(), fluid.hmass(), fluid.smass()
    fluid.update(CoolProp.QT_INPUTS, 0.0, temperature_k)
    bubble_enthalpy = fluid.hmass()

    distance = chebyshev_points(24) * LARGEST_SATURATION_DISTANCE_K
    vapour = []
    for superheat in distance:
        fluid.update(CoolProp.PT_INPUTS, pressure, temperature_k + superheat)
        vapour.append((fluid.hmass(), fluid.rhomass(), fluid.smass()))

    entropy_distance = chebyshev_points(40) * largest_entropy_distance
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
        *liquid_polynomial(fluid, temperature_k)[0],
        dew_enthalpy,
        dew_entropy,
        *fit(entropy_distance, np.array(isobar_enthalpy), range(2, 5)),
        *fit(enthalpy_distance, np.array(isobar_temperature), range(1, 8)),
        isobar_range,
    ]


def grid(fluid: CoolProp.AbstractState) -> np.ndarray:
    """Uniform saturation temperatures from the lowest to near the critical point [K]."""
    highest = np.floor(fluid.T_critical() - 273.15 - DISTANCE_TO_CRITICAL_K) + 273.15
    while liquid_polynomial(fluid, highest)[1] > LARGEST_LIQUID_ERROR_J_KG:
        highest -= 1.0
    intervals = int(np.ceil((highest - LOWEST_SATURATION_K) / TARGET_STEP_K))
    return np.linspace(LOWEST_SATURATION_K, highest, intervals + 1)


def subcritical_fluid(name: str) -> CoolProp.AbstractState:
    """The equation of state of a pure fluid that condenses in a heat pump.

    Raises:
        ValueError: CoolProp has no pure fluid of that name, or it would be supercritical.
    """
    try:
        fluid = CoolProp.AbstractState("HEOS", name)
        pure = CoolProp.CoolProp.get_fluid_param_string(name, "pure") == "true"
    except (ValueError, RuntimeError):
        pure = False
    if not pure:
        raise ValueError(f"fluid is {name}, but must be the name of a pure fluid of CoolProp")
    critical_degc = fluid.T_critical() - 273.15
    if critical_degc < LOWEST_CRITICAL_DEGC:
        raise ValueError(
            f"fluid is {name}, but must have its critical point at or above {LOWEST_CRITICAL_DEGC:.0f} degC: "
            f"this one's is at {critical_degc:.1f} degC, a heat pump with it is supercritical on its hot side"
        )
    return fluid


def limits_of(name: str, fluid: CoolProp.AbstractState) -> Limits:
    """Limits of a built-in fluid, or what is usual, within the fluid's table."""
    limits = LIMITS.get(name, USUAL)
    fluid.update(CoolProp.QT_INPUTS, 1.0, grid(fluid)[-1])
    highest_bar = float(np.floor(fluid.p() / 1e5))
    return replace(limits, maximum_pressure_bar=min(limits.maximum_pressure_bar, highest_bar))


def write_table(name: str, path: Path, **given: float | None) -> None:
    """Computes and writes the table; limits that are given stand in place of the fluid's."""
    fluid = subcritical_fluid(name)
    chosen = {key: value for key, value in given.items() if value is not None}
    limits = replace(limits_of(name, fluid), **chosen)
    distance = entropy_distance(fluid)
    lines = [",".join(COLUMNS)]
    lines += [",".join(f"{value:.11g}" for value in row(fluid, t, distance)) for t in grid(fluid)]
    explanation = EXPLANATION.format(
        fluid=name,
        quoted=shlex.quote(name),
        version=CoolProp.__version__,
        highest=HIGHEST_DISCHARGE_K,
        limits=limits,
        critical_degc=fluid.T_critical() - 273.15,
        critical_bar=fluid.p_critical() / 1e5,
    )
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


def main() -> int:
    """Command line; what is wrong is told in one line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fluid", help="CoolProp name, for example R134a or R290")
    parser.add_argument("output", type=Path, help="table to write")
    parser.add_argument("--reference", type=Path, help="also write random CoolProp states for the Rust test")
    parser.add_argument("--states", type=int, default=400, help="how many of them")
    keys = ("maximum_pressure_bar", "minimum_suction_pressure_bar", "maximum_discharge_temperature_degc")
    for key in keys:
        parser.add_argument(
            f"--{key.replace('_', '-')}", type=float, help="instead of the fluid's usual limit"
        )
    arguments = vars(parser.parse_args())
    others = ("fluid", "output", "reference", "states")
    name, output, reference, count = (arguments.pop(key) for key in others)
    try:
        write_table(name, output, **arguments)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    if reference:
        states = reference_states(name, count, seed=134)
        header = f"# {name}, CoolProp {CoolProp.__version__}, SI units, by make_table.py --reference\n"
        lines = [",".join(f"{value:.11g}" for value in state) for state in states]
        reference.parent.mkdir(parents=True, exist_ok=True)
        reference.write_text(header + REFERENCE_COLUMNS + "\n" + "\n".join(lines) + "\n")

    return 0


if __name__ == "__main__":
    sys.exit(main())
