"""`hp_gym.simulate`, controllers, commands and overrides."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hp_gym
from hp_gym import signals
from hp_gym.command import ACTUATORS
from hp_gym.overrides import assignments

SCENARIO = "jeffs2019/case1-1"
AMBIENT = "scenario.climate.ambient_temperature_degc"

UNITS = {
    "time_s": "s",
    "speed_m_s": "m/s",
    "ambient_temperature_degc": "degC",
    "cabin_temperature_degc": "degC",
    "battery_temperature_degc": "degC",
    "motor_temperature_degc": "degC",
    "transmission_temperature_degc": "degC",
    "htc_supply_temperature_degc": "degC",
    "htc_return_temperature_degc": "degC",
    "chiller_supply_temperature_degc": "degC",
    "chiller_return_temperature_degc": "degC",
    "soc": "-",
    "battery_power_w": "W",
    "battery_voltage_v": "V",
    "battery_current_a": "A",
    "traction_power_w": "W",
    "compressor_power_w": "W",
    "ptc_power_w": "W",
    "auxiliary_power_w": "W",
    "condensing_pressure_bar": "bar",
    "evaporating_pressure_bar": "bar",
    "condenser_heat_flow_w": "W",
    "evaporator_heat_flow_w": "W",
    "cop": "-",
    "energy_residual_w": "W",
    "cabin_htc_heat_flow_w": "W",
    "battery_chiller_heat_flow_w": "W",
    "battery_connection": "-",
    "ambient_connection": "-",
}


@cache
def reference() -> hp_gym.Trajectory:
    return hp_gym.simulate(SCENARIO)


def test_a_trajectory_has_the_promised_columns_with_their_units() -> None:
    table = reference().to_pandas()
    assert {name: reference().units.get(name) for name in UNITS} == UNITS
    assert list(table.columns) == list(reference().columns)
    assert len(set(table.columns)) == len(table.columns)
    assert not table.isna().any(axis=None)


def test_a_trajectory_has_a_row_a_second_and_agrees_with_its_totals() -> None:
    trajectory = reference()
    np.testing.assert_array_equal(trajectory["time_s"], np.arange(1801))
    assert trajectory["ambient_temperature_degc"] == pytest.approx(0.0)
    assert trajectory["cabin_temperature_degc"][0] == pytest.approx(0.0)
    assert trajectory["soc"][0] == pytest.approx(1.0)
    assert trajectory["speed_m_s"].max() == pytest.approx(131.3 / 3.6, rel=1e-3)
    energy_kwh = trajectory["battery_power_w"][1:].sum() / 3.6e6
    assert energy_kwh == pytest.approx(trajectory.summary["energy_kwh"], rel=1e-9)
    assert 100.0 * trajectory["soc"][-1] == pytest.approx(trajectory.summary["final_soc_pct"])
    electrical_w = trajectory["battery_voltage_v"] * trajectory["battery_current_a"]
    np.testing.assert_allclose(electrical_w, trajectory["battery_power_w"], atol=50.0)
    assert trajectory.end_reason == "arrived"
    assert trajectory.controller == "hpcu"


def test_a_run_can_be_repeated_bit_for_bit() -> None:
    again = hp_gym.simulate(SCENARIO)
    np.testing.assert_array_equal(again.values, reference().values)
    np.testing.assert_equal(again.summary, reference().summary)


def test_stepping_by_hand_gives_the_same_bits() -> None:
    run = hp_gym.Experiment(SCENARIO).start()
    rows = [run.look()]
    end_reason = None
    while end_reason is None:
        end_reason = run.step(run.rule_based_command())
        rows.append(run.look())
    np.testing.assert_array_equal(np.stack(rows), reference().values)
    np.testing.assert_equal(run.summary(), reference().summary)
    assert end_reason == reference().end_reason


def test_a_run_that_has_ended_takes_no_further_step() -> None:
    run = hp_gym.Experiment(SCENARIO).start()
    while run.step(run.rule_based_command()) is None:
        pass
    with pytest.raises(RuntimeError, match="has ended"):
        run.step(run.rule_based_command())


def test_a_callable_controls_the_vehicle() -> None:
    def heat_with_ptc_only(run: hp_gym.Run) -> np.ndarray:
        settings = {"cabin": "htc", "ptc": "allowed", "compressor_power": 0.0}
        return hp_gym.encode(run.experiment, settings)

    trajectory = hp_gym.simulate(SCENARIO, heat_with_ptc_only)
    assert trajectory.controller == "heat_with_ptc_only"
    assert trajectory["compressor_power_w"].max() == 0.0
    assert trajectory["ptc_power_w"].max() > 1000.0
    # The plant closes the connection once the coolant is warmer than the cabin.
    assert trajectory["cabin_connection"][-1] == 1.0


def test_a_callable_can_follow_the_rule_based_controller() -> None:
    same = hp_gym.simulate(SCENARIO, lambda run: run.rule_based_command())
    np.testing.assert_array_equal(same.values, reference().values)


def test_a_callable_can_change_part_of_the_rule_based_command() -> None:
    def without_ptc(run: hp_gym.Run) -> np.ndarray:
        return hp_gym.encode(run.experiment, {"ptc": "off"}, base=run.rule_based_command())

    trajectory = hp_gym.simulate(SCENARIO, without_ptc)
    assert trajectory["ptc_power_w"].max() == 0.0
    assert trajectory["compressor_power_w"].max() > 100.0


def test_observe_gives_every_signal_by_name() -> None:
    seen = hp_gym.observe(hp_gym.Experiment(SCENARIO).start())
    assert tuple(seen) == signals.NAMES
    assert seen["time_s"] == 0.0
    assert set(signals.DESCRIPTIONS) == set(seen)


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        ({"warp_drive": 1.0}, "warp_drive"),
        ({"cabin": "engine"}, "isolated, htc, chiller"),
        ({"htc_flow": 50.0}, "htc_flow"),
        ({"compressor_power": float("nan")}, "compressor_power"),
    ],
)
def test_a_wrong_setting_is_refused_by_name(values: dict[str, float | str], complaint: str) -> None:
    with pytest.raises(hp_gym.ConfigurationError, match=complaint):
        hp_gym.encode(hp_gym.Experiment(SCENARIO), values)


def test_a_wrong_command_is_refused() -> None:
    experiment = hp_gym.Experiment(SCENARIO)
    with pytest.raises(ValueError, match="shape"):
        hp_gym.encode(experiment, {}, base=np.zeros(3, dtype=np.float32))
    with pytest.raises(ValueError, match="3 values"):
        hp_gym.simulate(SCENARIO, lambda _: np.zeros(3, dtype=np.float32))
    with pytest.raises(ValueError, match="between -1 and 1"):
        hp_gym.simulate(SCENARIO, lambda _: np.full(len(ACTUATORS), 2.0, dtype=np.float32))


def test_an_override_changes_the_result() -> None:
    # Soaked as the other; by itself a scenario starts at its ambient.
    soak = "scenario.initial.soak_temperature_degc"
    colder = hp_gym.simulate(SCENARIO, overrides={AMBIENT: -10, soak: 0})
    assert colder["ambient_temperature_degc"][0] == pytest.approx(-10.0)
    assert colder.summary["cabin_panel_energy_kwh"] > reference().summary["cabin_panel_energy_kwh"]
    as_text = hp_gym.simulate(SCENARIO, overrides=[f"{AMBIENT}=-10", f"{soak}=0"])
    np.testing.assert_array_equal(as_text.values, colder.values)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("scenario.climate.ambient_temprature_degc", 1.0, [SCENARIO, "ambient_temprature_degc"]),
        (AMBIENT, -300.0, [SCENARIO, "climate.ambient_temperature_degc", "-300", "between"]),
        (AMBIENT, "warm", [SCENARIO, "climate.ambient_temperature_degc", "warm"]),
        ("controller.no_such_key", 1.0, ["hpcu", "no_such_key"]),
        ("vehicle.no_such_part.key", 1.0, ["jeffs2019", "no_such_part"]),
        ("weather.wind", 1.0, ["weather.wind", "scenario."]),
    ],
)
def test_a_wrong_override_is_refused_with_file_and_key(key: str, value: object, words: list[str]) -> None:
    with pytest.raises(hp_gym.ConfigurationError) as caught:
        hp_gym.simulate(SCENARIO, overrides={key: value})  # type: ignore[dict-item]
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_unknown_names_are_refused_with_those_that_exist() -> None:
    with pytest.raises(hp_gym.ConfigurationError, match="jeffs2019/case1-1"):
        hp_gym.simulate("jeffs2019/case9-9")
    with pytest.raises(hp_gym.ConfigurationError, match="hpcu"):
        hp_gym.simulate(SCENARIO, "no_such_controller")
    with pytest.raises(ValueError, match="substeps"):
        hp_gym.simulate(SCENARIO, substeps=0)


def test_scenario_and_controller_can_be_files(tmp_path: Path) -> None:
    scenario = tmp_path / "mine.toml"
    scenario.write_text(f'base = "{SCENARIO}"\n[climate]\nambient_temperature_degc = 5.0\n')
    controller = tmp_path / "controller.toml"
    controller.write_text('base = "hpcu"\nblower_level = 0.5\n')
    trajectory = hp_gym.simulate(scenario, controller)
    assert trajectory["ambient_temperature_degc"][0] == pytest.approx(5.0)
    assert trajectory.controller == str(controller)
    assert trajectory.summary["blower_energy_kwh"] < reference().summary["blower_energy_kwh"]


def test_overrides_become_toml() -> None:
    overrides = {"a": True, "b": 2, "c": np.float64(0.1), "d": 'say "hi"', "e": [1, 2.5], "f": {"g": [False]}}
    assert assignments(overrides) == [
        "a=true",
        "b=2",
        "c=0.1",
        'd="say \\"hi\\""',
        "e=[1, 2.5]",
        'f={"g" = [false]}',
    ]
    assert assignments(None) == []
    with pytest.raises(TypeError, match="NoneType"):
        assignments({"a": None})  # type: ignore[dict-item]
    with pytest.raises(TypeError, match="mapping"):
        assignments("a=1")


@settings(max_examples=12)
@given(
    scenario=st.sampled_from([SCENARIO, "jeffs2019/case2-4", "ours/thermal-battery", "ours/hot-soak-plus35"]),
    ambient_degc=st.floats(-30.0, 45.0),
    soak_offset_k=st.floats(-10.0, 10.0),
    charge_pct=st.floats(15.0, 100.0),
)
def test_ledger_and_limits_hold_in_any_weather(
    scenario: str, ambient_degc: float, soak_offset_k: float, charge_pct: float
) -> None:
    overrides = {
        AMBIENT: ambient_degc,
        "scenario.initial.soak_temperature_degc": min(ambient_degc + soak_offset_k, 50.0),
        "scenario.initial.state_of_charge_pct": charge_pct,
    }
    trajectory = hp_gym.simulate(scenario, overrides=overrides)
    relative = np.abs(trajectory["energy_residual_w"][1:]) / trajectory["energy_scale_w"][1:]
    assert relative.max() < 1e-9
    assert trajectory.summary["worst_relative_residual"] < 1e-9
    assert trajectory.summary["limit_breaches"] == 0.0
    assert np.isfinite(trajectory.values).all()
