"""Searches: within their bounds, with their constraints, shared and resumed."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import hp_gym
from hp_gym.cli.app import app
from hp_gym.studies.optimise import goals
from hp_gym.studies.optimise.found import Found
from hp_gym.studies.optimise.trial_store import OptimiseError
from hp_gym.studies.planned_runs import Totals

CASE = "jeffs2019/case1-4"
MASS = {"vehicle.body.mass_kg": (1500.0, 2500.0)}


@pytest.fixture(scope="module")
def front(tmp_path_factory: pytest.TempPathFactory) -> Found:
    return hp_gym.optimise(
        {"htc_set_point_degc": (45.0, 85.0), "controller.cabin_set_point_degc": (18.0, 23.0)},
        ["energy_kwh", "discomfort_k"],
        CASE,
        trials=40,
        out=tmp_path_factory.mktemp("optimise") / "front",
    )


def test_a_search_finds_the_end_of_a_range_that_is_best(tmp_path: Path) -> None:
    found = hp_gym.optimise(MASS, "energy_kwh", CASE, trials=24, out=tmp_path)
    assert found.best.params["mass_kg"] < 1600.0
    overrides = {"vehicle.body.mass_kg": found.best.params["mass_kg"]}
    run = hp_gym.simulate(CASE, overrides=overrides)
    assert found.best.value == run.summary["energy_kwh"]
    # The file of overrides gives the same run.
    (path,) = found.write()
    assert tomllib.loads(path.read_text(encoding="utf-8")) == overrides
    again = hp_gym.simulate(CASE, overrides=path)
    assert np.array_equal(again.values, run.values, equal_nan=True)
    heavier = hp_gym.optimise(
        MASS, "max:energy_kwh", CASE, constraints=["energy_kwh<=1000"], trials=24, out=tmp_path / "max"
    )
    assert heavier.best.params["mass_kg"] > 2200.0


def test_constraints_hold(tmp_path: Path) -> None:
    limit = hp_gym.simulate(CASE, overrides={"vehicle.body.mass_kg": 1900.0}).summary["energy_kwh"]
    found = hp_gym.optimise(
        MASS, "energy_kwh", CASE, constraints=[f"energy_kwh>={limit!r}"], trials=24, out=tmp_path / "a"
    )
    assert found.best.value >= limit
    assert 1 <= len(found.allowed) < 24
    with pytest.raises(OptimiseError, match="missed at least: energy_kwh by"):
        hp_gym.optimise(
            MASS, "energy_kwh", CASE, constraints=["energy_kwh<=0.1"], trials=8, out=tmp_path / "b"
        ).write()


def test_no_trial_beats_one_of_the_front(front: Found) -> None:
    points = np.array([trial.values for trial in front.front])
    every = np.array([trial.values for trial in front.allowed])
    assert len(points) >= 2
    assert (np.diff(points[:, 0]) > 0.0).all()
    assert (np.diff(points[:, 1]) < 0.0).all()
    for point in points:
        assert not ((every <= point).all(axis=1) & (every < point).any(axis=1)).any()
    frame = front.to_pandas(front=True)
    assert frame.attrs["units"]["discomfort_k"] == "K"
    assert frame["htc_set_point_degc"].between(45.0, 85.0).all()
    # A file of overrides for each.
    assert len(front.write()) == 1 + len(points)


def test_a_search_goes_on_and_another_one_is_refused(front: Found) -> None:
    axes = {"htc_set_point_degc": (45.0, 85.0), "controller.cabin_set_point_degc": (18.0, 23.0)}
    arguments: dict[str, Any] = {"goal": ["energy_kwh", "discomfort_k"], "scenario": CASE, "out": front.path}
    before = [trial.values for trial in front.trials]
    more = hp_gym.optimise(axes, trials=44, **arguments)
    assert [trial.values for trial in more.trials][:40] == before
    assert len(more.trials) == 44
    for change, key in (
        ({"scenario": "jeffs2019/case1-3"}, "scenarios"),
        ({"constraints": ["discomfort_k<=9"]}, "constraints"),
        ({"seed": 1}, "seed"),
    ):
        with pytest.raises(OptimiseError, match=f"holds another search: its `{key}`"):
            hp_gym.optimise(axes, trials=44, **(arguments | change))
    assert [trial.values for trial in Found(front.path).trials][:40] == before


def test_processes_share_a_search(tmp_path: Path) -> None:
    code = (
        "import hp_gym\n"
        f"found = hp_gym.optimise({MASS!r}, 'energy_kwh', {CASE!r}, trials=24, out={str(tmp_path)!r})"
    )
    processes = [subprocess.Popen([sys.executable, "-c", code]) for _ in range(2)]
    assert [process.wait(timeout=120) for process in processes] == [0, 0]
    found = Found(tmp_path)
    # Both may have been in a last batch at the same time.
    assert 24 <= len(found.trials) <= 32
    drawn = [trial.params["mass_kg"] for trial in found.trials]
    assert len(set(drawn)) == len(drawn)


def test_several_trips_are_one_mean_over_time(tmp_path: Path) -> None:
    scenarios = [CASE, "ours/commute-minus5"]
    found = hp_gym.optimise(MASS, "discomfort_k", scenarios, trials=1, out=tmp_path)
    runs = [
        hp_gym.simulate(name, overrides={"vehicle.body.mass_kg": found.best.params["mass_kg"]}).summary
        for name in scenarios
    ]
    expected = np.average([run["discomfort_k"] for run in runs], weights=[run["duration_s"] for run in runs])
    assert found.best.value == pytest.approx(expected, rel=1e-12)


def test_trips_that_do_not_arrive_are_not_allowed() -> None:
    totals = Totals(("energy_kwh",), np.array([[1.0], [2.0]]), ("arrived", "battery_empty"), (None, None))
    assert goals.stranded(totals, [0, 1]) == 1
    assert goals.limit("energy_kwh<=3").excess(2.0) <= 0.0
    assert goals.limit("energy_kwh >= 3").excess(2.0) == 1.0
    assert goals.limit("energy_kwh<=3").excess(float("nan")) == np.inf


@pytest.mark.parametrize(
    ("axes", "arguments", "message"),
    [
        ({"mass_kgs": (1.0, 2.0)}, {}, "did you mean `mass_kg`"),
        ({"vehicle.body.mass_kg": (2000.0, 1000.0)}, {}, "lower one first"),
        ({"vehicle.body.mass_kg": (-5.0, 1000.0)}, {}, "at -5.0"),
        (MASS, {"goal": "energy"}, "did you mean `energy_kwh`"),
        (MASS, {"goal": "least:energy_kwh"}, "form KPI, min:KPI or max:KPI"),
        (MASS, {"goal": []}, "no goal"),
        (MASS, {"goal": ["energy_kwh", "max:energy_kwh"]}, "twice"),
        (MASS, {"constraints": ["discomfort_k<5"]}, "KPI<=VALUE"),
        (MASS, {"constraints": ["discomfort<=5"]}, "did you mean `discomfort_k`"),
        (MASS, {"trials": 0}, "at least 1"),
        (MASS, {"scenario": []}, "no scenario"),
        (MASS, {"scenario": "nowhere"}, "nowhere"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_written(
    axes: dict[str, Any], arguments: dict[str, Any], message: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=message) as error:
        hp_gym.optimise(axes, **({"scenario": CASE, "out": tmp_path / "o"} | arguments))
    assert "\n" not in str(error.value)
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_no_search_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "optimise.db").write_bytes(b"no database")
    with pytest.raises(OptimiseError, match="is no search"):
        hp_gym.optimise(MASS, "energy_kwh", CASE, trials=1, out=tmp_path)
    assert (tmp_path / "optimise.db").read_bytes() == b"no database"
    with pytest.raises(OptimiseError, match="no search in this folder"):
        Found(tmp_path / "nothing")


def test_values_that_do_not_go_together_are_passed_over(tmp_path: Path) -> None:
    axes = {"closing_difference_k": (0.4, 1.0), "opening_difference_k": (0.1, 0.9)}
    found = hp_gym.optimise(axes, "energy_kwh", CASE, trials=24, out=tmp_path)
    assert 0 < len(found.refusals) < 24
    assert len(found.trials) + len(found.refusals) == 24
    assert all("opening_difference_k" in refusal for refusal in found.refusals)


def test_the_command_searches_draws_and_tells(front: Found, tmp_path: Path) -> None:
    words = [
        *("optimise", CASE, "--axis", "htc_set_point_degc=45:85"),
        *(
            "--axis",
            "controller.cabin_set_point_degc=18:23",
            "--goal",
            "energy_kwh",
            "--goal",
            "discomfort_k",
        ),
        *("--out", str(front.path), "--trials", "40"),
    ]
    picture = tmp_path / "front.png"
    result = CliRunner().invoke(app, [*words, "--plot", str(picture)])
    assert result.exit_code == 0, result.output
    assert "on the front" in result.stdout
    assert picture.stat().st_size > 0
    found = json.loads(CliRunner().invoke(app, [*words, "--json"]).stdout)
    assert len(found["front"]) == len(Found(front.path).front)
    assert "data:image/png;base64," in front._repr_html_()
    refused = CliRunner().invoke(app, [*words, "--constraint", "comfort<=1"])
    assert refused.exit_code == 2
    assert refused.stderr.startswith("hp-gym: there is no KPI `comfort`; did you mean")
    assert len(refused.stderr.splitlines()) == 1
