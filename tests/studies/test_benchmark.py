"""`hp-gym benchmark`: held-out trips, results on disk, and what happens when something goes wrong."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner, Result

import hp_gym
from hp_gym import toml_files, transactions
from hp_gym.agents.controllers import resolve
from hp_gym.cli.app import app
from hp_gym.studies.benchmark import grid, matched, results_folder, summary
from hp_gym.studies.benchmark.drive import drive, trajectories
from hp_gym.studies.benchmark.grid import GridError
from hp_gym.studies.benchmark.results import FRONT_COLUMNS, IDENTITY, KPIS, VERDICTS

GRID = """
description = "Two climates, one short cycle"
scenario = "ours/commute-minus5"
ambient_temperatures_degc = [-5, 5, 30]
shown = ["5-nedc-dark"]

[[cycles]]
name = "nedc"

[[variants]]
name = "dark"
occupants = 1
state_of_charge_pct = 90.0

[[variants]]
name = "garage"
ambient_high_degc = 0.0
soak_temperature_degc = 15.0
occupants = 3
state_of_charge_pct = 80.0

[[bands]]
name = "cold"
low_degc = -50.0
headline = true

[[bands]]
name = "mild"
low_degc = 0.0
headline = true

[[bands]]
name = "warm"
low_degc = 20.0
headline = false

[[fronts]]
family = "hpcu"
cabin_offsets_k = [-4, -2, 0, 1]
htc_offsets_k = [0, -30]
"""

CLASSES = """
class Same:
    environment = {"actions": "all", "continuous": True, "overrides": {"scenario.controller": "hpcu"}}

    def begin(self, env):
        self.env = env

    def predict(self, observations):
        return self.env.rule_based_actions()

class Thirsty(Same):
    environment = Same.environment | {
        "overrides": {"scenario.controller": "hpcu", "scenario.initial.state_of_charge_pct": 4.0}
    }

class Wrong:
    def predict(self, observations):
        return [[9] * 11] * len(observations)

