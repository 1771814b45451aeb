# /// script
# requires-python = ">=3.11"
# dependencies = ["ev-heat-pump-gym", "pybamm==26.10.1.1", "numpy", "pandas", "scipy"]
#
# [tool.uv.sources]
# ev-heat-pump-gym = { path = ".." }
# ///
"""Compares the plant's battery with PyBaMM's Thevenin model: same tables, current and temperature.

Both have one RC pair. PyBaMM integrates state of charge and the pair's voltage by itself (IDAKLU). It is
given a cell's current, constant over each second, the temperature at the second's beginning, and R0, R1,
C1 and the open-circuit voltage of the vehicle's file, scaled to its cell. The plant gives the mean
voltage of a second, so PyBaMM's is averaged too (Simpson, five points). Heat is that of the resistors;
PyBaMM's own figure counts what the capacitor takes up as heat at once.

One difference is of the model, not of its numbers. Where temperature or state of charge change C1,
PyBaMM keeps the pair's voltage, so that energy comes from nowhere or is lost; the plant keeps the
energy, as its ledger must close. The comparison adds that term to PyBaMM's pair. Without it, as PyBaMM
is, a warm trip agrees as well (C1 changes by an eighth), a cold one does not: 7 mV and 1.4 % at 0 degC,
20 mV and 2.9 % at -20 degC.

    uv run scripts/check_battery.py
"""

import sys
import tomllib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
import pybamm
from scipy.interpolate import interpn

import hp_gym

VEHICLE: Final = Path(__file__).parents[1] / "configs" / "vehicles" / "jeffs2019.toml"
CASES: Final = (
    ("jeffs2019/case1-1", 0.0, True),  # heated to 20 degC
    ("jeffs2019/case1-3", 0.0, True),  # isolated
    ("jeffs2019/case1-3", -20.0, True),
    ("jeffs2019/case1-3", 25.0, True),
    ("jeffs2019/case1-3", 25.0, False),
)
"""Scenario, ambient temperature [degC], and whether PyBaMM's pair keeps its energy, as the plant's does."""

TOLERANCE_V: Final = 1e-3
HEAT_TOLERANCE: Final = 5e-3
ZERO_CELSIUS_K: Final = 273.15
SIMPSON: Final = np.array([1.0, 4.0, 2.0, 4.0, 1.0]) / 12.0

Function = Callable[..., Any]


def cell_scale(battery: dict[str, Any]) -> float:
    """Resistance of a cell over that of the tables."""
    ratio = battery["circuit_reference_capacity_ah"] / battery["cell_capacity_ah"]
    return float(battery["resistance_scale"] * ratio)


def tables(battery: dict[str, Any]) -> dict[str, Function]:
    """R0, R1, C1 and open-circuit voltage of a cell as PyBaMM takes them."""
    circuit = battery["circuit"]
    scale = cell_scale(battery)
    axes = (
        np.array(circuit["temperature_degc"]) + ZERO_CELSIUS_K,
        np.array(circuit["state_of_charge"]),
    )
    series = np.array(circuit["series_resistance_ohm"]) * scale
    polarisation = np.array(circuit["polarisation_resistance_ohm"]) * scale
    # The plant keeps the pair's time constant, scaled or not, and interpolates that.
    products = zip(circuit["polarisation_resistance_ohm"], circuit["polarisation_capacitance_f"], strict=True)
    time_constant = np.array([np.array(r) * np.array(c) for r, c in products])
    temperature_k = pybamm.InputParameter("Battery temperature [K]")

    def table(values: np.ndarray[Any, Any], soc: pybamm.Symbol) -> pybamm.Symbol:
        return pybamm.Interpolant(axes, values, [temperature_k, soc], interpolator="linear")

    voltage = battery["open_circuit_voltage"]
    points = np.array(voltage["state_of_charge"]), np.array(voltage["voltage_v"])
    return {
        "R0 [Ohm]": lambda _temperature, _current, soc: table(series, soc),
        "R1 [Ohm]": lambda _temperature, _current, soc: table(polarisation, soc),
        "C1 [F]": lambda _temperature, _current, soc: table(time_constant, soc) / table(polarisation, soc),
        "Open-circuit voltage [V]": lambda soc: pybamm.Interpolant(*points, soc, interpolator="linear"),
    }


def thevenin(battery: dict[str, Any], state_of_charge: float, *, keeps_energy: bool) -> pybamm.Simulation:
    """PyBaMM's model of a cell at rest."""
    values = pybamm.ParameterValues("ECM_Example")
    capacity_ah = battery["cell_capacity_ah"]
    values.update(
        {
            **tables(battery),
            "Initial SoC": state_of_charge,
            "Cell capacity [A.h]": capacity_ah,
            "Nominal cell capacity [A.h]": capacity_ah,
            "Entropic change [V/K]": lambda _voltage, _temperature: pybamm.Scalar(0.0),
            "Current function [A]": "[input]",
            # Limits are the vehicle's own matter.
            "Lower voltage cut-off [V]": 1.0,
            "Upper voltage cut-off [V]": 6.0,
        }
    )
    model = pybamm.equivalent_circuit.Thevenin()
    pair_v = model.variables["Element-1 overpotential [V]"]
    if keeps_energy:
        rise = pybamm.InputParameter("Half the rise of ln C1 [1/s]")
        model.rhs[pair_v] = model.rhs[pair_v] - rise * pair_v
    # The model stops at a full battery, where trips begin.
    model.events = []
    solver = pybamm.IDAKLUSolver(rtol=1e-9, atol=1e-9)
    return pybamm.Simulation(model, parameter_values=values, solver=solver)


