"""Modes: which there are, how they are driven and ranked."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from hp_gym import Experiment, _core
from hp_gym.cli.app import app
from hp_gym.studies.heat_modes import comparing
from hp_gym.studies.heat_modes.comparing import Compared, ModesError
from hp_gym.studies.heat_modes.enumeration import Mode, modes


@pytest.fixture(scope="module")
def compared() -> Compared:
    return comparing.compare(
        "jeffs2019-no-thermal-battery", cycle="artemis-urban", ambients_degc=(-5.0, 30.0)
    )


def test_modes_of_the_papers_car() -> None:
    found = modes(_core.vehicle_layout("jeffs2019"))
    # 3 treatments, 36 connections, PTC or not; 8 neither feed nor relieve the heat pump. PTC alone: 4.
    assert len(found) == 3 * 36 * 2 - 8 + 4
    assert len({mode.name for mode in found}) == len(found)
    lonely = Mode("isolate", tuple((name, "isolated") for name, _ in found[0].connections), True, True)
    assert lonely not in found
    assert all(mode.ptc for mode in found if not mode.heat_pump)


@pytest.mark.parametrize(
    ("vehicle", "names"),
    [
        ("jeffs2019-direct", ["heat pump", "heat pump + PTC", "PTC"]),
        ("jeffs2019-ptc-only", ["PTC", "PTC, battery heat"]),
    ],
)
def test_modes_follow_the_architecture(vehicle: str, names: list[str]) -> None:
    assert [mode.name for mode in modes(_core.vehicle_layout(vehicle))] == names


def test_a_mode_is_held_for_the_whole_trip(compared: Compared) -> None:
    name = "heat pump + PTC, motor-chiller"
    place = [mode.name for mode in compared.modes].index(name)
    options = {"motor": "chiller", "transmission": "isolated", "ambient": "isolated"}
    held = list(options)
    schedule = ", ".join(
        f'{{from_s = 0.0, member = "{member}", connection = "{option}"}}'
        for member, option in options.items()
    )
    overrides = [
        "scenario.cycle=artemis-urban",
        "scenario.climate.ambient_temperature_degc=-5.0",
        "scenario.climate.relative_humidity=0.8",
        "scenario.strategy.climate_control=auto",
        "scenario.strategy.battery=isolate",
        *(f"scenario.strategy.{key}=true" for key in (*held, "ptc", "heat_pump")),
        *(f"scenario.heat_demand.{member}_w=20000.0" for member in (*held, "battery", "cabin")),
        f"scenario.connection_schedule=[{schedule}]",
    ]
    experiment = Experiment(
        "jeffs2019/case1-1", "hpcu-modern", overrides, vehicle="jeffs2019-no-thermal-battery"
    )
    rows, totals, _ = experiment.simulate()
    assert totals["energy_kwh"] == compared.energy_kwh[place, 0]
    assert totals["discomfort_k"] == compared.discomfort_k[place, 0]
    column = list(experiment.signal_names).index
    assert rows[:, column("motor_chiller_heat_flow_w")].max() > 100.0
    # Valves that are closed leak a little.
    assert abs(rows[:, column("ambient_chiller_heat_flow_w")]).max() < 1.0


def test_ranking_is_by_energy_among_the_comfortable(compared: Compared) -> None:
    for place in range(2):
        order = compared.ranking(place)
        assert sorted(order) == list(range(len(compared.modes)))
        count = int(compared.comfortable[:, place].sum())
        assert compared.comfortable[order[:count], place].all()
        assert (np.diff(compared.energy_kwh[order[:count], place]) >= 0.0).all()
        assert (np.diff(compared.discomfort_k[order[count:], place]) >= 0.0).all()
    assert np.nanmin(compared.excess_pct, axis=0) == pytest.approx([0.0, 0.0])
    best = [compared.modes[compared.ranking(place)[0]] for place in range(2)]
    assert best[0].heat_pump
    # In summer heat must get out.
    assert dict(best[1].connections)["ambient"] == "htc"


def test_modes_on_the_command_line(tmp_path: Path) -> None:
    picture = tmp_path / "modes.png"
    arguments = ["modes", "jeffs2019-direct", "--cycle", "artemis-urban", "--ambient", "-10:30/3", "--json"]
    result = CliRunner().invoke(app, [*arguments, "--plot", str(picture)])
    assert result.exit_code == 0, result.stderr
    data = json.loads(result.stdout)
    assert data["ambients_degc"] == [-10.0, 10.0, 30.0]
    assert [mode["name"] for mode in data["modes"]] == ["heat pump", "heat pump + PTC", "PTC"]
    assert np.shape(data["energy_kwh"]) == (3, 3)
    assert picture.stat().st_size > 5_000
    shown = CliRunner().invoke(app, arguments[:-1])
    assert "3 modes x 3 ambient temperatures = 9 trips" in " ".join(shown.stdout.split())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--ambient", "0:10"], "must be LOW:HIGH/COUNT, LOW:HIGH:STEP or A,B,C"),
        (["--ambient", "warm"], "must be temperatures in degC"),
        (["--ambient", "90"], "ambient_temperature_degc"),
        (["--plot", "modes.txt"], "the name must end with one of"),
    ],
)
def test_what_cannot_be_compared_ends_in_one_line(arguments: list[str], message: str) -> None:
    result = CliRunner().invoke(app, ["modes", "jeffs2019-direct", *arguments])
    assert result.exit_code == 2
    assert message in result.stderr
    assert result.stderr.count("\n") == 1


def test_no_ambient_temperature_is_an_error() -> None:
    with pytest.raises(ModesError, match="at least one"):
        comparing.compare("jeffs2019-direct", ambients_degc=())
