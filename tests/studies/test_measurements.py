"""Calibration on measured traces: what it finds, how sure it is, and which files it refuses."""

import json
import tomllib
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
import tomlkit
from numpy.typing import NDArray
from typer.testing import CliRunner

import hp_gym
from hp_gym.cli.app import app
from hp_gym.studies.calibration.fit import Options
from hp_gym.studies.calibration.identifiability import _differences
from hp_gym.studies.calibration.problem import CalibrationError, load

CASE = "jeffs2019/case1-4"
DRAG, MASS, CELLS, HEAT = (
    "vehicle.body.drag_area_m2",
    "vehicle.body.mass_kg",
    "vehicle.battery.cell_mass_kg",
    "vehicle.battery.cell_specific_heat_j_kg_k",
)
TRUTH = {DRAG: 0.75, MASS: 2000.0}
RANGES = {
    DRAG: (0.5, 1.0, 0.6),
    MASS: (1500.0, 2500.0, 2300.0),
    CELLS: (0.7, 1.2, 0.9),
    HEAT: (800.0, 1200.0, 1000.0),
}
SIGMA_W = 300.0


def write(folder: Path, keys: tuple[str, ...] = (DRAG, MASS), **change: Any) -> Path:
    """Writes two drives that a rig has measured, and a calibration to the first one."""
    random = np.random.default_rng(1)
    run = hp_gym.simulate(CASE, overrides=TRUTH)
    for name in ("one", "two"):
        power_w = run["battery_power_w"][::5] + random.normal(0.0, SIGMA_W, len(run["time_s"][::5]))
        degc = run["battery_temperature_degc"][::5] + random.normal(0.0, 0.1, len(power_w))
        table = np.stack([run["time_s"][::5], power_w, degc], axis=1)
        np.savetxt(folder / f"{name}.csv", table, "%.6g", ",", header="time_s,power,degc", comments="")
    trace = [
        {"signal": "battery_power_w", "column": "power", "sigma": SIGMA_W, "independent_after_s": 5.0},
        {"signal": "battery_temperature_degc", "column": "degc", "sigma": 0.1, "independent_after_s": 5.0},
    ]
    total = [{"kpi": "energy_kwh", "value": run.summary["energy_kwh"], "sigma": 0.01}]
    first = {
        "name": "one",
        "role": "fit",
        "scenario": CASE,
        "file": "one.csv",
        "trace": trace,
        "total": total,
    }
    second = {"name": "two", "role": "held-back", "scenario": CASE, "file": "two.csv", "trace": trace}
    parameters = [
        dict(zip(("low", "high", "prior"), RANGES[key], strict=True)) | {"key": key, "source": "test"}
        for key in keys
    ]
    tables = {
        "calibration": {
            "description": "test",
            "vehicle": "jeffs2019",
            "controller": "hpcu",
            "prior_sigma_share": 1.0,
            "maximum_evaluations": 80,
        },
        "parameter": parameters,
        "measurement": [first | change, second],
    }
    path = folder / "calibration.toml"
    path.write_text(tomlkit.dumps(tables), encoding="utf-8")
    return path


def test_traces_and_totals_find_the_truth_within_the_stated_deviations(tmp_path: Path) -> None:
    result = hp_gym.calibrate(write(tmp_path), out=tmp_path / "out")
    found = result.fit.by_name()
    known = result.knowledge
    assert known is not None
    for key, deviation in zip(known.names, known.deviations, strict=True):
        assert found[key] == pytest.approx(TRUTH[key], rel=0.05)
        assert abs(found[key] - TRUTH[key]) < 5.0 * deviation
    assert known.open_groups == ()
    assert min(known.gain) > 0.9
    assert known.reduced_chi2 == pytest.approx(1.0, abs=0.2)
    # What is held back is not looked at unless it is asked for.
    assert {one.measurement for one in result.judged} == {"one"}
    overrides = tmp_path / "out" / "calibrated.toml"
    assert tomllib.loads(overrides.read_text(encoding="utf-8")) == found
    told = json.loads((tmp_path / "out" / "knowledge.json").read_text(encoding="utf-8"))
    assert np.linalg.eigvalsh(told["covariance_of_shares"]).min() > 0.0
    by_overrides = hp_gym.simulate(CASE, overrides=overrides).summary["energy_kwh"]
    by_vehicle = hp_gym.simulate(CASE, vehicle=tmp_path / "out" / "vehicle.toml").summary["energy_kwh"]
    assert by_overrides == by_vehicle
    arguments = ["run", CASE, "--overrides", str(overrides), "--json"]
    assert f'"energy_kwh": {by_overrides!r}' in CliRunner().invoke(app, arguments).stdout
    assert "drag_area_m2" in result._repr_html_()