class Raising:
    def predict(self, observations):
        raise ZeroDivisionError("oh dear")
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("benchmark")
    (folder / "small.toml").write_text(GRID, encoding="utf-8")
    (folder / "bench_classes.py").write_text(CLASSES, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def benchmark(place: Path) -> Callable[..., Result]:
    def invoke(*arguments: object, out: Path | None = None) -> Result:
        with pytest.MonkeyPatch.context() as patch:
            patch.chdir(place)
            words = ["benchmark", *arguments, "--grid", "small.toml", "--out", out or place / "out"]
            return CliRunner().invoke(app, [str(word) for word in words])

    return invoke


@pytest.fixture(scope="module")
def done(benchmark: Callable[..., Result], place: Path) -> dict[str, Any]:
    result = benchmark("off", "bench_classes:Same", "random", "--json")
    assert result.exit_code == 0, result.stderr
    printed: dict[str, Any] = json.loads(result.stdout, parse_constant=pytest.fail)
    assert printed == json.loads((place / "out" / results_folder.SUMMARY).read_text(encoding="utf-8"))
    return printed


@pytest.fixture(scope="module")
def runs(done: dict[str, Any], place: Path) -> pd.DataFrame:
    del done
    return pd.read_parquet(place / "out" / results_folder.RUNS)


def test_every_controller_drives_every_scenario(runs: pd.DataFrame) -> None:
    assert list(runs.columns) == [*IDENTITY, *KPIS, *VERDICTS]
    assert set(runs["controller"]) == {
        "hpcu",
        "hpcu-modern",
        "hpcu-tuned",
        "hpcu-tuned-strict",
        "off",
        "bench_classes:Same",
        "random",
    }
    assert all(len(group) == group["scenario"].nunique() == 4 for _, group in runs.groupby("controller"))
    assert set(runs["end_reason"]) == {"arrived"}
    assert dict(zip(runs["scenario"], runs["band"], strict=True))["30-nedc-dark"] == "warm"


@pytest.mark.parametrize("scenario", ["minus5-nedc-garage", "30-nedc-dark"])
def test_hpcu_drives_what_simulate_drives(runs: pd.DataFrame, place: Path, scenario: str) -> None:
    row = runs[(runs["controller"] == "hpcu") & (runs["scenario"] == scenario)].iloc[0]
    totals = hp_gym.simulate(place / "out" / "scenarios" / f"{scenario}.toml").summary
    names = ("energy_kwh", "compressor_energy_kwh", "ptc_energy_kwh", "final_soc_pct", "distance_km")
    assert {name: row[name] for name in names} == {name: totals[name] for name in names}
    # One is summed up in hours, the other in seconds.
    assert row["discomfort_k"] == pytest.approx(totals["discomfort_k"], rel=1e-12)


def test_a_trajectory_is_the_trip_of_the_table_second_by_second(place: Path, tmp_path: Path) -> None:
    """The shipped policy decides every ten seconds; what is drawn of it must still be integrable."""
    trips = grid.load(str(place / "small.toml"))
    scenarios = [one for one in trips.scenarios if one.name in ("5-nedc-dark", "minus5-nedc-garage")]
    paths = trips.write(tmp_path)
    policy, *_ = resolve("ppo")
    assert policy.environment["control_interval_s"] > 1
    tables = trajectories(policy, scenarios, paths)
    for row in drive(policy, scenarios, paths):
        table = tables[row["scenario"]]
        np.testing.assert_array_equal(table["time_s"], np.arange(row["duration_s"] + 1))
        drawn_kwh = table["battery_chemical_power_w"].sum() / 3.6e6
        assert drawn_kwh == pytest.approx(row["chemical_energy_kwh"], rel=1e-9)
        for column, kpi in (("compressor_power_w", "compressor"), ("ptc_power_w", "ptc")):
            assert table[column].sum() / 3.6e6 == pytest.approx(row[f"{kpi}_energy_kwh"], rel=1e-9, abs=1e-12)


def test_summary_is_the_sums_and_means_of_the_runs(done: dict[str, Any], runs: pd.DataFrame) -> None:
    headline = runs[runs["band"] != "warm"]
    for name, kpis in done["controllers"].items():
        own = headline[headline["controller"] == name]
        assert kpis["trips"] == len(own) == 3
        assert kpis["attributable_energy_kwh"] == pytest.approx(own["attributable_energy_kwh"].mean())
        per_100_km = 100.0 * own["attributable_energy_kwh"].sum() / own["distance_km"].sum()
        assert kpis["attributable_energy_kwh_per_100_km"] == pytest.approx(per_100_km)
        assert kpis["discomfort_k"] == pytest.approx(
            np.average(own["discomfort_k"], weights=own["duration_s"])
        )
        assert sum(band["trips"] for band in kpis["bands"].values()) == 4
        assert all(set(KPIS) <= set(band) for band in kpis["bands"].values())
    assert sum(band["scenarios"] for band in done["grid"]["bands"].values()) == done["grid"]["scenarios"] == 4
    breaches = runs.groupby("controller")["limit_breaches"].sum().to_dict()
    assert done["limit_breaches"] == breaches


def test_attributable_energy_is_cell_energy_less_the_same_reference_for_all(runs: pd.DataFrame) -> None:
    difference = runs["chemical_energy_kwh"] - runs["reference_energy_kwh"]
    assert runs["attributable_energy_kwh"].to_numpy() == pytest.approx(difference.to_numpy(), abs=1e-12)
    assert (runs.groupby("scenario")["reference_energy_kwh"].nunique() == 1).all()


def test_a_controller_that_is_the_hpcu_gains_nothing_at_its_set_points(done: dict[str, Any]) -> None:
    gain = done["gains"]["bench_classes:Same_vs_hpcu"]
    for credit in gain["by_credit"].values():
        assert credit["own_set_points_pct"] == 0.0
        # On the front, or above where a mixture of two settings beats it.
        assert credit["attributable_energy_pct"] >= -1e-9
    assert gain["discomfort_k"] == 0.0
    assert done["gains"]["bench_classes:Same_vs_hpcu_any_htc"]["attributable_energy_pct"] >= -1e-9
    assert "random_vs_hpcu" not in done["gains"]


def test_gain_can_be_read_off_the_written_tables(
    done: dict[str, Any], runs: pd.DataFrame, place: Path
) -> None:
    fronts = pd.read_parquet(place / "out" / results_folder.FRONTS)
    assert list(fronts.columns) == list(FRONT_COLUMNS)
    assert len(fronts) == 8
    own = runs[(runs["controller"] == "bench_classes:Same") & (runs["band"] != "warm")]
    discomfort_k = np.average(own["discomfort_k"], weights=own["duration_s"])
    columns = (fronts[name].to_numpy()[None, :] for name in ("discomfort_k", "attributable_energy_kwh"))
    needed_kwh = matched.front_energy_kwh(np.array([discomfort_k]), *columns)[0]
    change_pct = 100.0 * (own["attributable_energy_kwh"].mean() / needed_kwh - 1.0)
    found = done["gains"]["bench_classes:Same_vs_hpcu_any_htc"]["by_credit"]["0"]["attributable_energy_pct"]
    assert found == pytest.approx(change_pct, abs=1e-6)


def test_own_set_points_of_a_front_are_the_controller_itself(runs: pd.DataFrame, place: Path) -> None:
    front_runs = pd.read_parquet(place / "out" / results_folder.FRONT_RUNS)
    own = front_runs[(front_runs["cabin_offset_k"] == 0.0) & (front_runs["htc_offset_k"] == 0.0)]
    hpcu = runs[(runs["controller"] == "hpcu") & (runs["band"] != "warm")].set_index("scenario")
    assert own.set_index("scenario")["energy_kwh"].to_dict() == hpcu["energy_kwh"].to_dict()


def test_the_same_command_gives_the_same_bytes(
    done: dict[str, Any], benchmark: Callable[..., Result], place: Path, tmp_path: Path
) -> None:
    del done
    assert benchmark("off", "bench_classes:Same", "random", "--json", out=tmp_path / "again").exit_code == 0
    for name in (
        results_folder.RUNS,
        results_folder.FRONTS,
        results_folder.FRONT_RUNS,
        results_folder.SUMMARY,
    ):
        assert (tmp_path / "again" / name).read_bytes() == (place / "out" / name).read_bytes(), name


def test_the_reference_passes_every_trip_and_a_controller_that_is_the_hpcu_passes_where_it_does(
    done: dict[str, Any], runs: pd.DataFrame
) -> None:
    passes = runs.pivot(index="scenario", columns="controller", values="passes")
    assert passes["hpcu-modern"].all()
    assert not passes["off"].any()
    assert passes["bench_classes:Same"].to_list() == passes["hpcu"].to_list()
    for name, rates in done["comfort"]["controllers"].items():
        assert rates["passed_pct"] == 100.0 * passes[name].mean()
        for band, shares in rates["bands"].items():
            own = runs[(runs["controller"] == name) & (runs["band"] == band)]
            assert shares["passed_pct"] == 100.0 * own["passes"].mean()


def test_energy_where_both_pass_can_be_read_off_the_runs(done: dict[str, Any], runs: pd.DataFrame) -> None:
    """A class and rules get the same rows; the class here is the HPCU."""
    best = done["headline"]["best_rule"]
    wide = runs.pivot(index="scenario", columns="controller", values=["attributable_energy_kwh", "passes"])
    for name in ("bench_classes:Same", "hpcu-modern"):
        gain = done["paired_gains"].get(f"{name}_vs_{best}")
        if gain is None:
            assert name == best
            continue
        both = wide["passes"][name].astype(bool) & wide["passes"][best].astype(bool)
        energy_kwh = wide["attributable_energy_kwh"][both].sum()
        assert gain["pairs"] == both.sum()
        change_pct = 100.0 * (energy_kwh[name] / energy_kwh[best] - 1.0) if both.any() else None
        assert gain["by_credit"]["0"]["attributable_energy_pct"] == pytest.approx(change_pct)
    twins = done["paired_gains"]["bench_classes:Same_vs_hpcu"]
    assert twins["attributable_energy_pct"] in {0.0, None}
    assert set(done["headline"]) >= {"learned_vs_best_rule", "best_rule_vs_hpcu", "reasons"}
    for name in ("learned_vs_best_rule", "best_rule_vs_hpcu"):
        assert (done["headline"][name] is None) == (done["headline"]["reasons"][name] is not None)


def test_the_references_own_file_may_be_named_but_no_other_of_its_name(
    benchmark: Callable[..., Result], tmp_path: Path
) -> None:
    file = tmp_path / "hpcu-modern.toml"
    file.write_text(hp_gym._core.config_text("controller", "hpcu-modern"), encoding="utf-8")
    assert benchmark(file, out=tmp_path / "out").exit_code == 0
    runs = pd.read_parquet(tmp_path / "out" / results_folder.RUNS)
    assert (runs["controller"] == "hpcu-modern").sum() == 4
    file.write_text('base = "hpcu-modern"\nheating_recirculation = 0.0\n', encoding="utf-8")
    result = benchmark(file, out=tmp_path / "out")
    assert result.exit_code == 2
    assert all(word in result.stderr for word in (str(file), "comfort", "another name"))


def test_own_rules_get_the_rows_that_learned_controllers_get(
    benchmark: Callable[..., Result], tmp_path: Path
) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('base = "hpcu"\n', encoding="utf-8")
    assert benchmark(file, "ptc-only", out=tmp_path / "out").exit_code == 0
    told = json.loads((tmp_path / "out" / results_folder.SUMMARY).read_text(encoding="utf-8"))
    gains = told["gains"]
    assert {name.partition("_vs_")[0] for name in gains} == {"mine"}
    assert gains["mine_vs_hpcu"]["discomfort_k"] == 0.0
    assert told["headline"]["learned"] is None


def test_stranded_trips_are_counted_and_leave_no_gain(
    benchmark: Callable[..., Result], tmp_path: Path
) -> None:
    result = benchmark("bench_classes:Thirsty", out=tmp_path)
    assert result.exit_code == 0, result.stderr
    told = json.loads((tmp_path / results_folder.SUMMARY).read_text(encoding="utf-8"))
    runs = pd.read_parquet(tmp_path / results_folder.RUNS)
    stranded = int(runs.loc[runs["controller"] == "bench_classes:Thirsty", "stranded"].sum())
    assert stranded > 0
    rules = dict.fromkeys(("hpcu", "hpcu-modern", "hpcu-tuned", "hpcu-tuned-strict"), 0)
    assert told["stranded_trips"] == {**rules, "bench_classes:Thirsty": stranded}
    assert len(runs) == 20
    gain = told["gains"]["bench_classes:Thirsty_vs_hpcu"]
    assert gain["attributable_energy_pct"] is None
    assert "stranded" in result.stdout


def test_table_fits_80_columns(benchmark: Callable[..., Result], tmp_path: Path) -> None:
    result = benchmark("bench_classes:Same", out=tmp_path)
    assert result.exit_code == 0, result.stderr
    assert max(len(line) for line in result.stdout.splitlines() if "Written" not in line) <= 80
    assert "bench_classes:Same vs hpcu" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["hpcuu"], ["hpcuu", "available", "hpcu-tuned"]),
        (["bench_classes:Nobody"], ["Nobody"]),
        (["bench_classes:Wrong"], ["bench_classes:Wrong", "9"]),
        (["bench_classes:Raising"], ["bench_classes:Raising", "ZeroDivisionError", "oh dear"]),
        (["off", "--seeds", "one"], ["--seeds", "one", "whole numbers"]),
    ],
)
def test_a_mistake_gets_one_line_and_leaves_earlier_results(
    arguments: list[str], words: list[str], benchmark: Callable[..., Result], tmp_path: Path
) -> None:
    (tmp_path / results_folder.SUMMARY).write_text("earlier", encoding="utf-8")
    result = benchmark(*arguments, out=tmp_path)
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    assert all(word in result.stderr for word in words), result.stderr
    assert [path.name for path in tmp_path.iterdir()] == [results_folder.SUMMARY]
    assert (tmp_path / results_folder.SUMMARY).read_text(encoding="utf-8") == "earlier"


