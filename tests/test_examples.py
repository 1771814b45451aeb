"""Every numbered example runs as its own program and shows what it is there to show."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = ROOT / "examples"

SHOWN = {
    "01_a_car_of_your_own": [
        r"01_a_car_of_your_own: \d+\.\d kWh/100 km, arrived",
        r"environment of .*\.toml: Mu",
    ],
    "02_more_parts": [
        r"actuators: electronics battery_heater cabin_condenser electronics_request electronics_valve",
        *(
            rf"{column}: [1-9]\d* W on average"
            for column in (
                "electronics_chiller_heat_flow_w",
                "battery_heater_power_w",
                "cabin_condenser_heat_flow_w",
            )
        ),
    ],
    "03_another_refrigerant": [
        rf"{name}: COP \d\.\d\d, \d+\.\d bar at most, 0 breaches"
        for name in ("R134a.*", r"R1234ze\(E\).*", "R1234yf.*", "R290.*", "R152a.*")
    ],
    "04_controllers": [
        rf"{name}: \d\.\d\d kWh, \d+\.\d K off target"
        for name in ("hpcu", "thermostat", r"04_controller\.toml", "cautious")
    ],
    "05_files_by_path": [
        r"05_scenario\.toml: arrived, .* by 04_controller\.toml",
        *(
            rf"trip {seed}: (nedc|artemis-urban) at -\d+ degC, \d+\.\d K off target, -\d+ points"
            for seed in range(3)
        ),
    ],
    "06_rows_of_an_environment": [
        r"actions: compressor_power blower_level cabin",
        r"observations: cabin_temperature_degc time_left_s cop speed_in_2_s",
        r"parts of the reward: .*reward_energy -?\d",
    ],
    "07_five_cars": [
        rf"{name}: cabin at -?\d+\.\d degC, energy ledger within [1-9]e-1\d"
        for name in ("direct", "three-loops", "two-cabins", "without-heat-pump", "without-thermal-battery")
    ],
    "09_sweep": [
        r"12 runs, energy in kWh",
        *(rf"at {degc} degC the least energy with the HTC at (50|85) degC" for degc in ("-10", "0", "10")),
        *(rf"{name} explains \d+ % of the variance" for name in ("mass_kg", "ambient_temperature_degc")),
    ],
    "10_optimise": [
        r"64 trials, \d+ on the front",
        r"trial \d+: \d\.\d\d kWh, \d+\.\d K off target",
        r"driven again by its file: \d\.\d\d kWh",
    ],
    "11_calibrate": [
        # Within 5 % of the truth.
        *(
            rf"vehicle\.{key}: \S+ \+- \S+, [+-][0-4]\.\d % from the truth"
            for key in (
                r"htc\.circuit\.heat_capacity_j_k",
                r"cabin\.panel_conductance_w_k",
                r"cabin\.maximum_air_flow_kg_s",
                r"ptc\.maximum_power_w",
                r"body\.drag_area_m2",
            )
        ),
        r"not told by the data: .*thermal_battery",
        r"not told apart: .*cell_(mass_kg|specific_heat_j_kg_k), .*cell_(mass_kg|specific_heat_j_kg_k)$",
        r"check mild, cabin_temperature_degc: \d\.\d\d of its uncertainty",
    ],
    "12_first_run": [
        r"as in the paper: \d\.\d\d kWh, arrived",
        r"at -7 degC: \d+\.\d\d kWh",
        r"\d+ signals",
    ],
    "13_own_planner": [
        r"plan: (rules|without)",
        r"paid by the rules -\d+\.\d\d, by the plan -\d+\.\d\d",
    ],
    "15_own_trip": [
        r"13\.8 km in 900 s, arrived",
        r"fastest 110 km/h",
        *(rf"{name}: \d\.\d\d kWh, \d+\.\d K off target" for name in ("preheated", "cold")),
        *(rf"at {degc} degC \d\.\d\d kWh" for degc in ("-15", "-8", "0", "8")),
        r"environment: 15_own_trip\.csv",
    ],
    "16_train": [
        r"32768 decisions, best score on validation trips -\d+\.\d",
        *(rf"{name}: \d\.\d\d kWh, \d+\.\d K off target, -\d+\.\d points" for name in ("policy", "rules")),
    ],
    "17_benchmark": [
        r"\d+ trips, 80 of them",
        *(rf"{name}: \d\.\d\d kWh, \d+\.\d K off target" for name in ("EarlyOff", "hpcu", "hpcu-tuned")),
        r"EarlyOff_vs_hpcu: (-?\+?\d+\.\d % energy \([+-]\d|less|more)",
        r"report: \d{6,} bytes",
    ],
    "18_replay": [
        r"8\.0 km, arrived, \d\.\d\d kWh",
        r"from 3\.5 to -2\.0 degC, climbing \d\d m",
        r"propane: \d\d\.\d bar at most, the table allows 26",
        *(
            rf"{figure}: measured \d+\.\d\d, model \d+\.\d\d"
            for figure in ("energy_kwh", "drive_energy_kwh", "heating_energy_kwh", "heater_last_300_s_w")
        ),
        *(
            rf"{quantity}: [+-]\d+\.\d\d (W|°C) in the mean"
            for quantity in ("Battery power", "Heater power", "Cabin temperature", "Battery temperature")
        ),
    ],
}

LONG = ("10_optimise", "11_calibrate", "16_train")
"""Run with `--long-examples` only: ten to thirty seconds each."""

PAGES = (
    *("12_first_run", "01_a_car_of_your_own", "15_own_trip", "09_sweep", "10_optimise", "11_calibrate"),
    *("04_controllers", "16_train", "13_own_planner", "17_benchmark"),
)
"""Have a page, in the order in which one reads them."""

ROWS_SHOWN = [
    r"arrived converter_temperature_degc converter_connection converter_chiller_heat_flow_w",
    r"converter cooled to -[6-9]\.\d degC by the rules",
    r"pressure ratio up to [1-9]\.\d\d",
    r"ledger within [1-9]e-1\d",
    r"actions: .*converter",
    r"observed -?0\.\d+, reward_compressor -\d",
    r"compressor_energy_kwh 0\.\d*[1-9]",
]


def shown_by(name: str, *arguments: object) -> str:
    command = [sys.executable, "-W", "error", str(EXAMPLES / f"{name}.py"), *map(str, arguments)]
    run = subprocess.run(command, cwd=EXAMPLES, capture_output=True, encoding="utf-8", check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_each_example_has_what_it_shows() -> None:
    numbered = sorted(path.stem for path in EXAMPLES.glob("[0-9]*.py"))
    assert numbered == sorted([*SHOWN, "08_rows_in_rust"])
    table = (EXAMPLES / "README.md").read_text(encoding="utf-8")
    contributing = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for name in numbered:
        assert f"{name}.py" in table
        assert f"examples/{name}.py" in contributing


@pytest.mark.parametrize("name", PAGES)
def test_a_page_shows_what_its_example_prints(name: str) -> None:
    page = (EXAMPLES / "pages" / f"{name}.md").read_text(encoding="utf-8")
    assert f"python examples/{name}.py" in page
    for pattern in SHOWN[name]:
        assert re.search(f"^{pattern}", page, re.MULTILINE), pattern
    place = PAGES.index(name)
    # From the first to the last there is a way forward.
    assert place == len(PAGES) - 1 or f"({PAGES[place + 1]}.md)" in page
    assert f"(pages/{name}.md)" in (EXAMPLES / "README.md").read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)\)", page):
        assert (EXAMPLES / "pages" / target).exists(), target


@pytest.mark.parametrize("name", SHOWN)
def test_an_example_runs(name: str, pytestconfig: pytest.Config) -> None:
    if name in LONG and not pytestconfig.getoption("--long-examples"):
        pytest.skip("takes ten seconds or more: pytest tests/test_examples.py --long-examples")
    text = shown_by(name)
    for pattern in SHOWN[name]:
        assert re.search(f"^{pattern}", text, re.MULTILINE), (pattern, text)


def test_the_pictures_of_the_five_cars_are_written(tmp_path: Path) -> None:
    shown_by("07_five_cars", tmp_path)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".png"] * 5


def test_a_car_a_log_and_a_refrigerant_of_ones_own_work_from_any_folder_without_rust(tmp_path: Path) -> None:
    for path in EXAMPLES.glob("18_*"):
        shutil.copy(path, tmp_path)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    run = subprocess.run(
        [sys.executable, "-W", "error", str(tmp_path / "18_replay.py")],
        cwd=elsewhere,
        env={**os.environ, "PATH": str(elsewhere), "PYTHONUTF8": "1"},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert "the table allows 26" in run.stdout
    assert list(elsewhere.iterdir()) == []


@pytest.mark.rust
def test_rows_in_rust_are_all_that_their_additions_need(tmp_path: Path) -> None:
    if shutil.which("cargo") is None:
        pytest.skip("no cargo on PATH: the rows are compiled (https://rustup.rs)")
    text = shown_by("08_rows_in_rust", tmp_path)
    for pattern in ROWS_SHOWN:
        assert re.search(f"^{pattern}", text, re.MULTILINE), (pattern, text)