def capacitance_f(
    battery: dict[str, Any], temperature_degc: np.ndarray[Any, Any], state_of_charge: np.ndarray[Any, Any]
) -> np.ndarray[Any, Any]:
    """C1 of a cell at each second."""
    circuit = battery["circuit"]
    scale = cell_scale(battery)
    axes = circuit["temperature_degc"], circuit["state_of_charge"]
    resistance = np.array(circuit["polarisation_resistance_ohm"])
    time_constant = resistance * np.array(circuit["polarisation_capacitance_f"])
    points = np.column_stack([temperature_degc, state_of_charge])
    table = partial(interpn, axes, xi=points, bounds_error=False, fill_value=None)
    return np.asarray(table(values=time_constant) / (table(values=resistance) * scale))


def compare(
    scenario: str, ambient_degc: float, battery: dict[str, Any], *, keeps_energy: bool
) -> tuple[float, float]:
    """Prints one trip.

    Returns:
        Largest difference of a cell's voltage [V], relative difference of the resistors' heat over the trip.
    """
    overrides = [f"scenario.climate.ambient_temperature_degc={ambient_degc}"]
    trip = hp_gym.simulate(scenario, overrides=overrides).to_pandas()
    cells = battery["cells_in_series"] * battery["strings_in_parallel"]
    current_a = trip["battery_current_a"].to_numpy() / battery["strings_in_parallel"]
    voltage_v = trip["battery_voltage_v"].to_numpy() / battery["cells_in_series"]
    temperature_degc = trip["battery_temperature_degc"].to_numpy()
    loss_j = trip["battery_loss_w"].to_numpy() / cells
    capacitance = capacitance_f(battery, temperature_degc, trip["charge_soc"].to_numpy())
    half_rise = 0.5 * np.diff(np.log(capacitance))
    simulation = thevenin(battery, float(trip["charge_soc"].iloc[0]), keeps_energy=keeps_energy)
    worst_v, heat_j, own_heat_j = 0.0, 0.0, 0.0
    for second in range(1, len(trip)):
        inputs = {
            "Current function [A]": current_a[second],
            "Battery temperature [K]": temperature_degc[second - 1] + ZERO_CELSIUS_K,
        }
        if keeps_energy:
            inputs["Half the rise of ln C1 [1/s]"] = half_rise[second - 1]
        step = simulation.step(1.0, t_interp=np.linspace(0.0, 1.0, 5), inputs=inputs, save=False)
        entries = {name: np.asarray(step[name].entries)[-5:] for name in NAMES}
        worst_v = max(worst_v, abs(float(SIMPSON @ entries["Voltage [V]"]) - voltage_v[second]))
        pair_w = entries["Element-1 overpotential [V]"] ** 2 / entries["R1 [Ohm]"]
        heat_j += float(SIMPSON @ (entries["Element-0 irreversible heat generation [W]"] + pair_w))
        own_heat_j += float(SIMPSON @ entries["Total heat generation [W]"])
    plant_j = float(loss_j[1:].sum())
    heat, own_heat = heat_j / plant_j - 1.0, own_heat_j / plant_j - 1.0
    print(
        f"{scenario} at {ambient_degc:g} degC, {'energy' if keeps_energy else 'voltage'} of the pair kept: "
        f"{np.abs(current_a).max():.0f} A, {voltage_v[1:].min():.3f}..{voltage_v[1:].max():.3f} V a cell, "
        f"C1 {capacitance.min():.0f}..{capacitance.max():.0f} F; voltage {1e3 * worst_v:.3f} mV, "
        f"heat {100.0 * heat:+.3f} % (PyBaMM's own {100.0 * own_heat:+.3f} %) of {plant_j / 1e3:.1f} kJ",
        flush=True,
    )
    return worst_v, abs(heat)


NAMES: Final = (
    "Voltage [V]",
    "Element-1 overpotential [V]",
    "R1 [Ohm]",
    "Element-0 irreversible heat generation [W]",
    "Total heat generation [W]",
)


def main() -> int:
    """Compares all trips; the exit status tells whether everything agrees."""
    battery = tomllib.loads(VEHICLE.read_text(encoding="utf-8"))["battery"]
    found = [compare(name, degc, battery, keeps_energy=kept) for name, degc, kept in CASES]
    worst_v, heat = (max(values) for values in zip(*found, strict=True))
    allowed = f"{1e3 * TOLERANCE_V:g} mV and {100.0 * HEAT_TOLERANCE:g} %"
    print(f"largest: {1e3 * worst_v:.3f} mV, heat {100.0 * heat:.3f} %; allowed: {allowed}")
    return int(worst_v > TOLERANCE_V or heat > HEAT_TOLERANCE)


if __name__ == "__main__":
    sys.exit(main())
