"""`scripts/drive_all.py`: cars that drive everywhere, and what it says of one that does not."""

import runpy
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "drive_all.py"


def drive_all(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", [str(SCRIPT), *arguments])
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(SCRIPT), run_name="__main__")
    return int(ended.value.code or 0)


@pytest.mark.parametrize("vehicle", ["compact_ev", "crossover_ev", "direct_ev"])
def test_cars_drive_the_hardest_cycles_in_every_climate_with_every_refrigerant(
    vehicle: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert drive_all(monkeypatch, vehicle, "--cycles", "us06", "artemis-motorway-150") == 0
    # Two controllers, two cycles, nine ambients, four refrigerants.
    assert capsys.readouterr().out.endswith("144 trips, 0 failures\n")


def test_a_trip_that_does_not_arrive_is_told_and_ends_with_1(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    car = tmp_path / "dead.toml"
    car.write_text('base = "compact_ev"\n[battery.discharge_limit]\nrate_scale = 0.0\n', encoding="utf-8")
    assert drive_all(monkeypatch, str(car), "--cycles", "nedc", "--refrigerants", "r134a") == 1
    told = capsys.readouterr().out
    assert (
        "hpcu-modern, scenario.cycle=nedc, scenario.climate.ambient_temperature_degc=-30.0: immobile" in told
    )
    assert told.endswith("18 trips, 18 failures\n")
