"""Replays: a trip that the model itself has driven comes back, and what cannot be replayed is refused."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from typer.testing import CliRunner, Result

import hp_gym
from hp_gym.cli.app import app
from hp_gym.studies.csv_columns import ColumnError
from hp_gym.studies.replay.measured_quantities import QUANTITIES
from hp_gym.studies.replay.measured_trace import TraceError
from hp_gym.studies.replay.replaying import Replay

EXAMPLES = Path(__file__).parents[2] / "examples"
CAR = "crossover_ev"
COLD = {"scenario.climate.ambient_temperature_degc": -4.0}
FIGURES = {
    "energy_kwh",
    "drive_energy_kwh",
    "heating_energy_kwh",
    "heater_last_300_s_w",
    "battery_rise_k",
    "cabin_above_18_degc_s",
}
NOISE = {
    "battery_power_w": 400.0,
    "heater_power_w": 60.0,
    "cabin_temperature_degc": 0.2,
    "battery_temperature_degc": 0.2,
}
"""Standard deviations of independent errors of each value: more than what CAN signals are rounded to."""

Columns = Mapping[str, NDArray[np.float64]]


def speeds(duration_s: int = 900) -> NDArray[np.float64]:
    """Town, then a country road, then a stop [km/h]."""
    seconds = np.arange(duration_s + 1.0)
    town = 25.0 + 20.0 * np.sin(seconds / 15.0)
    country = 60.0 + 10.0 * np.sin(seconds / 40.0)
    share = np.clip((seconds - 440.0) / 40.0, 0.0, 1.0)
    ramp = np.clip(seconds / 20.0, 0.0, 1.0) * np.clip((duration_s - seconds) / 20.0, 0.0, 1.0)
    return np.asarray(ramp * ((1.0 - share) * town + share * country))


def write(path: Path, columns: Columns) -> Path:
    pd.DataFrame(dict(columns)).to_csv(path, index=False)
    return path


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Replay:
    """The trip of which nothing was measured."""
    path = tmp_path_factory.mktemp("trip") / "trip.csv"
    values = speeds()
    write(path, {"time_s": np.arange(len(values)), "speed_km_h": values})
    return hp_gym.replay(CAR, path, overrides=COLD)


def measured(driven: Replay, noise: float = 0.0, seed: int = 0) -> dict[str, NDArray[np.float64]]:
    """What would have been measured on it, with errors of so many times their standard deviations."""
    random = np.random.default_rng(seed)
    values = speeds()
    columns = {"time_s": np.arange(len(values), dtype=float), "speed_km_h": values}
    for name, sigma in NOISE.items():
        columns[f"measured_{name}"] = driven.model[name] + noise * sigma * random.standard_normal(len(values))
    return columns


def started(driven: Replay, deviations: float) -> Replay:
    """The trip from temperatures that are so many standard deviations higher."""
    starts = {
        f"scenario.initial.{mass}_temperature_degc": -4.0 + deviations * NOISE[f"{mass}_temperature_degc"]
        for mass in ("cabin", "battery")
    }
    return hp_gym.replay(CAR, driven.trace, overrides={**COLD, **starts})


def command(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["replay", *map(str, arguments)])


def test_a_trip_without_measurements_is_driven_alone(driven: Replay) -> None:
    assert driven.measured == {}
    assert driven.errors == ()
    assert driven.warnings == ()
    assert set(driven.figures) == FIGURES
    assert all(pair.measured is None for pair in driven.figures.values())
    summary, model = driven.trajectory.summary, {name: pair.model for name, pair in driven.figures.items()}
    # The trapezoid rule takes half a second less at the end.
    lacking_kwh = driven.trajectory["battery_power_w"][-1] / 2.0 / 3.6e6
    assert model["energy_kwh"] == pytest.approx(summary["energy_kwh"] - lacking_kwh, rel=1e-9)
    heating_kwh = summary["ptc_energy_kwh"] + summary["compressor_energy_kwh"]
    assert model["heating_energy_kwh"] == pytest.approx(heating_kwh, rel=2e-3)
    run = driven.trajectory
    heater_w = run["ptc_power_w"] + run["compressor_power_w"]
    assert model["heater_last_300_s_w"] == pytest.approx(heater_w[-300:].mean())
    rise_k = run["battery_temperature_degc"][-1] - run["battery_temperature_degc"][0]
    assert model["battery_rise_k"] == pytest.approx(rise_k)
    assert model["cabin_above_18_degc_s"] == np.count_nonzero(run["cabin_temperature_degc"] > 18.0) > 0


def test_the_models_own_trip_returns_its_own_figures(driven: Replay, tmp_path: Path) -> None:
    again = hp_gym.replay(CAR, write(tmp_path / "trip.csv", measured(driven)), overrides=COLD)
    for name, pair in again.figures.items():
        assert pair.model == pytest.approx(driven.figures[name].model, rel=1e-6), name
        assert pair.measured == pytest.approx(pair.model, rel=1e-6), name
    assert [error.quantity for error in again.errors] == list(QUANTITIES)
    for error in again.errors:
        assert error.rmse <= 1e-6 * np.abs(again.model[error.quantity.name]).max()


def test_a_noisy_trip_returns_its_figures_within_what_the_noise_allows(
    driven: Replay, tmp_path: Path
) -> None:
    again = hp_gym.replay(CAR, write(tmp_path / "trip.csv", measured(driven, 1.0)), overrides=COLD)
    seconds = len(speeds()) - 1
    figures, true = again.figures, {name: pair.model for name, pair in driven.figures.items()}
    # A sum of n independent errors has sqrt(n) standard deviations, a mean 1 / sqrt(n); four are allowed.
    energy_kwh = {name: 4.0 * np.sqrt(seconds) * sigma / 3.6e6 for name, sigma in NOISE.items()}
    allowed = {
        "energy_kwh": energy_kwh["battery_power_w"],
        "heating_energy_kwh": energy_kwh["heater_power_w"],
        "drive_energy_kwh": np.hypot(energy_kwh["battery_power_w"], energy_kwh["heater_power_w"]),
        "heater_last_300_s_w": 4.0 * NOISE["heater_power_w"] / np.sqrt(300.0),
        "battery_rise_k": 4.0 * np.sqrt(2.0) * NOISE["battery_temperature_degc"],
        # While the cabin is within four deviations of 18 degC it may be taken for either.
        "cabin_above_18_degc_s": np.sum(
            np.abs(driven.model["cabin_temperature_degc"] - 18.0) < 4.0 * NOISE["cabin_temperature_degc"]
        ),
    }
    for name, most in allowed.items():
        assert figures[name].measured == pytest.approx(true[name], abs=float(most)), name
    # The model starts from two noisy temperatures: their effect is less than that of four deviations of both.
    limits = [started(driven, shift).figures for shift in (-4.0, 4.0)]
    for name in ("energy_kwh", "drive_energy_kwh", "heating_energy_kwh", "heater_last_300_s_w"):
        most = sum(abs(one[name].model - true[name]) for one in limits)
        assert figures[name].model == pytest.approx(true[name], abs=most), name
        assert most < 0.1 * true[name], name
    for error in again.errors:
        sigma = NOISE[error.quantity.name]
        # The variance of n squares has a relative deviation of sqrt(2 / n); starts differ by up to 4 sigma.
        assert error.rmse > sigma * (1.0 - 4.0 * np.sqrt(0.5 / seconds)), error.quantity.name


def test_masses_start_from_the_first_measured_values(driven: Replay, tmp_path: Path) -> None:
    columns = measured(driven)
    columns["measured_cabin_temperature_degc"] = columns["measured_cabin_temperature_degc"] + 16.0
    columns["measured_battery_temperature_degc"] = columns["measured_battery_temperature_degc"] + 11.0
    again = hp_gym.replay(CAR, write(tmp_path / "trip.csv", columns), overrides=COLD)
    run = again.trajectory
    for column in (
        "cabin_temperature_degc",
        "soft_furnishings_temperature_degc",
        "hard_furnishings_temperature_degc",
    ):
        assert run[column][0] == pytest.approx(12.0), column
    assert run["battery_temperature_degc"][0] == pytest.approx(7.0)
    assert run["motor_temperature_degc"][0] == pytest.approx(-4.0)
    assert any("start at 12 degC" in note for note in again.notes)
    # What the user says counts more.
    changes = {"battery_temperature_degc": 3.0, "soft_furnishings_temperature_degc": 5.0}
    starts = {f"scenario.initial.{name}": degc for name, degc in changes.items()}
    other = hp_gym.replay(CAR, tmp_path / "trip.csv", overrides={**COLD, **starts})
    for column, degc in {**changes, "cabin_temperature_degc": 12.0}.items():
        assert other.trajectory[column][0] == pytest.approx(degc), column


def test_ten_samples_a_second_say_what_one_says(driven: Replay, tmp_path: Path) -> None:
    slow = measured(driven)
    times_s = np.arange(9001) / 10.0
    # Every tenth of a second has the mean of its second, which the model's rows are.
    row = np.minimum(np.ceil(times_s - 1e-9).astype(int), 900)
    fast = {name: values[row] for name, values in slow.items() if name.startswith("measured_")}
    fast["speed_km_h"] = np.interp(times_s, slow["time_s"], slow["speed_km_h"])
    path = write(tmp_path / "fast.csv", {"time_s": times_s + 36000.05, **fast})
    again = hp_gym.replay(CAR, path, overrides=COLD)
    for name, pair in again.figures.items():
        assert pair.measured == pytest.approx(driven.figures[name].model, rel=2e-3, abs=1.0), name
        assert pair.model == pytest.approx(driven.figures[name].model, rel=5e-3, abs=1.0), name


def test_only_part_may_be_measured(driven: Replay, tmp_path: Path) -> None:
    columns = measured(driven)
    del columns["measured_heater_power_w"], columns["measured_cabin_temperature_degc"]
    result = command(
        CAR, write(tmp_path / "trip.csv", columns), "--set", "scenario.climate.occupants=2", "--json"
    )
    assert result.exit_code == 0, result.stderr
    figures = json.loads(result.stdout, parse_constant=pytest.fail)
    assert set(figures) == FIGURES
    missing = {name for name, pair in figures.items() if pair["measured"] is None}
    assert missing == {
        "drive_energy_kwh",
        "heating_energy_kwh",
        "heater_last_300_s_w",
        "cabin_above_18_degc_s",
    }
    assert all(pair["model"] is not None for pair in figures.values())


def test_a_replay_on_the_command_line(driven: Replay, tmp_path: Path) -> None:
    path = write(tmp_path / "trip.csv", measured(driven))
    change = tmp_path / "changes.toml"
    change.write_text("[scenario.climate]\nambient_temperature_degc = -4.0\n", encoding="utf-8")
    out, picture = tmp_path / "out", tmp_path / "trip.png"
    result = command(CAR, path, "--overrides", change, "--out", out, "--plot", picture)
    assert result.exit_code == 0, result.stderr
    shown = " ".join(result.stdout.split())
    for words in (
        "trip.csv by crossover_ev with hpcu-modern: arrived",
        "Energy from the battery",
        "+0.000 (+0.0 %) kWh",
        "Root mean square",
        "Cabin air and furnishings start at -4 degC",
        "Not in the trace, so the scenario's: ambient temperature",
    ):
        assert words in shown
    assert {file.name for file in out.iterdir()} == {"comparison.csv", "figures.json", "trajectory.csv"}
    table = pd.read_csv(out / "comparison.csv")
    assert table["model_battery_power_w"].to_numpy() == pytest.approx(driven.model["battery_power_w"])
    assert table["measured_battery_power_w"].to_numpy() == pytest.approx(driven.model["battery_power_w"])
    figures = json.loads((out / "figures.json").read_text(encoding="utf-8"))
    assert figures["energy_kwh"]["measured"] == pytest.approx(figures["energy_kwh"]["model"], rel=1e-6)
    assert picture.stat().st_size > 20_000


def test_a_notebook_shows_both(driven: Replay, tmp_path: Path) -> None:
    again = hp_gym.replay(CAR, write(tmp_path / "trip.csv", measured(driven)), overrides=COLD)
    page = again._repr_html_()
    energy = f"{again.figures['energy_kwh'].model:.3f}"
    assert f"{energy} | {energy}" in page
    assert "<img" in page


def test_a_scenario_gives_all_that_the_trace_does_not(driven: Replay) -> None:
    scenario = "ours/ptc-only-minus7"
    again = hp_gym.replay("jeffs2019", driven.trace, scenario=scenario)
    run = hp_gym.simulate(scenario, overrides={"scenario.cycle": driven.trace})
    assert again.trajectory.summary == pytest.approx(run.summary, nan_ok=True)
    assert again.trajectory.controller == "hpcu"


def test_a_controller_may_be_a_function(driven: Replay) -> None:
    def off(run: hp_gym.Run) -> NDArray[np.float32]:
        return hp_gym.encode(run.experiment, {})

    again = hp_gym.replay(CAR, driven.trace, controller=off, overrides=COLD)
    assert again.figures["heating_energy_kwh"].model == 0.0
    assert again.trajectory.controller == "off"


def test_a_trip_that_the_model_does_not_finish_is_compared_as_far_as_it_goes(
    driven: Replay, tmp_path: Path
) -> None:
    path = write(tmp_path / "trip.csv", measured(driven))
    empty = {**COLD, "scenario.initial.state_of_charge_pct": 2.0}
    again = hp_gym.replay(CAR, path, overrides=empty)
    seconds = len(again.trajectory)
    assert again.trajectory.end_reason == "battery_empty"
    assert 1 < seconds < len(speeds())
    assert all(len(values) == seconds for values in (*again.measured.values(), *again.model.values()))
    energy_kwh = np.trapezoid(driven.model["battery_power_w"][:seconds]) / 3.6e6
    assert again.figures["energy_kwh"].measured == pytest.approx(energy_kwh)
    assert f"ends at {seconds - 1} s of 900 s (battery empty)" in again.warnings[0]
    result = command(CAR, path, "--set", "scenario.initial.state_of_charge_pct=2", "--json")
    assert "battery empty" in result.stderr
    assert set(json.loads(result.stdout)) == FIGURES


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nobody", "trip.csv"], ["nobody", "compact_ev"]),
        ([CAR, "none.csv"], ["none.csv", "No such file"]),
        ([CAR, "trip.txt"], ["trip.txt", ".csv"]),
        ([CAR, "trip.csv", "--scenario", "no/such"], ["no/such", "available"]),
        ([CAR, "trip.csv", "--controller", "no-one"], ["no-one", "hpcu"]),
        ([CAR, "trip.csv", "--set", "scenario.climate.snow=3"], ["climate.snow"]),
        ([CAR, "trip.csv", "--plot", "trip.gif"], ["trip.gif", ".png"]),
        ([CAR, "trip.csv", "--overrides", "no.toml"], ["no.toml", "No such file"]),
        ([CAR, "trip.csv", "--out", "trip.csv"], ["trip.csv", "Not a directory"]),
        ([CAR, "gap.csv"], ["gap.csv", "line 6", "gap of 27 s"]),
        ([CAR, "back.csv"], ["back.csv", "line 4", "backwards"]),
        ([CAR, "kelvin.csv"], ["kelvin.csv", "measured_cabin_temperature_degc", "283.15", "100"]),
        ([CAR, "kilowatt.csv"], ["kilowatt.csv", "measured_battery_power_w", "is it in kW?"]),
        ([CAR, "unknown.csv"], ["unknown.csv", "measured_heating_power_w", "measured_heater_power_w"]),
        ([CAR, "nan.csv"], ["nan.csv", "line 3", "measured_heater_power_w", "number"]),
        ([CAR, "empty.csv"], ["empty.csv", "line 3", "measured_heater_power_w", "empty"]),
    ],
)
def test_what_cannot_be_replayed_ends_in_one_line(
    arguments: list[str], words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    files = {
        "trip": "time_s,speed_km_h\n0,0\n1,5\n2,5\n3,0\n",
        "gap": "time_s,speed_km_h\n0,0\n1,5\n2,5\n3,5\n30,0\n",
        "back": "time_s,speed_km_h\n0,0\n1,5\n0.5,5\n3,5\n",
        "kelvin": "time_s,speed_km_h,measured_cabin_temperature_degc\n0,0,283.15\n1,0,283.15\n",
        "kilowatt": "time_s,speed_km_h,measured_battery_power_w\n0,0,1.5\n1,0,2.5\n",
        "unknown": "time_s,speed_km_h,measured_heating_power_w\n0,0,1.5\n1,0,2.5\n",
        "nan": "time_s,speed_km_h,measured_heater_power_w\n0,0,1.5\n1,0,nan\n",
        "empty": "time_s,speed_km_h,measured_heater_power_w\n0,0,1.5\n1,0,\n",
    }
    for name, text in files.items():
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    result = command(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    for word in words:
        assert word in result.stderr
    assert {path.stem for path in tmp_path.iterdir()} == set(files)


def test_errors_are_of_their_kind(tmp_path: Path) -> None:
    path = tmp_path / "trip.csv"
    path.write_text("time_s,speed_km_h,measured_battery_power_w\n0,0,9\n1,0,9\n", encoding="utf-8")
    with pytest.raises(TraceError):
        hp_gym.replay(CAR, path)
    path.write_text("time_s,speed_km_h\n0\n", encoding="utf-8")
    with pytest.raises(ColumnError):
        hp_gym.replay(CAR, path)
    path.write_text("time_s,speed_km_h\n0,0\n", encoding="utf-8")
    with pytest.raises(hp_gym.ConfigurationError):
        hp_gym.replay(CAR, path)


def test_slope_weather_and_settings_of_a_trace_are_driven(driven: Replay, tmp_path: Path) -> None:
    values = speeds()
    seconds = np.arange(len(values), dtype=float)
    metres = np.concatenate(([0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) / 3.6)))
    columns = {
        "time_s": seconds,
        "speed_m_s": values / 3.6,
        "elevation_m": 100.0 + 0.01 * metres,
        "ambient_degc": np.interp(seconds, [0.0, 900.0], [-4.0, -1.0]),
        "relative_humidity_pct": np.full(len(values), 80.0),
        "cabin_set_point_degc": np.full(len(values), 17.0),
    }
    again = hp_gym.replay(CAR, write(tmp_path / "trip.csv", columns))
    run = again.trajectory
    assert run["ambient_temperature_degc"][[0, -1]] == pytest.approx([-4.0, -1.0], abs=0.01)
    assert run["battery_temperature_degc"][0] == pytest.approx(-4.0)
    assert run["cabin_temperature_degc"][-1] == pytest.approx(17.0, abs=0.5)
    assert driven.trajectory["cabin_temperature_degc"][-1] > 20.0
    # Potential energy of the climb, through motor and gear; braking gives less back.
    mass_kg = 1762.0
    climb_kwh = mass_kg * 9.81 * 0.01 * metres[-1] / 3.6e6
    more_kwh = (
        again.trajectory.summary["traction_energy_kwh"] - driven.trajectory.summary["traction_energy_kwh"]
    )
    assert climb_kwh < more_kwh < 1.3 * climb_kwh
    assert any("Not in the trace, so the scenario's: sun, wind, occupants" in note for note in again.notes)
    assert any("Not in the trace, so the controller's: blower, recirculation" in note for note in again.notes)


def test_a_scenario_without_a_base_takes_the_settings_of_a_trace(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        "description = 'own'\nvehicle = 'compact_ev'\ncycle = 'nedc'\ncontroller = 'hpcu-modern'\n"
        "climate = { ambient_temperature_degc = 4.0, solar_gain_w = 0.0, occupants = 1 }\n"
        "initial = { state_of_charge_pct = 50.0 }\n"
        "heat_demand = { cabin_w = 9000.0, battery_w = 0.0 }\n"
        "strategy = { battery = 'isolate', climate_control = 'heat', ptc = true }\n",
        encoding="utf-8",
    )
    values = speeds(300)
    columns = {"time_s": np.arange(301.0), "speed_km_h": values, "cabin_set_point_degc": np.full(301, 12.0)}
    path = write(tmp_path / "trip.csv", columns)
    again = hp_gym.replay("compact_ev", path, scenario=tmp_path / "own.toml")
    assert 11.0 < again.trajectory["cabin_temperature_degc"][-1] < 13.0


@pytest.mark.parametrize(
    "car", [*hp_gym.names("vehicle"), *sorted((EXAMPLES / "cars").glob("*.toml"))], ids=str
)
def test_every_car_replays_what_was_measured_on_another(
    car: str | Path, driven: Replay, tmp_path: Path
) -> None:
    columns = measured(driven)
    columns["measured_cabin_temperature_degc"] = columns["measured_cabin_temperature_degc"] + 10.0
    again = hp_gym.replay(car, write(tmp_path / "trip.csv", columns), overrides=COLD)
    cabins = [cabin["air"] for cabin in again.trajectory.layout["cabins"]]
    assert cabins
    assert all(again.trajectory[air][0] == pytest.approx(6.0) for air in cabins)
    assert all(pair.deviation is not None for pair in again.figures.values())
    assert len(again.errors) == len(QUANTITIES)
    # No two cars are alike, but all drive the same trip in the cold.
    energy = again.figures["energy_kwh"]
    assert energy.measured == pytest.approx(driven.figures["energy_kwh"].model)
    assert 0.4 < energy.model / energy.measured < 2.5
