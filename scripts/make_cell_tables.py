"""Circuit tables of a vehicle whose resistance rises with cold as that of measured cells does.

    python scripts/make_cell_tables.py configs/vehicles/jeffs2019.toml

Takes the circuit tables of that file, their dependence on state of charge included, and gives every row the
factor with which the resistance over 10 s at half charge, relative to 25 degC, becomes the geometric mean
of two cells: the published measurement of one, the published model of another. Time constants stay. Tables
that already do so come out as they are.
"""

import itertools
import math
import sys
import tomllib
from pathlib import Path

PULSE_S = 10.0
WARM_DEGC = 25.0

# R(10 s) at half charge [mohm Ah]; both cells: resistance times capacity.
# Panasonic 18650PF, 2.9 Ah, pulses at 1C (Kollmeyer, doi 10.17632/wykht8y7tg):
# 37.3, 52.0, 79.7, 129.8, 217.0 mohm.
MEASURED = {25.6: 108.2, 10.8: 150.8, 0.3: 231.1, -9.9: 376.4, -20.1: 629.3}
# Kokam, parameter set Ecker2015 of PyBaMM 26.10.1.1, Doyle-Fuller-Newman model, isothermal.
MODELLED = {40.0: 21.7, 25.0: 42.1, 10.0: 90.1, 0.0: 145.0, -10.0: 212.0, -20.0: 285.0, -30.0: 359.0}

Table = list[list[float]]


def ratio(cell: dict[float, float], degc: float) -> float:
    """Resistance relative to 25 degC.

    Its logarithm is linear in the inverse temperature between the points; beyond them as in the last piece.
    """
    points = sorted((1.0 / (temperature + 273.15), math.log(value)) for temperature, value in cell.items())

    def logarithm(inverse_k: float) -> float:
        pieces = list(itertools.pairwise(points))
        low, high = next((piece for piece in pieces if inverse_k <= piece[1][0]), pieces[-1])
        return low[1] + (inverse_k - low[0]) / (high[0] - low[0]) * (high[1] - low[1])

    return math.exp(logarithm(1.0 / (degc + 273.15)) - logarithm(1.0 / (WARM_DEGC + 273.15)))


def wanted(degc: float) -> float:
    """Geometric mean of both cells' ratios."""
    return math.sqrt(ratio(MEASURED, degc) * ratio(MODELLED, degc))


def pulse_resistances(circuit: dict[str, Table]) -> list[float]:
    """R(10 s) of each row at half charge [ohm]."""
    column = circuit["state_of_charge"].index(0.5)  # type: ignore[arg-type]
    keys = ("series_resistance_ohm", "polarisation_resistance_ohm", "polarisation_capacitance_f")
    rows = zip(*(circuit[key] for key in keys), strict=True)
    values = ((row[0][column], row[1][column], row[2][column]) for row in rows)
    return [r0 + r1 * -math.expm1(-PULSE_S / (r1 * c1)) for r0, r1, c1 in values]


def at_25_degc(temperatures: list[float], values: list[float]) -> float:
    """A row's value between its neighbours, linear as the plant reads the tables."""
    above = next(i for i, temperature in enumerate(temperatures) if temperature >= WARM_DEGC)
    share = (WARM_DEGC - temperatures[above - 1]) / (temperatures[above] - temperatures[above - 1])
    return values[above - 1] + share * (values[above] - values[above - 1])


def rounded(value: float) -> float:
    """Four digits."""
    return float(f"{value:.4g}")


def print_table(name: str, table: Table, temperatures: list[float]) -> None:
    """A table as it stands in a vehicle's file."""
    print(f"{name} = [")
    for degc, row in zip(temperatures, table, strict=True):
        print(f"    [{', '.join(str(rounded(value)) for value in row)}], # {degc:g} degC")
    print("]")


def main() -> None:
    """Command line."""
    circuit = tomllib.loads(Path(sys.argv[1]).read_text())["battery"]["circuit"]
    temperatures: list[float] = circuit["temperature_degc"]
    present = pulse_resistances(circuit)
    warm = at_25_degc(temperatures, present)
    targets = [wanted(degc) for degc in temperatures]
    # Relative to 25 degC as the plant interpolates it.
    targets = [target / at_25_degc(temperatures, targets) for target in targets]
    factors = [target * warm / value for target, value in zip(targets, present, strict=True)]
    print("# degC: ratio of R(10 s) at half charge to 25 degC: measured, modelled; before, now")
    for degc, value, target in zip(temperatures, present, targets, strict=True):
        cells = f"{ratio(MEASURED, degc):5.2f} {ratio(MODELLED, degc):5.2f}"
        print(f"# {degc:5.0f}: {cells}; {value / warm:5.2f} {target:5.2f}")
    print(f"temperature_degc = {temperatures}")
    print(f"state_of_charge = {circuit['state_of_charge']}")
    for name in ("series_resistance_ohm", "polarisation_resistance_ohm"):
        table = [
            [value * factor for value in row] for row, factor in zip(circuit[name], factors, strict=True)
        ]
        print_table(name, table, temperatures)
    name = "polarisation_capacitance_f"
    table = [[value / factor for value in row] for row, factor in zip(circuit[name], factors, strict=True)]
    print_table(name, table, temperatures)


if __name__ == "__main__":
    main()
