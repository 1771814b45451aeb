"""Every value of every built-in vehicle says what it rests on, and comes from the file that is told."""

import tomllib
from pathlib import Path

import pytest

import hp_gym
from hp_gym import provenance, toml_files
from hp_gym.vehicle_values import VehicleSheet, VehicleValue, sheet

OWN_CARS = ("compact_ev", "crossover_ev", "direct_ev")
"""Cars that stand alone, with nothing fitted."""

PACKS_KWH = {"compact_ev": 30.0, "crossover_ev": 60.0, "direct_ev": 54.66}


def by_key(found: VehicleSheet) -> dict[str, VehicleValue]:
    return {value.key: value for value in found.values}


@pytest.mark.parametrize("vehicle", hp_gym.names("vehicle"))
def test_every_value_has_a_status_and_what_that_needs(vehicle: str) -> None:
    found = sheet(vehicle)
    assert len(found.values) > 100
    for value in found.values:
        said = value.provenance
        assert said is not None, f"{value.key} in {value.file} has no status"
        assert said.source, f"{value.key} in {value.file} has no source or reason"
        if said.status in ("assumed", "fitted") and not isinstance(value.value, str):
            assert said.low is not None, f"{value.key} in {value.file} has no range"
        assert said.holds(value.value), f"{value.key} = {value.value} in {value.file} is outside its range"


@pytest.mark.parametrize("vehicle", OWN_CARS)
def test_a_car_of_its_own_inherits_nothing_and_fits_nothing(vehicle: str) -> None:
    found = sheet(vehicle)
    assert found.files == (vehicle,)
    assert {value.file for value in found.values} == {vehicle}
    assert "fitted" not in {value.provenance.status for value in found.values if value.provenance}
    own = {".".join(map(str, path)) for path, _ in provenance.leaves(toml_files.load("vehicle", vehicle))}
    assert {value.key.partition("[")[0] for value in found.values} == own - {"description"}


def test_the_three_cars_have_three_architectures() -> None:
    assert len({sheet(vehicle).architecture for vehicle in OWN_CARS}) == len(OWN_CARS)


@pytest.mark.parametrize("vehicle", OWN_CARS)
def test_the_pack_has_the_energy_that_is_published(vehicle: str) -> None:
    assert sheet(vehicle).pack_energy_kwh == pytest.approx(PACKS_KWH[vehicle], rel=0.01)


def test_a_pack_has_the_energy_that_the_plant_takes_out_of_it() -> None:
    # Half an hour from 60 to about 40 %, where the voltage is 3.66 to 3.80 V, at the reference temperature.
    climate = ["ambient_temperature_degc=25.0", "relative_humidity=0.3"]
    run = hp_gym.simulate(
        "jeffs2019/case1-1",
        vehicle="compact_ev",
        overrides=[
            *(f"scenario.climate.{change}" for change in climate),
            "scenario.initial.state_of_charge_pct=60.0",
            "scenario.cycle=artemis-motorway-130",
        ],
    )
    used_share = (60.0 - run.summary["final_charge_soc_pct"]) / 100.0
    mean_kwh = run.summary["battery_chemical_energy_kwh"] / used_share
    assert used_share > 0.1
    assert mean_kwh == pytest.approx(sheet("compact_ev").pack_energy_kwh * 3.73 / 3.75, rel=0.03)


def test_what_is_fitted_in_jeffs2019_are_the_parameters_of_its_calibration_with_their_bounds() -> None:
    problem = toml_files.load("calibration", "jeffs2019")
    bounds = {
        key.removeprefix("vehicle."): (parameter["low"], parameter["high"])
        for parameter in problem["parameter"]
        for key in parameter.get("keys", [parameter.get("key")])
        if key.startswith("vehicle.")
    }
    found = {
        value.key: (value.provenance.low, value.provenance.high)
        for value in sheet("jeffs2019").values
        if value.provenance and value.provenance.status == "fitted"
    }
    assert found == bounds


def test_a_variant_tells_its_own_values_from_those_of_its_base() -> None:
    values = by_key(sheet("jeffs2019-40ah"))
    assert values["battery.cell_capacity_ah"].file == "jeffs2019-40ah"
    assert values["battery.cell_mass_kg"].file == "jeffs2019"


def test_what_only_a_base_has_use_for_is_left_out() -> None:
    direct = by_key(sheet("jeffs2019-direct"))
    assert not [key for key in direct if key.startswith(("htc.", "chiller.", "thermal_battery."))]
    assert "refrigeration.condenser_ua_w_k" not in direct
    assert "ambient_exchanger.air.core_area_m2" in direct
    plain = by_key(sheet("jeffs2019-no-thermal-battery"))
    assert "chiller.circuit.branch_shares.thermal_battery" not in plain
    assert "ambient_exchanger.air.core_area_m2" not in by_key(sheet("jeffs2019-low-temperature-radiator"))
    resistive = by_key(sheet("jeffs2019-ptc-only"))
    assert not [key for key in resistive if key.startswith(("refrigera", "chiller."))]


def car(folder: Path, name: str, text: str) -> str:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_limits_come_with_another_refrigerant_and_go_with_that_of_the_base(tmp_path: Path) -> None:
    middle = car(
        tmp_path, "middle.toml", 'base = "jeffs2019"\n[refrigeration]\nmaximum_pressure_bar = 28.0\n'
    )
    values = by_key(sheet(middle))
    assert values["refrigeration.maximum_pressure_bar"].value == 28.0
    assert values["refrigeration.maximum_pressure_bar"].provenance is None
    mine = car(tmp_path, "mine.toml", 'base = "middle.toml"\nrefrigerant = "r290" # assumed: tried\n')
    values = by_key(sheet(mine))
    text = hp_gym._core.config_text("refrigerant", "r290")
    header = tomllib.loads("\n".join(line[2:] for line in text.splitlines() if line.startswith("#:")))
    for key in ("maximum_pressure_bar", "minimum_suction_pressure_bar"):
        assert (values[f"refrigeration.{key}"].value, values[f"refrigeration.{key}"].file) == (
            header[key],
            "r290",
        )
    assert sheet(mine).files == (mine, middle, "jeffs2019")


def test_a_refrigerant_beside_the_car_tells_its_limits(tmp_path: Path) -> None:
    (tmp_path / "mine.csv").write_text(hp_gym._core.config_text("refrigerant", "r152a"), encoding="utf-8")
    values = by_key(sheet(car(tmp_path, "mine.toml", 'base = "compact_ev"\nrefrigerant = "mine.csv"\n')))
    limit = values["refrigeration.compressor.maximum_discharge_temperature_degc"]
    assert limit.file == str(tmp_path / "mine.csv")
    assert limit.provenance is not None


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("motor.ambient_conductance_per_speed_w_s_k_m", "W s/(K m)"),
        ("motor.quadratic_loss_per_w", "1/W"),
        ("body.rolling_resistance_rise_per_k", "1/K"),
        ("battery.charge_limit.pulse_rate_per_h", "1/h"),
        ("refrigeration.compressor.displacement_cm3", "cm3"),
        ("battery.circuit.polarisation_capacitance_f", "F"),
        ("body.mass_kg", "kg"),
        ("ptc.pid.integral", "-"),
    ],
)
def test_a_value_has_the_unit_that_its_name_ends_with(key: str, unit: str) -> None:
    assert by_key(sheet("compact_ev"))[key].unit == unit