def test_a_file_of_overrides_may_have_sections(tmp_path: Path) -> None:
    flat, nested = tmp_path / "flat.toml", tmp_path / "nested.toml"
    flat.write_text(f'"{MASS}" = 1700.0\n"controller.htc_set_point_degc" = 60.0\n')
    nested.write_text("[vehicle.body]\nmass_kg = 1700.0\n[controller]\nhtc_set_point_degc = 60.0\n")
    runs = [hp_gym.simulate(CASE, overrides=file) for file in (flat, str(nested))]
    expected = hp_gym.simulate(CASE, overrides={MASS: 1700.0, "controller.htc_set_point_degc": 60.0})
    for run in runs:
        assert np.array_equal(run.values, expected.values, equal_nan=True)


def test_what_only_a_product_shows_is_not_told_apart(tmp_path: Path) -> None:
    path = write(tmp_path, (DRAG, CELLS, HEAT))
    result = hp_gym.calibrate(path, held_back=True, options=Options(maximum_evaluations=30))
    known = result.knowledge
    assert known is not None
    assert [set(group) for group in known.open_groups] == [{CELLS, HEAT}]
    assert [one.role for one in result.judged if one.measurement == "two"] == ["held-back"] * 2


def test_the_command_tells_what_is_not_known(tmp_path: Path) -> None:
    path = write(tmp_path, (DRAG, CELLS, HEAT))
    arguments = ["calibrate", "--config", str(path), "--start", "prior", "--max-evaluations", "12"]
    result = CliRunner().invoke(app, [*arguments, "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    assert "Not told apart by the data" in result.stdout
    assert "measured ones" in result.stdout
    assert (tmp_path / "out" / "vehicle.toml").exists()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"role": "training"}, "role"),
        ({"role": "check"}, "nothing to fit"),
        ({"scenario": "nowhere"}, "nowhere"),
        ({"file": "three.csv"}, "three.csv"),
        ({"trace": []}, "`file` is needed for traces"),
        (
            {"trace": [{"signal": "battery_pover_w", "column": "power", "sigma": 1.0}]},
            "did you mean `battery_power_w`",
        ),
        ({"trace": [{"signal": "battery_power_w", "sigma": 1.0}]}, "no column `battery_power_w`"),
        ({"trace": [{"signal": "battery_power_w", "column": "power"}]}, "sigma"),
        ({"trace": [{"signal": "battery_power_w", "column": "power", "sigma": 0.0}]}, "sigma"),
        ({"total": [{"kpi": "energy", "value": 1.0, "sigma": 1.0}]}, "did you mean `energy_kwh`"),
        ({"total": [{"kpi": "energy_kwh", "value": "much", "sigma": 1.0}]}, "much"),
        ({"overrides": {"scenario.climate.ambient": 1.0}}, "ambient"),
        ({"weight": 2.0}, "weight"),
    ],
)
def test_a_measurement_that_does_not_fit_is_refused(
    change: dict[str, Any], message: str, tmp_path: Path
) -> None:
    path = write(tmp_path, **change)
    with pytest.raises((ValueError, OSError), match=message) as error:
        load(str(path))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("time_s,power,degc\n0,1,2\n0,1,2\n", "rise"),
        ("time_s,power,degc\n0,1,2\n5000,1,2\n", "the cycle is from 0 to"),
        ("time_s,power,degc\n0,1,2\n1,much,2\n", "much"),
        ("time_s,power,degc\n0,,2\n1,,2\n", "has 0 values"),
        ("time_s,power,degc\n0\n1,1\n", "column `power`"),
    ],
)
def test_a_trace_that_does_not_fit_is_refused(text: str, message: str, tmp_path: Path) -> None:
    path = write(tmp_path)
    (tmp_path / "one.csv").write_text(text)
    earlier = tmp_path / "out"
    earlier.mkdir()
    (earlier / "calibrated.toml").write_text("earlier")
    with pytest.raises(CalibrationError, match=message):
        hp_gym.calibrate(path, out=earlier)
    assert (earlier / "calibrated.toml").read_text() == "earlier"
    result = CliRunner().invoke(app, ["calibrate", "--config", str(path), "--out", str(earlier)])
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1


def test_a_residual_that_switches_says_nothing_of_a_parameter() -> None:
    def residuals(shares: NDArray[np.float64]) -> NDArray[np.float64]:
        heater_on = float(shares[0] > 0.5)
        return np.array([40.0 * shares[0], 100.0 * heater_on, -3.0 * shares[0] + 100.0 * heater_on])

    jacobian, roughness = _differences(cast("Any", residuals), np.array([0.5]), 3)
    assert jacobian[:, 0] == pytest.approx([40.0, 0.0, 0.0])
    assert roughness[0] == pytest.approx(0.0, abs=1e-9)
