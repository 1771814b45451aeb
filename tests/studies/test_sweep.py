"""Sweeps: the values of single runs, in one labelled table, whatever happens on the way."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner

import hp_gym
from hp_gym import locks
from hp_gym.cli.app import app
from hp_gym.messages import InUseError
from hp_gym.studies.axes import AxisError, Between, parse_axis
from hp_gym.studies.planned_runs import drive_on_same
from hp_gym.studies.sweep.sampling import SampleError
from hp_gym.studies.sweep.sweep_plan import SweepError
from hp_gym.studies.sweep.swept import Sweep

CASE = "jeffs2019/case1-4"
GRID = {
    "cell_capacity_ah": [40.0, 55.0],
    "ambient_temperature_degc": [-5.0, 5.0, 10.0],
    "htc_set_point_degc": [60.0, 80.0],
}


@pytest.fixture(scope="module")
def grid(tmp_path_factory: pytest.TempPathFactory) -> Sweep:
    return hp_gym.sweep(GRID, CASE, out=tmp_path_factory.mktemp("sweep") / "grid", chunk_runs=5)


def test_every_run_is_bit_for_bit_what_simulate_gives(grid: Sweep) -> None:
    data = grid.to_xarray()
    for capacity_ah, ambient_degc, htc_degc in ((40.0, -5.0, 60.0), (55.0, 10.0, 80.0)):
        overrides = {
            "vehicle.battery.cell_capacity_ah": capacity_ah,
            "scenario.climate.ambient_temperature_degc": ambient_degc,
            "controller.htc_set_point_degc": htc_degc,
        }
        run = hp_gym.simulate(CASE, overrides=overrides)
        point = data.sel(
            cell_capacity_ah=capacity_ah, ambient_temperature_degc=ambient_degc, htc_set_point_degc=htc_degc
        )
        assert set(grid.kpis) == set(run.summary)
        for kpi, value in run.summary.items():
            assert np.array_equal(float(point[kpi]), value, equal_nan=True), kpi
        assert str(point["end_reason"].item()) == run.end_reason


def test_the_table_is_labelled_and_keeps_units(grid: Sweep) -> None:
    data = grid.to_xarray(["energy_kwh"])
    assert dict(data.sizes) == {name: len(values) for name, values in GRID.items()}
    assert data["energy_kwh"].attrs["units"] == "kWh"
    assert data["ambient_temperature_degc"].attrs["units"] == "degC"
    schema = pq.read_schema(grid.path / "sweep.parquet")
    assert schema.field("discomfort_k").metadata[b"unit"] == b"K"
    assert schema.field("cell_capacity_ah").metadata[b"unit"] == b"Ah"
    frame = grid.to_pandas(["discomfort_k"])
    assert frame["run"].tolist() == list(range(12))
    assert frame.attrs["units"]["discomfort_k"] == "K"
    # Chunks have gone into the one table.
    assert sorted(path.name for path in grid.path.iterdir()) == ["sweep.json", "sweep.parquet"]


def test_threads_and_chunks_do_not_change_a_bit(grid: Sweep) -> None:
    other = hp_gym.sweep(GRID, CASE, threads=3, chunk_runs=12)
    for name, column in grid.to_pandas().items():
        values = other.to_pandas()[name].to_numpy()
        assert np.array_equal(column.to_numpy(), values, equal_nan=column.dtype.kind == "f"), name


def test_vehicles_cycles_and_climates_are_axes(tmp_path: Path) -> None:
    swept = hp_gym.sweep(
        {
            "vehicle": ["jeffs2019", "jeffs2019-no-thermal-battery"],
            "controller": ["hpcu", "thermostat"],
            "cycle": ["nedc"],
            "climate": [{"ambient_temperature_degc": 0.0, "solar_gain_w": 100.0}],
        },
        CASE,
        out=tmp_path / "cars",
    )
    data = swept.to_xarray()
    assert data["climate"].to_numpy().tolist() == ["ambient_temperature_degc=0.0, solar_gain_w=100.0"]
    kpi = "thermal_battery_ambient_energy_kwh"
    assert np.isfinite(data[kpi].sel(vehicle="jeffs2019")).all()
    assert np.isnan(data[kpi].sel(vehicle="jeffs2019-no-thermal-battery")).all()
    changes = {
        "scenario.cycle": "nedc",
        "scenario.climate.ambient_temperature_degc": 0.0,
        "scenario.climate.solar_gain_w": 100.0,
    }
    run = hp_gym.simulate(CASE, "thermostat", changes, vehicle="jeffs2019-no-thermal-battery")
    found = data["energy_kwh"].sel(vehicle="jeffs2019-no-thermal-battery", controller="thermostat")
    assert float(found.squeeze()) == run.summary["energy_kwh"]


def test_keys_can_share_a_value() -> None:
    swept = hp_gym.sweep({"ambient_temperature_degc+soak_temperature_degc": [-7.0]}, CASE)
    overrides = {
        "scenario.climate.ambient_temperature_degc": -7.0,
        "scenario.initial.soak_temperature_degc": -7.0,
    }
    run = hp_gym.simulate(CASE, overrides=overrides)
    assert swept.to_pandas()["energy_kwh"].tolist() == [run.summary["energy_kwh"]]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a.b=1,2.5", ("a.b", [1, 2.5])),
        ("a=0:0.3:0.1", ("a", [0.0, 0.1, 0.2, 0.3])),
        ("a=5:3:-1", ("a", [5.0, 4.0, 3.0])),
        ("a=0:1/3", ("a", [0.0, 0.5, 1.0])),
        ("a=-20:20", ("a", Between(-20.0, 20.0))),
        ("vehicle=one,my/two.toml", ("vehicle", ["one", "my/two.toml"])),
        ("climate={x=1},{x=2}", ("climate", [{"x": 1}, {"x": 2}])),
        ("a=true", ("a", [True])),
    ],
)
def test_axes_of_the_command_line(text: str, expected: object) -> None:
    assert parse_axis(text) == expected


@pytest.mark.parametrize("text", ["a", "=1", "a=", "a=1:0:1", "a=0:1:0", "a=1:2/1", "a=2:1", "a=1:2:3:4"])
def test_axes_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(AxisError, match=r"axis|range"):
        parse_axis(text)


@pytest.mark.parametrize(
    ("axes", "arguments", "message"),
    [
        ({"cell_capacity": [40.0]}, {}, "did you mean `cell_capacity_ah`"),
        ({"vehicle.battery.cell_capacity": [40.0]}, {}, "did you mean `vehicle.battery.cell_capacity_ah`"),
        ({"cell_capacity_ah": [40.0, -1.0]}, {}, "axis `cell_capacity_ah` at -1.0"),
        ({"vehicle": ["jeffs2019", "jeff2019"]}, {}, "jeff2019"),
        ({"proportional": [1.0]}, {}, "could be"),
        ({"htc_set_point_degc": []}, {}, "between 1 and"),
        ({"htc_set_point_degc": [60.0, 60.0]}, {}, "twice"),
        ({"htc_set_point_degc": [60.0], "controller.htc_set_point_degc": [70.0]}, {}, "twice"),
        ({"htc_set_point_degc": Between(60.0, 80.0)}, {}, "needs a sample"),
        ({"htc_set_point_degc": Between(60.0, 1e6)}, {"sample": "sobol", "count": 4}, "at 1000000"),
        ({"htc_set_point_degc": [60.0]}, {"kpis": ["energy"]}, "did you mean"),
        ({"htc_set_point_degc": [60.0]}, {"on": "moon"}, "one of threads, ray"),
        ({"htc_set_point_degc": [60.0]}, {"chunk_runs": 0}, "at least 1"),
        ({}, {}, "no axis"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_written(
    axes: dict[str, Any], arguments: dict[str, Any], message: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=message) as error:
        hp_gym.sweep(axes, CASE, out=tmp_path / "sweep", **arguments)
    assert "\n" not in str(error.value)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_of_another_sweep_stays_as_it_is(grid: Sweep, tmp_path: Path) -> None:
    before = {path.name: path.read_bytes() for path in grid.path.iterdir()}
    with pytest.raises(SweepError, match="holds another sweep: its `axes`"):
        hp_gym.sweep(GRID | {"htc_set_point_degc": [60.0, 70.0]}, CASE, out=grid.path)
    with pytest.raises(SweepError, match="its `scenario`"):
        hp_gym.sweep(GRID, "jeffs2019/case1-3", out=grid.path)
    assert {path.name: path.read_bytes() for path in grid.path.iterdir()} == before
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(SweepError, match="holds no sweep"):
        hp_gym.sweep(GRID, CASE, out=tmp_path)
    with pytest.raises(SweepError, match="no sweep in this folder"):
        Sweep(tmp_path)
    with locks.lock(grid.path), pytest.raises(InUseError):
        hp_gym.sweep(GRID, CASE, out=grid.path)


def test_another_build_does_not_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hp_gym.sweep({"htc_set_point_degc": [60.0]}, CASE, out=tmp_path / "s")
    monkeypatch.setattr("hp_gym.studies.sweep.sweep_plan.build", lambda: "0.0.1+other")
    with pytest.raises(SweepError, match=r"its `build` is .* here it is \"0.0.1\+other\""):
        hp_gym.sweep({"htc_set_point_degc": [60.0]}, CASE, out=tmp_path / "s")
    # What a worker of a cluster says.
    assert drive_on_same([(CASE, None, None, [])], 1, "0.0.1+other")[1] is None


def test_a_changed_file_is_another_sweep(tmp_path: Path) -> None:
    controller = tmp_path / "rules.toml"
    controller.write_text('base = "hpcu"\nhtc_set_point_degc = 70.0\n')
    arguments: dict[str, Any] = {"controller": controller, "out": tmp_path / "s"}
    hp_gym.sweep({"cell_capacity_ah": [50.0]}, CASE, **arguments)
    controller.write_text('base = "hpcu"\nhtc_set_point_degc = 75.0\n')
    with pytest.raises(SweepError, match="its `files`"):
        hp_gym.sweep({"cell_capacity_ah": [50.0]}, CASE, **arguments)


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_a_killed_sweep_goes_on_to_the_same_values(tmp_path: Path) -> None:
    axes = {"htc_set_point_degc": [50.0, 60.0, 70.0, 80.0]}
    arguments: dict[str, Any] = {"substeps": 40, "chunk_runs": 1, "threads": 1}
    out = tmp_path / "killed"
    code = f"import hp_gym; hp_gym.sweep({axes!r}, {CASE!r}, out={str(out)!r}, **{arguments!r})"
    process = subprocess.Popen([sys.executable, "-c", code])
    deadline_s = time.monotonic() + 60.0
    while not list(out.glob("chunks/0*.parquet")):
        assert process.poll() is None
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    there = Sweep(out)
    assert not there.complete
    before = there.to_pandas()
    assert 1 <= len(before) < 4
    # What a power cut may leave of a chunk is driven again.
    (out / "chunks" / "000003.parquet").write_bytes(b"PAR1")
    driven: list[int] = []
    resumed = hp_gym.sweep(
        axes, CASE, out=out, watch=lambda table: driven.extend(table.column("run").to_pylist()), **arguments
    )
    assert sorted([*before["run"], *driven]) == [0, 1, 2, 3]
    straight = hp_gym.sweep(axes, CASE, **arguments).to_pandas()
    for name, column in resumed.to_pandas().items():
        equal_nan = column.dtype.kind == "f"
        assert np.array_equal(column.to_numpy(), straight[name].to_numpy(), equal_nan=equal_nan), name


def test_runs_that_the_plant_refuses_end_a_sweep_or_are_noted(tmp_path: Path) -> None:
    # Each value alone is right; all of them together are not.
    axes = {"closing_difference_k": [1.0, 0.3], "opening_difference_k": [0.2, 0.5]}
    with pytest.raises(SweepError, match=r"run 3 \(closing_difference_k 0.3, opening_difference_k 0.5\)"):
        hp_gym.sweep(axes, CASE, out=tmp_path / "s", chunk_runs=3)
    assert len(Sweep(tmp_path / "s").to_pandas()) == 3
    frame = hp_gym.sweep(axes, CASE, keep_refused=True).to_pandas()
    assert (frame["end_reason"] == "refused").tolist() == [False, False, False, True]
    assert np.isnan(frame["energy_kwh"].iloc[3])


def test_samples_lie_in_their_ranges_and_are_the_same_again() -> None:
    axes = {"htc_set_point_degc": Between(50.0, 80.0), "cycle": ["nedc", "udds"]}
    for sample in ("latin-hypercube", "sobol"):
        frames = [hp_gym.sweep(axes, CASE, sample=sample, count=8, seed=3).to_pandas() for _ in range(2)]
        assert frames[0].equals(frames[1])
        assert frames[0]["htc_set_point_degc"].between(50.0, 80.0).all()
        assert frames[0]["htc_set_point_degc"].nunique() == 8
        assert sorted(frames[0]["cycle"]) == ["nedc"] * 4 + ["udds"] * 4
    data = hp_gym.sweep(axes, CASE, sample="sobol", count=2).to_xarray(["energy_kwh"])
    assert data["energy_kwh"].dims == ("run",)
    assert data["htc_set_point_degc"].attrs["units"] == "degC"
    with pytest.raises(SampleError, match="power of 2"):
        hp_gym.sweep(axes, CASE, sample="sobol", count=10)
    with pytest.raises(SampleError, match="one of latin-hypercube"):
        hp_gym.sweep(axes, CASE, sample="dice", count=10)


def test_sensitivities_see_what_matters_and_what_does_not(grid: Sweep) -> None:
    # The scenario does not use the thermal battery.
    axes = {
        "vehicle.body.mass_kg": Between(1500.0, 2500.0),
        "vehicle.thermal_battery.heat_capacity_j_k": Between(30000.0, 50000.0),
    }
    saltelli = hp_gym.sweep(axes, CASE, sample="saltelli", count=32)
    table = saltelli.sensitivities("energy_kwh")
    assert len(saltelli.to_pandas()) == 32 * 4
    assert table.loc["mass_kg", "ST"] > 0.5
    assert table.loc["heat_capacity_j_k", "ST"] == pytest.approx(0.0, abs=1e-9)
    sampled = hp_gym.sweep(axes, CASE, sample="latin-hypercube", count=160)
    assert sampled.sensitivities("energy_kwh").loc["mass_kg", "S1"] > 0.5
    with pytest.raises(SweepError, match="is a grid"):
        grid.sensitivities("energy_kwh")
    with pytest.raises(SweepError, match="did you mean `energy_kwh`"):
        saltelli.sensitivities("energykwh")


def test_pictures(grid: Sweep, tmp_path: Path) -> None:
    heat = grid.plot(tmp_path / "heat.png", ["energy_kwh"])
    lines = grid.plot(None, ["energy_kwh"], "lines")
    # One panel a value of the third axis, and the scale of the colours.
    assert (len(heat.axes), len(lines.axes)) == (3, 2)
    hp_gym.sweep({"cycle": ["nedc", "udds"]}, CASE).plot(tmp_path / "names.svg", ["energy_kwh"])
    sampled = hp_gym.sweep({"htc_set_point_degc": Between(50.0, 70.0)}, CASE, sample="sobol", count=4)
    assert len(sampled.plot(None, ["energy_kwh"]).axes) == 1
    assert len(list(tmp_path.iterdir())) == 2
    with pytest.raises(SweepError, match="did you mean"):
        grid.plot(tmp_path / "x.png", ["energy"])
    with pytest.raises(ValueError, match=r"\.txt"):
        grid.plot(tmp_path / "x.txt")
    shown = grid._repr_html_()
    assert "12 of 12 runs" in shown
    assert "data:image/png;base64," in shown


def test_the_command_drives_draws_and_tells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["sweep", CASE, "--axis", "htc_set_point_degc=50:80:15", "--axis", "cell_capacity_ah=40,50"]
    result = CliRunner().invoke(app, [*words, "--plot", "s.png", "--out", "s"])
    assert result.exit_code == 0, result.output
    assert "6 runs" in result.stdout
    assert Path("s.png").stat().st_size > 0
    result = CliRunner().invoke(app, [*words, "--out", "s", "--json", "--kpi", "energy_kwh"])
    found = json.loads(result.stdout)
    assert found["ends"] == {"arrived": 6}
    assert found["kpis"]["energy_kwh"]["least"] <= found["kpis"]["energy_kwh"]["greatest"]
    refused = CliRunner().invoke(app, ["sweep", CASE, "--axis", "htc_set_pont_degc=50,60", "--out", "t"])
    assert refused.exit_code == 2
    assert refused.stderr.startswith("hp-gym: there is no key for the axis `htc_set_pont_degc`")
    assert len(refused.stderr.splitlines()) == 1
    assert not Path("t").exists()
