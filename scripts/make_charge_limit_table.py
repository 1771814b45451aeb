"""Largest charging rates that keep a graphite anode at or above 0 V: tables for `[battery.charge_limit]`.

Doyle-Fuller-Newman model of PyBaMM with the cell of O'Kane et al. 2022 (LG M50, 5 Ah, doi
10.1039/D2CP00417H), isothermal. The anode potential is that of the graphite against the electrolyte at the
separator, where lithium plates first. Below -10 degC the cell's Arrhenius laws are extrapolated.

    uv run --no-project --with pybamm==26.10.1.1 scripts/make_charge_limit_table.py

That takes about 4 minutes. With `--check VEHICLE` it drives the recuperation of a cycle through the cell as
the plant's law allows it with the table of that vehicle's file, at all decelerations, and prints the lowest
potential.
"""

import argparse
import csv
import math
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pybamm
from pybamm.models.full_battery_models.lithium_ion.electrode_soh import get_min_max_stoichiometries

ROOT = Path(__file__).parents[1]
CELL = "OKane2022"
TEMPERATURES_DEGC = (-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0, 45.0)
STATES_OF_CHARGE = (0.1, 0.3, 0.5, 0.7, 0.9, 1.0)
PULSE_S = 10.0
CONTINUOUS_S = 1800.0
MEMORY_S = 60.0
LARGEST_RATE_PER_H = 4.0
SMALLEST_RATE_PER_H = 0.002
ANODE = "Negative electrode surface potential difference at separator interface [V]"

Table = list[list[float]]


class Cell:
    """The cell, ready to be charged from rest at any temperature and state of charge."""

    def __init__(self) -> None:
        values = pybamm.ParameterValues(CELL)
        self.empty_to_full = get_min_max_stoichiometries(values)
        self.largest = [
            float(values[f"Maximum concentration in {electrode} electrode [mol.m-3]"])
            for electrode in ("negative", "positive")
        ]
        self.nominal_ah = float(values["Nominal cell capacity [A.h]"])
        x_0, x_100, _, _ = self.empty_to_full
        area_m2 = values["Electrode width [m]"] * values["Electrode height [m]"]
        share = values["Negative electrode active material volume fraction"]
        sites_mol = share * values["Negative electrode thickness [m]"] * area_m2 * self.largest[0]
        self.capacity_ah = float((x_100 - x_0) * sites_mol * pybamm.constants.F.value / 3600.0)
        given = ["Ambient temperature [K]", "Initial temperature [K]"]
        given += [
            f"Initial concentration in {electrode} electrode [mol.m-3]"
            for electrode in ("negative", "positive")
        ]
        # Voltage limits are the vehicle's own matter.
        values.update(dict.fromkeys(given, "[input]"))
        values.update({"Upper voltage cut-off [V]": 6.0, "Lower voltage cut-off [V]": 0.5})
        self.values = values

    def simulation(self, current: object) -> pybamm.Simulation:
        """A simulation with a current, positive while discharging [A]."""
        values = self.values.copy()
        values["Current function [A]"] = current
        # A current that changes must not be stepped over.
        options = {} if current == "[input]" else {"dt_max": 1.0}
        solver = pybamm.IDAKLUSolver(rtol=1e-6, atol=1e-8, options=options)
        return pybamm.Simulation(pybamm.lithium_ion.DFN(), parameter_values=values, solver=solver)

    def at_rest(self, temperature_degc: float, state_of_charge: float) -> dict[str, float]:
        """Inputs of a simulation that begins at rest."""
        x_0, x_100, y_100, y_0 = self.empty_to_full
        temperature_k = temperature_degc + 273.15
        return {
            "Ambient temperature [K]": temperature_k,
            "Initial temperature [K]": temperature_k,
            "Initial concentration in negative electrode [mol.m-3]": self.largest[0]
            * (x_0 + state_of_charge * (x_100 - x_0)),
            "Initial concentration in positive electrode [mol.m-3]": self.largest[1]
            * (y_0 + state_of_charge * (y_100 - y_0)),
        }


def anode_potential_v(
    cell: Cell,
    charge: pybamm.Simulation,
    at: tuple[float, float],
    rate_per_h: float,
    duration_s: float,
) -> float:
    """Anode potential where charging at a constant rate from rest ends at a state of charge."""
    degc, state_of_charge = at
    current_a = rate_per_h * cell.nominal_ah
    duration_s = min(duration_s, 3600.0 * state_of_charge * cell.capacity_ah / current_a)
    start = state_of_charge - current_a * duration_s / 3600.0 / cell.capacity_ah
    inputs = cell.at_rest(degc, start) | {"Current function [A]": -current_a}
    try:
        solution = charge.solve([0.0, duration_s], inputs=inputs)
    except pybamm.SolverError:
        return -math.inf
    reached = float(solution.t[-1]) > 0.999 * duration_s
    return float(solution[ANODE].entries[-1]) if reached else -math.inf


