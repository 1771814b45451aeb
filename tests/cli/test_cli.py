"""The command line `hp-gym`."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from typer.testing import CliRunner, Result

import hp_gym
from hp_gym.cli.app import app
from hp_gym.cli.units import label, quantity

SCENARIO = "ours/commute-minus5"


def hp_gym_command(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def result_of(*arguments: object) -> Any:
    result = hp_gym_command(*arguments, "--json")
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout, parse_constant=pytest.fail)


def test_version() -> None:
    result = hp_gym_command("--version")
    assert result.exit_code == 0
    assert result.stdout == f"hp-gym {hp_gym.__version__}\n"


@pytest.mark.parametrize("command", ["benchmark", "run", "scenarios", "replay", "reproduce", "calibrate"])
def test_help_tells_of_every_command(command: str) -> None:
    assert command in hp_gym_command("--help").stdout
    assert hp_gym_command(command, "--help").exit_code == 0


def test_help_loads_nothing_slow() -> None:
    slow = ["matplotlib", "pandas", "pyarrow", "scipy", "torch"]
    check = f"import sys, hp_gym.cli.app; print([name for name in {slow} if name in sys.modules])"
    run = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_scenarios_are_listed() -> None:
    listed = {row["id"]: row for row in result_of("scenarios")["scenarios"]}
    assert set(listed) == set(hp_gym.names("scenario"))
    assert listed["jeffs2019/case1-1"]["ambient_temperature_degc"] == 0.0
    assert listed["jeffs2019/case1-1"]["distance_km"] == pytest.approx(23.266, abs=1e-3)
    assert "jeffs2019/case2-4" in hp_gym_command("scenarios").stdout


def test_run_shows_totals() -> None:
    result = hp_gym_command("run", SCENARIO)
    assert result.exit_code == 0
    assert all(word in result.stdout for word in (SCENARIO, "arrived", "kWh/100 km", "Final SOC"))


def test_run_prints_json() -> None:
    data = result_of("run", SCENARIO)
    trajectory = hp_gym.simulate(SCENARIO)
    assert data["summary"]["energy_kwh"] == trajectory.summary["energy_kwh"]
    assert set(data["summary"]) == set(trajectory.summary)
    assert (data["scenario"], data["controller"], data["end_reason"]) == (SCENARIO, "hpcu", "arrived")


def test_a_total_that_does_not_exist_is_null() -> None:
    data = result_of("run", "ours/ptc-only-minus7", "--set", "scenario.climate.ambient_temperature_degc=-40")
    assert data["summary"]["time_to_comfort_s"] is None


def test_run_takes_changes_and_writes_files(tmp_path: Path) -> None:
    table, picture = tmp_path / "run.parquet", tmp_path / "run.png"
    change = "scenario.climate.ambient_temperature_degc=-7.5"
    files = ["--out", table, "--plot", picture]
    data = result_of("run", SCENARIO, "--controller", "hpcu", "--set", change, *files)
    assert data["overrides"] == [change]
    assert pd.read_parquet(table)["ambient_temperature_degc"].iloc[0] == pytest.approx(-7.5)
    assert picture.stat().st_size > 10_000
    assert {path.name for path in tmp_path.iterdir()} == {"run.parquet", "run.png"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["no/such-scenario"], ["no/such-scenario", "available"]),
        ([SCENARIO, "--controller", "nobody"], ["nobody", "hpcu"]),
        ([SCENARIO, "--set", "scenario.climate.wind=3"], [SCENARIO, "climate.wind"]),
        ([SCENARIO, "--set", "nonsense"], ["nonsense", "key=value"]),
        ([SCENARIO, "--out", "run.xlsx"], ["run.xlsx", ".csv, .parquet"]),
        ([SCENARIO, "--out", "no/such/folder/run.csv"], ["no/such/folder/run.csv", "No such file"]),
        ([SCENARIO, "--plot", "run.gif"], ["run.gif", ".png"]),
    ],
)
def test_a_mistake_gets_one_line_and_exit_code_2(
    arguments: list[str], words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    result = hp_gym_command("run", *arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1
    assert all(word in result.stderr for word in words), result.stderr
    assert list(tmp_path.iterdir()) == []


def test_names_become_words_and_numbers_get_their_unit() -> None:
    assert label("final_soc_pct") == "Final SOC"
    assert label("ptc_energy_kwh") == "PTC energy"
    assert quantity("energy_kwh", 8.16081) == ("8.161", "kWh")
    assert quantity("energy_kwh_per_100_km", 35.079) == ("35.08", "kWh/100 km")
    assert quantity("time_to_comfort_s", float("nan")) == ("-", "s")
    assert quantity("limit_breaches", 0.0) == ("0", "")
