"""The cars of `examples/cars`, as files outside the repository, through every door.

Command line, one environment, a vector of all five, pictures, the report's diagrams. At every step the ledger
closes and no exchanger runs backwards; over a trip no limit is breached. `rust_core/trip/tests/vehicles.rs`
checks pinch and temperature differences of the same cars.

`pytest tests/test_outside_cars.py --all-climates` drives them in steps of 5 K.
"""

import json
import shutil
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import hp_gym
from hp_gym import vehicle_layout
from hp_gym.cli.app import app
from hp_gym.studies.benchmark.report import energy_flows

CARS = Path(__file__).parents[1] / "examples" / "cars"
NAMES = ("direct", "three-loops", "two-cabins", "without-heat-pump", "without-thermal-battery")
SCENARIO = "ours/commute-minus5"
TOLERANCE = 1e-9
KINDS_OF_DRIVING = ("rules", "random")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "ambient_degc" in metafunc.fixturenames:
        step_k = 5 if metafunc.config.getoption("--all-climates") else 15
        metafunc.parametrize("ambient_degc", range(-20, 41, step_k))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The cars in a folder of their own, far from the repository."""
    return Path(shutil.copytree(CARS, tmp_path_factory.mktemp("outside") / "cars"))


def climate(ambient_degc: int) -> dict[str, float]:
    return {
        "scenario.climate.ambient_temperature_degc": float(ambient_degc),
        "scenario.initial.soak_temperature_degc": float(ambient_degc),
    }


def check_step(signals: dict[str, float], layout: Any) -> None:
    assert abs(signals["energy_residual_w"]) <= TOLERANCE * signals["energy_scale_w"]
    for exchanger in layout["exchangers"]:
        assert signals[exchanger["flow"]] >= 0.0, exchanger["name"]


def check_all_steps(table: pd.DataFrame, layout: Any) -> None:
    assert (table["energy_residual_w"].abs() <= TOLERANCE * table["energy_scale_w"]).all()
    for exchanger in layout["exchangers"]:
        assert (table[exchanger["flow"]] >= 0.0).all(), exchanger["name"]


def test_there_are_five_cars_and_each_is_of_another_architecture() -> None:
    assert tuple(sorted(path.stem for path in CARS.glob("*.toml"))) == NAMES
    layouts = {name: hp_gym._core.vehicle_layout(str(CARS / f"{name}.toml")) for name in NAMES}
    stores = {
        name for name, layout in layouts.items() if any(m["kind"] == "store" for m in layout["members"])
    }
    assert stores == {"three-loops", "two-cabins"}
    assert [name for name in NAMES if not layouts[name]["refrigerates"]] == ["without-heat-pump"]
    assert {name: len(layout["loops"]) for name, layout in layouts.items()} == {
        "direct": 0,
        "three-loops": 3,
        "two-cabins": 2,
        "without-heat-pump": 2,
        "without-thermal-battery": 2,
    }
    rear = [
        branch["loop"] for branch in layouts["two-cabins"]["branches"] if branch["member"] == "rear_cabin"
    ]
    assert rear == ["htc", "chiller"]


@pytest.mark.parametrize("name", NAMES)
def test_the_command_line_runs_a_car(name: str, ambient_degc: int, folder: Path, tmp_path: Path) -> None:
    car, out = folder / f"{name}.toml", tmp_path / "run.csv"
    changes = [word for key, value in climate(ambient_degc).items() for word in ("--set", f"{key}={value}")]
    arguments = ["run", SCENARIO, "--vehicle", str(car), *changes, "--out", str(out), "--json"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout)
    assert told["end_reason"] == "arrived"
    assert told["summary"]["limit_breaches"] == 0
    assert told["summary"]["worst_relative_residual"] <= TOLERANCE
    check_all_steps(pd.read_csv(out), hp_gym._core.vehicle_layout(str(car)))


@pytest.mark.parametrize("driving", KINDS_OF_DRIVING)
@pytest.mark.parametrize("name", NAMES)
def test_a_car_is_an_environment(name: str, driving: str, ambient_degc: int, folder: Path) -> None:
    env: Any = gym.make(
        "EVHeatPump-v0",
        vehicle=folder / f"{name}.toml",
        scenario=SCENARIO,
        actions="all" if driving == "random" else "hpcu",
        continuous=driving == "rules",
        overrides=climate(ambient_degc),
    ).unwrapped
    env.action_space.seed(ambient_degc + 100)
    env.reset(seed=0)
    layout, over = env.layout(), False
    while not over:
        action = env.action_space.sample() if driving == "random" else env.rule_based_action()
        observation, reward, over, _, _ = env.step(action)
        assert np.isfinite(observation).all()
        assert np.isfinite(reward)
        check_step(env.signals(), layout)
    assert env.summary()["limit_breaches"] == 0


@pytest.mark.parametrize("driving", KINDS_OF_DRIVING)
def test_all_five_drive_in_one_vector(driving: str, ambient_degc: int, folder: Path) -> None:
    envs: Any = gym.make_vec(
        "EVHeatPump-v0",
        num_envs=len(NAMES),
        vehicle=[folder / f"{name}.toml" for name in NAMES],
        scenario=SCENARIO,
        overrides=climate(ambient_degc),
        autoreset_mode="Disabled",
    )
    envs.action_space.seed(ambient_degc + 100)
    envs.reset(seed=0)
    layouts = [envs.layout(index) for index in range(len(NAMES))]
    over = np.zeros(len(NAMES), dtype=bool)
    while not over.any():
        actions = envs.action_space.sample() if driving == "random" else envs.rule_based_actions()
        observations, rewards, over, _, _ = envs.step(actions)
        assert np.isfinite(observations).all()
        assert np.isfinite(rewards).all()
        for index, layout in enumerate(layouts):
            check_step(envs.signals(index), layout)
    for index in range(len(NAMES)):
        assert envs.summary(index)["limit_breaches"] == 0


@pytest.mark.parametrize("name", NAMES)
def test_a_car_is_drawn(name: str, ambient_degc: int, folder: Path) -> None:
    env: Any = gym.make(
        "EVHeatPump-v0",
        vehicle=folder / f"{name}.toml",
        scenario=SCENARIO,
        render_mode="rgb_array",
        overrides=climate(ambient_degc),
    ).unwrapped
    env.action_space.seed(0)
    env.reset(seed=0)
    first = env.render()
    for second in range(120):
        env.step(env.action_space.sample() if second % 2 else env.rule_based_action())
    later = env.render()
    assert first.shape == later.shape == (540, 960, 3)
    assert first.dtype == np.uint8
    assert later.std() > 10.0
    assert (first != later).any()


@pytest.mark.parametrize("name", NAMES)
def test_the_energy_diagrams_of_a_car_balance(name: str, ambient_degc: int, folder: Path) -> None:
    run = hp_gym.simulate(SCENARIO, vehicle=folder / f"{name}.toml", overrides=climate(ambient_degc))
    layout = vehicle_layout.typed(run.layout)
    table = run.to_pandas().iloc[1:]
    for diagram in (energy_flows.electricity(layout), energy_flows.heat(layout)):
        links = energy_flows.links(table, diagram)
        assert links
        energy = {(source, target): kwh for source, target, kwh in links}
        assert all(source and target and source != target for source, target in energy)
        places = {place for ends in energy for place in ends}
        inner = {p for p in places if any(p == s for s, _ in energy) and any(p == t for _, t in energy)}
        for place in inner:
            # Each link that is too thin to be drawn may be missing.
            missing_kwh = energy_flows.SMALLEST_KWH * len(diagram.flows)
            assert abs(energy_flows.balance(energy, place)) <= missing_kwh, place
    cabins = {cabin["member"] for cabin in layout["cabins"]}
    drawn = {end for flow in energy_flows.heat(layout).flows for end in (flow.source, flow.target)}
    for member in layout["members"]:
        if member["name"] in cabins:
            label = vehicle_layout.capitalised(member["label"])
            assert any(label in place for place in drawn), (label, sorted(drawn))
