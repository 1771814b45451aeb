"""Published values beside the model: the file, how rows are judged, what is driven."""

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomlkit
from typer.testing import CliRunner

from hp_gym.cli.app import app
from hp_gym.studies.published_values import driven_cars, parked, published, rigs, validating, validation_plot
from hp_gym.studies.published_values.judging import judge
from hp_gym.studies.published_values.published import Published, RigExperiment, TripExperiment

FILE = Path(__file__).parents[2] / "configs" / "validation" / "published.toml"
ROWS = ("R4a", "R4b", "R7c", "C4a", "W5a", "V17c")
"""Of each kind of experiment one, and each way to compare."""


@pytest.fixture(scope="module")
def tables() -> dict[str, Any]:
    return tomllib.loads(FILE.read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def loaded() -> Published:
    return published.load(str(FILE))


@pytest.fixture(scope="module")
def few(tables: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A file with a few of the rows and what they need."""
    rows = [row for row in tables["row"] if row["id"] in ROWS]
    needed = {row[key] for row in rows for key in ("experiment", "against") if key in row}
    kept = [experiment for experiment in tables["experiment"] if experiment["name"] in needed]
    path = tmp_path_factory.mktemp("published") / "few.toml"
    path.write_text(tomlkit.dumps({**tables, "row": rows, "experiment": kept}), encoding="utf-8")
    return path


def changed(tables: dict[str, Any], row: dict[str, Any]) -> dict[str, Any]:
    """The file's tables with the first row changed."""
    return {**tables, "row": [{**tables["row"][0], **row}, *tables["row"][1:]]}


def test_every_value_of_the_lists_is_judged_or_told_why_not(loaded: Published) -> None:
    known = {name for row in loaded.row for name in (row.id.rstrip("abcdefgh"), *row.also)}
    known |= {reference.id for reference in loaded.reference}
    lists = {f"R{n}" for n in range(1, 9)} | {f"C{n}" for n in range(1, 7)} | {f"W{n}" for n in range(1, 6)}
    lists |= {f"V{n}" for n in (2, 3, 5, 9, 10, 12, 13, 14, 16, 17, 18, 19, 20)} | {"M1"}
    assert lists <= known
    assert all(row.source for row in loaded.row)


def test_few_rows_from_file_to_json(few: Path, tmp_path: Path) -> None:
    markdown, picture = tmp_path / "rows.md", tmp_path / "rows.png"
    arguments = ["validate", "--published", str(few), "--markdown", str(markdown), "--plot", str(picture)]
    result = CliRunner().invoke(app, [*arguments, "--json"])
    assert result.exit_code == 0, result.stderr
    rows = {row["id"]: row for row in json.loads(result.stdout)["rows"]}
    assert list(rows) == ["R4a", "R4b", "R7c", "C4a.1", "C4a.2", "C4a.3", "W5a", "V17c"]
    assert rows["V17c"] | {"model": 32.0, "passes": True} == rows["V17c"]
    for row in rows.values():
        published_, tolerance = row["published"], row["tolerance"]
        ends = [value for value in (published_["low"], published_["high"]) if value is not None]
        margin = [
            tolerance["absolute"] if tolerance["pct"] is None else abs(e) * tolerance["pct"] / 100
            for e in ends
        ]
        low = ends[0] - margin[0] if published_["low"] is not None else -np.inf
        high = ends[-1] + margin[-1] if published_["high"] is not None else np.inf
        assert row["passes"] == (low <= row["model"] <= high)
        assert row["passes"] or row["explanation"], f"{row['id']} misses and nothing says why"
    assert "| W5a | compact_ev |" in markdown.read_text(encoding="utf-8")
    assert picture.stat().st_size > 10_000


def test_a_rig_has_the_published_capacity_at_the_published_speed(loaded: Published, tmp_path: Path) -> None:
    experiment = next(e for e in loaded.experiment if e.name == "r290-35-1800")
    assert isinstance(experiment, RigExperiment)
    figures = rigs.run(loaded, experiment, {}, tmp_path)
    assert figures["capacity_w"] == pytest.approx(1789.0, rel=1e-3)
    assert figures["speed_rev_s"] == pytest.approx(30.0, rel=1e-3)
    assert figures["cop"] == pytest.approx(figures["capacity_w"] / figures["power_w"])
    # What a bench cannot reach has no value, and so fails.
    beyond = experiment.model_copy(update={"capacity_w": None, "speed_rev_s": 300.0})
    assert np.isnan(rigs.run(loaded, beyond, {}, tmp_path)["cop"])


def test_a_dynamometer_has_one_road_load_in_all_weathers(loaded: Published, tmp_path: Path) -> None:
    base = next(e for e in loaded.experiment if e.name == "argonne-udds-72")
    assert isinstance(base, TripExperiment)
    several = [
        base.model_copy(update={"name": name, "ambient_degc": ambient_degc, "dynamometer": fixed})
        for name, ambient_degc, fixed in (("mild", 24.0, True), ("cold", -7.0, True), ("road", -7.0, False))
    ]
    planned = [
        trip for experiment in several for trip in driven_cars.plan(loaded, experiment, loaded.cars, tmp_path)
    ]
    found = {name: figures["compact_ev"] for name, figures in driven_cars.run(planned, 2).items()}
    for energy in ("drag_energy_kwh", "rolling_resistance_energy_kwh"):
        assert found["cold"][energy] == pytest.approx(found["mild"][energy], rel=2e-3)
        assert found["road"][energy] > 1.1 * found["mild"][energy]


def test_supply_air_is_what_the_heater_makes_of_cabin_and_fresh_air() -> None:
    layout = {
        "cabins": [{"air": "t", "blower_power": "blower", "member": "cabin"}],
        "heaters": [{"heats": "cabin", "power": "ptc"}],
        "branches": [],
        "exchangers": [],
    }
    columns = {"t": 10.0, "blower": 50.0, "ptc": 5000.0, "supply_air_flow_kg_s": 0.1}
    columns["cabin_exhaust_heat_flow_w"] = 0.03 * 1006.0 * 20.0
    signals = {name: np.array([value]) for name, value in columns.items()}
    # 30 % at -10 and 70 % at 10 degC are 4 degC; 5050 W in 100.6 W/K.
    assert parked.supply_temperature_degc(signals, layout, -10.0)[0] == pytest.approx(4.0 + 5050.0 / 100.6)


def test_rows_are_judged_at_their_bounds(loaded: Published) -> None:
    row = next(row for row in loaded.row if row.id == "W3b")
    file = loaded.model_copy(update={"row": (row,)})
    results = {
        row.experiment: {
            car: {row.take: value} for car, value in (("a", 138.1), ("b", 137.9), ("c", np.nan))
        },
        str(row.against): {car: {row.take: 100.0} for car in "abc"},
    }
    judged = judge(file, results)
    assert [(one.id, one.vehicle, one.passes) for one in judged] == [
        ("W3b.1", "a", True),
        ("W3b.2", "b", False),
        ("W3b.3", "c", False),
    ]
    assert judged[2].model is None
    mean = judge(loaded.model_copy(update={"row": (row.model_copy(update={"over": "mean"}),)}), results)
    assert (len(mean), mean[0].vehicle, mean[0].passes) == (1, "a, b, c", False)
    assert -1.0 <= validation_plot.scaled(judged[0]) <= 1.0 < abs(validation_plot.scaled(judged[1]))


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"experiment": "none"}, "row `R1a` names `none` as `experiment`; there is no such experiment"),
        ({"tolerance": 1.0}, "row `R1a` must have either `tolerance` or `tolerance_pct`"),
        ({"as": "ratio"}, "row `R1a` must have both `against` and `as`, or neither"),
        ({"colour": "red"}, "`row.0.colour` is unknown"),
        ({"id": "R1b"}, "row `R1b` appears twice"),
    ],
)
def test_flaws_of_a_file_end_in_one_line(
    tables: dict[str, Any], tmp_path: Path, row: dict[str, Any], message: str
) -> None:
    path = tmp_path / "flawed.toml"
    path.write_text(tomlkit.dumps(changed(tables, row)), encoding="utf-8")
    result = CliRunner().invoke(app, ["validate", "--published", str(path)])
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_cars_are_exchanged_by_name(few: Path) -> None:
    _, judged = validating.validate(few, cars={"compact_ev": "jeffs2019"})
    own = next(row for row in judged if row.id == "W5a")
    assert own.model is not None
    assert own.model > 13.0  # 2.7 t instead of 1.6
    with pytest.raises(published.ValidationFileError, match="there is no car `compact`"):
        validating.validate(few, cars={"compact": "jeffs2019"})


def test_the_page_says_what_the_command_finds_and_why_rows_miss(
    tables: dict[str, Any], tmp_path: Path
) -> None:
    # Without trips until the battery is empty, which take most of the time.
    kept = [experiment for experiment in tables["experiment"] if not experiment.get("until_empty")]
    names = {experiment["name"] for experiment in kept}
    rows = [row for row in tables["row"] if row["experiment"] in names]
    path = tmp_path / "short.toml"
    path.write_text(tomlkit.dumps({**tables, "row": rows, "experiment": kept}), encoding="utf-8")
    _, judged = validating.validate(path)
    assert all(row.explanation for row in judged if not row.passes)
    page = (FILE.parents[2] / "docs" / "validation-rows.md").read_text(encoding="utf-8")
    lines = [line.strip("| ").split(" | ") for line in page.splitlines() if line.startswith("| ")]
    told = {cells[0].partition(" ")[0]: cells[8] for cells in lines if len(cells) == 10 and cells[0] != "row"}
    assert len(told) == 80
    found = {row.id: "yes" if row.passes else "**no**" for row in judged}
    assert {name: told[name] for name in found} == found
