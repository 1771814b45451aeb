"""The shipped refrigerant tables against CoolProp, at random points between the nodes."""

import sys
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "configs" / "refrigerants"
sys.path.insert(0, str(FOLDER))

pytest.importorskip("CoolProp")

import make_table  # noqa: E402
from table_evaluator import RefrigerantTable  # noqa: E402

RELATIVE = 5e-4
# Absolute floors.
ENTHALPY_J_KG = 20.0
TEMPERATURE_K = 0.01
ENTROPY_J_KG_K = 0.05
"""20 J/kg over 400 K."""


@pytest.mark.parametrize("name", ["R134a", "R1234yf", "R290", "R152A"])
def test_table_agrees_with_coolprop_between_nodes(name: str) -> None:
    table = RefrigerantTable(FOLDER / f"{name.lower()}.csv")
    state = dict(
        zip(
            make_table.REFERENCE_COLUMNS.split(","),
            make_table.reference_states(name, 10_000, seed=7).T,
            strict=True,
        )
    )
    evaporating, condensing = state["evaporating_k"], state["condensing_k"]
    enthalpy, density, entropy = table.suction(evaporating, state["superheat_k"])
    liquid = table.liquid_enthalpy(condensing, state["subcooling_k"])
    isentropic = table.isobar_enthalpy(condensing, entropy)
    temperature = table.isobar_temperature_k(condensing, state["discharge_enthalpy"])

    def check(what: str, value: np.ndarray, exact: np.ndarray, floor: float) -> None:
        excess = np.abs(value - exact) - np.maximum(RELATIVE * np.abs(exact), floor)
        worst = np.argmax(excess)
        assert excess[worst] <= 0.0, f"{what}: {value[worst]} against {exact[worst]}"

    check("p_e", table.pressure_pa(evaporating), state["evaporating_pressure_pa"], 0.0)
    check("p_c", table.pressure_pa(condensing), state["condensing_pressure_pa"], 0.0)
    check("suction density", density, state["suction_density"], 0.0)
    # Only differences of enthalpy and entropy mean anything, so 0.05 % of the absolute values would not do.
    check(
        "suction enthalpy",
        enthalpy - state["suction_enthalpy"],
        np.zeros_like(enthalpy),
        ENTHALPY_J_KG,
    )
    check("suction entropy", entropy - state["suction_entropy"], np.zeros_like(entropy), ENTROPY_J_KG_K)
    check("liquid enthalpy", liquid - state["liquid_enthalpy"], np.zeros_like(liquid), ENTHALPY_J_KG)
    check(
        "compression work",
        isentropic - enthalpy,
        state["isentropic_enthalpy"] - state["suction_enthalpy"],
        ENTHALPY_J_KG,
    )
    check(
        "evaporation",
        enthalpy - liquid,
        state["suction_enthalpy"] - state["liquid_enthalpy"],
        ENTHALPY_J_KG,
    )
    check("discharge temperature", temperature, state["discharge_k"], TEMPERATURE_K)
