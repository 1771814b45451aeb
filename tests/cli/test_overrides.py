"""Commands that drive a car read `--overrides FILE`: it is another one then, and a mistake is one line."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from hp_gym.cli.app import app
from hp_gym.studies.tuning import ambient_bands, search, tuned_rules

DRAUGHTY = '"vehicle.cabin.panel_conductance_w_k" = 200.0\n'

GRID = """
description = "One short trip"
scenario = "ours/commute-minus5"
ambient_temperatures_degc = [5]
shown = []
cycles = [{name = "nedc"}]
variants = [{name = "dark", occupants = 1, state_of_charge_pct = 90.0}]
bands = [{name = "all", low_degc = -50.0, headline = true}]
fronts = [{family = "hpcu", cabin_offsets_k = [0], htc_offsets_k = [0]}]
"""

WORDS = {
    "run": ["run", "jeffs2019/case1-4"],
    "sweep": ["sweep", "jeffs2019/case1-4", "--axis", "htc_set_point_degc=50,60"],
    "optimise": ["optimise", "jeffs2019/case1-4", "--axis", "htc_set_point_degc=50:60", "--trials", "2"],
    "benchmark": ["benchmark", "hpcu", "--grid", "grid.toml"],
    "reproduce": ["reproduce"],
    "record": ["record", "hpcu", "--episodes", "2", "--seed", "3"],
    "tune": ["tune", "--trials", "10", "--trips", "1"],
}


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "grid.toml").write_text(GRID)
    (tmp_path / "draughty.toml").write_text(DRAUGHTY)
    monkeypatch.setattr(tuned_rules, "BANDS", ambient_bands.BANDS[2:3])
    monkeypatch.setattr(search, "modes", lambda: [search.PAPER])


def invoke(command: str, *more: str) -> Result:
    out = ["--out", "out.csv"] if command == "run" else ["--out", f"out/{command}{len(more)}"]
    return CliRunner().invoke(app, [*WORDS[command], *more, *out, "--json"])


def outcome(command: str, told: dict[str, Any]) -> float:
    """A total that grows with what the cabin loses, or a score that falls."""
    match command:
        case "run":
            return float(told["summary"]["energy_kwh"])
        case "optimise":
            return float(told["front"][0]["energy_kwh"])
        case "benchmark":
            return float(told["controllers"]["hpcu"]["energy_kwh"])
        case "reproduce":
            return float(told["scenarios"][0]["energy_kwh"])
        case "record":
            return -float(told["mean_return"])
        case _:
            return -float(told["hpcu_tuned"][0]["paper_score"])


@pytest.mark.parametrize("command", [name for name in WORDS if name != "sweep"])
def test_a_draughty_car_by_its_file_takes_more(command: str) -> None:
    if command == "record":
        pytest.importorskip("minari", reason="Minari is not installed (extra `data`)")
    as_it_is, draughty = (invoke(command, *more) for more in ((), ("--overrides", "draughty.toml")))
    assert as_it_is.exit_code == draughty.exit_code == 0, draughty.stderr
    assert outcome(command, json.loads(draughty.stdout)) > 1.001 * outcome(
        command, json.loads(as_it_is.stdout)
    )


def test_a_benchmark_tells_what_differed() -> None:
    told = json.loads(invoke("benchmark", "--overrides", "draughty.toml").stdout)
    assert told["overrides"] == ["vehicle.cabin.panel_conductance_w_k=200.0"]
    assert told["command"].endswith("--overrides draughty.toml")


@pytest.mark.parametrize(
    ("command", "text", "message"),
    [
        *((command, '"vehicle.body.mass_kgs" = 1.0', "mass_kgs") for command in WORDS),
        *((command, "mass = [", "wrong.toml") for command in WORDS),
        ("benchmark", '"scenario.cycle" = "nedc"', "would change the held-out trips"),
    ],
)
def test_a_mistake_in_the_file_is_told_in_one_line(command: str, text: str, message: str) -> None:
    if command == "record":
        pytest.importorskip("minari", reason="Minari is not installed (extra `data`)")
    Path("wrong.toml").write_text(text)
    result = invoke(command, "--overrides", "wrong.toml")
    assert result.exit_code == 2, result.output
    assert message in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not list(Path("out").rglob("*.*"))