def largest_rate_per_h(potential_v: Callable[[float], float]) -> float:
    """Largest rate with a potential of at least 0 V, within half a percent; at most that of the table."""
    if potential_v(LARGEST_RATE_PER_H) >= 0.0:
        return LARGEST_RATE_PER_H
    low, high = SMALLEST_RATE_PER_H, LARGEST_RATE_PER_H
    if potential_v(low) < 0.0:
        return 0.0
    while high / low > 1.005:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if potential_v(middle) >= 0.0 else (low, middle)
    return low


def rising(rows: Table) -> Table:
    """The table rounded, no value above that of a warmer cell: the search's tolerance goes."""
    for warmer, colder in zip(rows[::-1], rows[-2::-1], strict=False):
        for column in range(len(STATES_OF_CHARGE)):
            colder[column] = min(colder[column], warmer[column])
    return [[round(value, 3) for value in row] for row in rows]


def tables(cell: Cell) -> tuple[Table, Table]:
    """Rates for pulses and for long, one row a temperature, one column a state of charge [1/h]."""
    charge = cell.simulation("[input]")

    def rates(duration_s: float) -> Table:
        return [
            [
                largest_rate_per_h(
                    lambda rate, at=(degc, soc): anode_potential_v(cell, charge, at, rate, duration_s)  # type: ignore[misc]
                )
                for soc in STATES_OF_CHARGE
            ]
            for degc in TEMPERATURES_DEGC
        ]

    return rising(rates(PULSE_S)), rising(rates(CONTINUOUS_S))


def print_tables(pulse: Table, continuous: Table) -> None:
    """Prints the tables as they stand in a vehicle's file."""
    print(f"rate_memory_s = {MEMORY_S}")
    print(f"temperature_degc = {list(TEMPERATURES_DEGC)}")
    print(f"state_of_charge = {list(STATES_OF_CHARGE)}")
    for name, table in (("pulse_rate_per_h", pulse), ("continuous_rate_per_h", continuous)):
        print(f"{name} = [")
        for degc, row in zip(TEMPERATURES_DEGC, table, strict=True):
            print(f"    [{', '.join(f'{value:.3f}' for value in row)}], # {degc:g} degC")
        print("]")


class Law:
    """The plant's law (`components/rate_limit.rs`) with a vehicle's table, for the table's own cell."""

    def __init__(self, file: Path) -> None:
        battery = tomllib.loads(file.read_text())["battery"]
        self.limit = battery["charge_limit"]
        self.decay = math.exp(-1.0 / battery["rate_memory_s"])
        self.pulse_share = 1.0 - math.exp(-PULSE_S / battery["rate_memory_s"])
        self.memory_per_h = 0.0

    def rates(self, degc: float, state_of_charge: float) -> tuple[float, float]:
        """Pulse and continuous rate at a temperature that the table has [1/h]."""
        row = self.limit["temperature_degc"].index(degc)
        at = [
            float(np.interp(state_of_charge, self.limit["state_of_charge"], self.limit[key][row]))
            for key in ("pulse_rate_per_h", "continuous_rate_per_h")
        ]
        return at[0], at[1]

    def second(self, degc: float, state_of_charge: float, *, charges: bool) -> float:
        """Rate of the next second, the largest one or none [1/h]."""
        pulse, continuous = self.rates(degc, state_of_charge)
        rate = 0.0
        if charges:
            excess = pulse - continuous
            at_rest = (1.0 - self.pulse_share) * pulse * continuous
            held = continuous - self.pulse_share * pulse + (1.0 - self.decay) * excess
            rate = min(max((at_rest - self.memory_per_h * self.decay * excess) / held, 0.0), pulse)
        self.memory_per_h = rate + (self.memory_per_h - rate) * self.decay
        return rate


def check(cell: Cell, file: Path) -> None:
    """Lowest anode potential where every deceleration charges as much as the plant's law allows."""
    with (ROOT / "configs/cycles/wltc-class3b.csv").open() as lines:
        rows = list(csv.reader(line for line in lines if not line.startswith("#")))
    braking = np.diff([float(row[-1]) / 3.6 for row in rows[1:]]) < -0.2
    print("degc, SOC at start: lowest anode potential [mV], charged [C-rate times minutes]")
    for degc in (-10.0, 0.0, 10.0):
        for start in (0.5, 0.9):
            law, state_of_charge, rates = Law(file), start, [0.0]
            for charges in braking:
                rates.append(law.second(degc, state_of_charge, charges=bool(charges)))
                state_of_charge += rates[-1] / 3600.0 * cell.nominal_ah / cell.capacity_ah
            times_s = np.arange(len(rates), dtype=float)
            current = pybamm.Interpolant(times_s, -cell.nominal_ah * np.array(rates), pybamm.t)
            solution = cell.simulation(current).solve(times_s[[0, -1]], inputs=cell.at_rest(degc, start))
            lowest_mv = 1000.0 * float(solution[ANODE].entries.min())
            print(f"{degc:5.0f} {start:4.1f}: {lowest_mv:6.2f} {sum(rates) / 60.0:6.2f}")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--check", type=Path, metavar="VEHICLE", help="drive the law of that file through the cell"
    )
    arguments = parser.parse_args()
    if arguments.check:
        check(Cell(), arguments.check)
    else:
        print_tables(*tables(Cell()))


if __name__ == "__main__":
    main()
