"""`hp-gym vehicle`: every value of a car, and what it rests on."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

import hp_gym
from hp_gym.cli.app import app
from hp_gym.vehicle_values import sheet


def vehicle_command(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["vehicle", *arguments])


@pytest.mark.parametrize("vehicle", hp_gym.names("vehicle"))
def test_json_has_every_value_with_unit_status_source_range_and_file(vehicle: str) -> None:
    result = vehicle_command(vehicle, "--json")
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout, parse_constant=pytest.fail)
    found = sheet(vehicle)
    assert set(told) == {"vehicle", "description", "architecture", "files", "pack_energy_kwh", "values"}
    assert told["pack_energy_kwh"] == found.pack_energy_kwh
    assert [row["key"] for row in told["values"]] == [value.key for value in found.values]
    for row in told["values"]:
        assert set(row) == {
            "key", "value", "unit", "status", "source", "range", "range_of_factors", "file"
        }  # fmt: skip
    mass = next(row for row in told["values"] if row["key"] == "body.mass_kg")
    assert mass["unit"] == "kg"
    assert mass["file"] in found.files


def test_the_table_tells_pack_statuses_and_sections(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hp_gym.cli.vehicle_command.console.width", 200)
    shown = vehicle_command("compact_ev").stdout
    assert "Pack: 30.0 kWh" in shown
    assert "published" in shown
    assert "refrigeration.compressor" in shown
    assert "9 x 7 values, 0.0006657..0.0206" in shown
    assert "not stated" not in shown


def test_values_without_a_status_are_told_as_such(tmp_path: Path) -> None:
    car = tmp_path / "mine.toml"
    car.write_text('base = "compact_ev"\n[body]\nmass_kg = 1500.0 # weighed\n', encoding="utf-8")
    rows = json.loads(vehicle_command(str(car), "--json").stdout)["values"]
    mine = [row for row in rows if row["file"] == str(car)]
    assert [(row["key"], row["value"], row["status"], row["range"]) for row in mine] == [
        ("body.mass_kg", 1500.0, None, None)
    ]
    assert "1 not stated" in vehicle_command(str(car)).stdout


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (None, "mine.toml: No such file"),
        ("mass", "mine.toml: "),
        ('base = "compact_ev"\n[body]\nmass_kg = -1.0\n', "body.mass_kg"),
        ('base = "compact_evs"\n', "compact_evs"),
    ],
)
def test_a_bad_file_is_one_line_that_names_it(text: str | None, told: str, tmp_path: Path) -> None:
    car = tmp_path / "mine.toml"
    if text is not None:
        car.write_text(text, encoding="utf-8")
    result = vehicle_command(str(car))
    assert result.exit_code == 2
    assert told in result.stderr
    assert result.stderr.count("\n") == 1


def test_a_bad_name_is_one_line_that_tells_what_there_is() -> None:
    result = vehicle_command("compact-ev")
    assert result.exit_code == 2
    assert "`compact-ev`" in result.stderr
    assert "compact_ev, crossover_ev, direct_ev" in result.stderr
    assert result.stderr.count("\n") == 1