def test_a_folder_that_cannot_be_written_to_is_named_before_anything_is_driven(
    benchmark: Callable[..., Result], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    result = benchmark("off", out=tmp_path / "file" / "out")
    assert result.exit_code == 2
    assert str(tmp_path / "file") in result.stderr
    assert (tmp_path / "file").read_text(encoding="utf-8") == "in the way"


def test_a_full_disk_leaves_earlier_results(
    benchmark: Callable[..., Result], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_space(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device", "summary.json")

    (tmp_path / results_folder.RUNS).write_text("earlier", encoding="utf-8")
    monkeypatch.setattr(results_folder, "write_json", no_space)
    result = benchmark("off", out=tmp_path)
    assert result.exit_code == 2
    assert "No space left" in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == [results_folder.RUNS]


def test_new_contents_replace_folders_and_keep_what_has_no_successor(tmp_path: Path) -> None:
    (tmp_path / "scenarios").mkdir()
    (tmp_path / "scenarios" / "old.toml").touch()
    (tmp_path / "notes.txt").touch()
    with transactions.new_contents(tmp_path) as folder:
        (folder / "scenarios").mkdir()
        (folder / "scenarios" / "new.toml").touch()
    found = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*")}
    assert found == {"notes.txt", "scenarios", "scenarios/new.toml"}


def test_held_out_grid_shares_no_cycle_with_training_and_covers_every_band() -> None:
    held_out = grid.load()
    training = hp_gym._core.config_text("distribution of episodes", "train-v2")
    assert all(f'"{scenario.cycle.name}"' not in training for scenario in held_out.scenarios)
    ambients_degc = {scenario.ambient_temperature_degc for scenario in held_out.scenarios}
    assert ambients_degc == set(range(-20, 45, 5))
    assert {scenario.band.name for scenario in held_out.scenarios} == {band.name for band in held_out.bands}
    assert 150 <= len(held_out.scenarios) <= 250
    edges = {band.name: band.low_degc for band in held_out.bands}
    assert edges["-10..0"] == -10.0
    assert [band.name for band in held_out.bands if band.headline] == [
        "below -10",
        "-10..0",
        "0..10",
        "10..20",
    ]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('name = "nedc"', 'name = "nedcc"'), ["nedcc", "available"]),
        (("occupants = 3", "occupants = 0"), ["variants.1.occupants", "0"]),
        (("occupants = 3", "occupants = 3\nwind = 2.0"), ["wind", "unknown"]),
        (("low_degc = 0.0", "low_degc = 25.0"), ["cold to warm"]),
        (("low_degc = -50.0", "low_degc = -1.0"), ["no band", "-5"]),
        (('name = "garage"', 'name = "dark"'), ["minus5-nedc-dark", "2 times"]),
        (('shown = ["5-nedc-dark"]', 'shown = ["5-dark"]'), ["shown", "5-dark"]),
        (("ambient_temperatures_degc = [-5, 5, 30]", ""), ["ambient_temperatures_degc", "missing"]),
        (("[-5, 5, 30]", "[-5, 5, 30]\nrelative_humidity = [[0, 1.2]]"), ["relative_humidity.0.1", "1.2"]),
        (("[-5, 5, 30]", "[-5, 5, 30]\nrelative_humidity = [[9, 0.8], [5, 0.7]]"), ["humidity", "rise"]),
    ],
)
def test_a_mistake_in_a_grid_is_told_with_its_place(
    change: tuple[str, str], words: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "grid.toml"
    path.write_text(GRID.replace(*change), encoding="utf-8")
    with pytest.raises(GridError) as caught:
        grid.load(str(path))
    assert all(word in str(caught.value) for word in ["grid.toml", *words]), caught.value


def test_humidity_of_a_trip_follows_its_ambient_temperature_and_its_variant(tmp_path: Path) -> None:
    path = tmp_path / "grid.toml"
    humid = "ambient_temperatures_degc = [-5, 5, 30]\nrelative_humidity = [[-5, 0.9], [15, 0.7]]"
    text = GRID.replace("ambient_temperatures_degc = [-5, 5, 30]", humid)
    path.write_text(
        text.replace('name = "garage"', 'name = "garage"\nhumidity_offset = 0.15'), encoding="utf-8"
    )
    trips = {trip.name: trip.relative_humidity for trip in grid.load(str(path)).scenarios}
    expected = {-5.0: 0.9, 5.0: 0.8, 30.0: 0.7}
    for trip in grid.load(str(path)).scenarios:
        offset = 0.15 if trip.variant.name == "garage" else 0.0
        assert trips[trip.name] == pytest.approx(min(expected[trip.ambient_temperature_degc] + offset, 1.0))


def test_front_settings_move_ambient_bands_too(tmp_path: Path) -> None:
    from hp_gym.studies.benchmark import fronts

    family = tmp_path / "banded.toml"
    family.write_text(
        'base = "hpcu"\nhtc_set_point_degc = 60.0\n\n[[ambient_bands]]\nup_to_degc = -5.0\n'
        "controller.htc_set_point_degc = 80.0\ncontroller.battery.heat_up_to_degc = 5.0\n",
        encoding="utf-8",
    )
    front = grid.Front.model_construct(
        family=str(family), cabin_offsets_k=(-2.0,), htc_offsets_k=(-20.0, 20.0), ptc_offsets_k=(4.0,)
    )
    made = fronts.settings(front, tmp_path / "made")
    written = [
        toml_files.merged("controller", setting.controller.environment["overrides"]["scenario.controller"])
        for setting in made
    ]
    assert [values["cabin_set_point_degc"] for values in written] == [20.0, 20.0]
    assert [values["htc_set_point_degc"] for values in written] == [40.0, 80.0]
    assert [values["ptc_from_deviation_k"] for values in written] == [-96.0, -96.0]
    assert [values["ambient_bands"][0]["controller"]["htc_set_point_degc"] for values in written] == [
        60.0,
        90.0,
    ]
    assert all(
        values["ambient_bands"][0]["controller"]["battery"] == {"heat_up_to_degc": 5.0} for values in written
    )


def test_kpis_of_no_runs_are_no_figures(runs: pd.DataFrame) -> None:
    assert summary.kpis(runs.iloc[:0]) == {"trips": 0}
