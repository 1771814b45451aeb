"""Cars of other architectures through every door: by name or path, alone, and together in one vector."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import hp_gym
from hp_gym import _core
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

VEHICLES = hp_gym.names("vehicle")
SCENARIO = "ours/commute-minus5"


def mine(folder: Path) -> Path:
    path = folder / "mine.toml"
    path.write_text('base = "jeffs2019-no-thermal-battery"\n[body]\nmass_kg = 2400.0\n')
    return path


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_every_car_is_an_environment(vehicle: str) -> None:
    env: Any = gym.make("EVHeatPump-v0", vehicle=vehicle, scenario=SCENARIO).unwrapped
    check_env(env)
    env.reset(seed=0)
    assert env.trip()["vehicle"] == vehicle
    layout = env.layout()
    names = [name for name, _, _ in _core.signals(layout["architecture"])]
    assert list(env.signals()) == names
    assert env.action_names == tuple(_core_default(layout["architecture"]))
    env.action_space.seed(0)
    for _ in range(200):
        observation, reward, *_ = env.step(env.action_space.sample())
        assert np.isfinite(observation).all()
        assert np.isfinite(reward)
        now = env.signals()
        assert abs(now["energy_residual_w"]) <= 1e-9 * now["energy_scale_w"]


def _core_default(architecture: str) -> list[str]:
    """Connections, heaters, valves of exchangers: what has options; compressor, and the cabin's air."""
    levels = {"compressor_power", "recirculation", "blower_level", "windscreen_share"}
    return [name for name, _, options, _ in _core.actuators(architecture) if options or name in levels]


@pytest.mark.parametrize("vehicle", VEHICLES)
def test_the_rules_drive_every_car_as_simulate_does(vehicle: str) -> None:
    run = hp_gym.simulate(SCENARIO, vehicle=vehicle)
    assert run.columns == tuple(name for name, _, _ in run.signals)
    env: Any = gym.make(
        "EVHeatPump-v0", vehicle=vehicle, scenario=SCENARIO, continuous=True, actions="all"
    ).unwrapped
    env.reset(seed=0)
    rules, terminated = HpcuPolicy(env), False
    while not terminated:
        _, _, terminated, _, _ = env.step(rules())
    summary = env.summary()
    assert summary.pop("clipped_share") == 0.0
    assert summary == pytest.approx(dict(run.summary), rel=1e-9, nan_ok=True)


def test_a_car_is_given_by_its_path(tmp_path: Path) -> None:
    path = mine(tmp_path)
    env: Any = gym.make("EVHeatPump-v0", vehicle=path, scenario=SCENARIO).unwrapped
    assert "thermal_battery" not in env.action_names
    env.reset(seed=0)
    assert env.trip()["vehicle"] == str(path)
    run = hp_gym.simulate(SCENARIO, vehicle=path)
    assert "thermal_battery_temperature_degc" not in run.columns
    experiment = hp_gym.Experiment(SCENARIO, vehicle=str(path))
    assert experiment.architecture == "no-thermal-battery"
    base = hp_gym.encode(experiment, {})
    command = hp_gym.encode(experiment, {"cabin": "htc", "compressor_power": 800.0}, base)
    moved = {experiment.actuator_names[row] for row in np.flatnonzero(command != base)}
    assert moved == {"cabin", "compressor_power"}
    with pytest.raises(hp_gym.ConfigurationError, match="unknown actuator `thermal_battery`"):
        hp_gym.encode(experiment, {"thermal_battery": "htc"})


def test_different_cars_share_a_vector(tmp_path: Path) -> None:
    cars = [None, str(mine(tmp_path)), "jeffs2019-direct", "jeffs2019-three-loops"]
    envs: Any = gym.make_vec("EVHeatPump-v0", num_envs=4, vehicle=cars, scenario=SCENARIO)
    envs.reset(seed=0)
    assert [envs.trip(index)["vehicle"] for index in range(4)] == ["jeffs2019", *cars[1:]]
    names = envs.action_names
    assert {"thermal_battery", "cabin_condenser", "compressor_power"} <= set(names)
    envs.action_space.seed(0)
    for _ in range(50):
        observations, rewards, *_ = envs.step(envs.action_space.sample())
    assert np.isfinite(observations).all()
    assert len(set(rewards.tolist())) == 4
    starts = np.concatenate([[0], np.cumsum(envs.single_action_space.nvec)])
    masks, store = envs.action_masks(), names.index("thermal_battery")
    of_store = masks[:, starts[store] : starts[store + 1]]
    assert of_store[0].sum() > 0
    # Those without a thermal battery.
    assert (of_store[1:3] == [True, False, False]).all()
    assert [len(envs.signals(index)) for index in range(4)] == [
        len(_core.signals(envs.layout(index)["architecture"])) for index in range(4)
    ]


def test_states_of_other_cars_are_refused_by_name() -> None:
    paper, other = (
        EVHeatPumpVectorEnv(2, scenario=SCENARIO, vehicle=car) for car in (None, "jeffs2019-direct")
    )
    for envs in (paper, other):
        envs.reset(seed=0)
    message = "vehicle `jeffs2019-direct`.*but this one has vehicle `jeffs2019`"
    with pytest.raises(hp_gym.StateError, match=message):
        paper.set_state(other.get_state())
    assert issubclass(hp_gym.StateError, hp_gym.ConfigurationError)
    state = bytearray(paper.get_state([0])[0])
    state[-40] ^= 1
    with pytest.raises(hp_gym.StateError, match="damaged"):
        paper.set_state([bytes(state)], [0])


def test_a_misspelt_row_comes_with_the_nearest() -> None:
    with pytest.raises(hp_gym.ConfigurationError, match=r"\(nearest: compressor_power\)$"):
        gym.make("EVHeatPump-v0", actions=["compresor_power"])
    with pytest.raises(hp_gym.ConfigurationError, match=r"\(nearest: soc\)$"):
        gym.make("EVHeatPump-v0", observations=["socc"])


def test_options_stand_in_an_order_of_ones_own() -> None:
    order = {"battery": ["isolated", "chiller", "htc"]}
    ours: Any = gym.make("EVHeatPump-v0", scenario=SCENARIO, actions="heat", action_options=order).unwrapped
    plain: Any = gym.make("EVHeatPump-v0", scenario=SCENARIO, actions="heat").unwrapped
    assert ours.option_names["battery"] == ("isolated", "chiller", "htc")
    for env in (ours, plain):
        env.reset(seed=0)
    action = np.array([1, 1, 0, 1, 0, 1, 1, 6])
    swapped = action.copy()
    swapped[0] = 2
    for _ in range(60):
        assert ours.step(swapped)[1] == plain.step(action)[1]
    np.testing.assert_array_equal(ours.action_masks()[[0, 2, 1]], plain.action_masks()[:3])
    with pytest.raises(hp_gym.ConfigurationError, match="must begin with `isolated`"):
        gym.make("EVHeatPump-v0", action_options={"battery": ["htc"]})


def test_flawed_architectures_and_vehicles_are_refused_with_file_and_key(tmp_path: Path) -> None:
    text = _core.config_text("architecture", "jeffs2019")
    path = tmp_path / "flawed.toml"
    path.write_text(text.replace('heats = "htc"', 'heats = "htk"'))
    with pytest.raises(hp_gym.ConfigurationError, match=r"flawed\.toml: `heater\[0\]\.heats` is `htk`.*htc"):
        _core.architecture_layout(str(path))
    path.write_text(text)
    assert _core.architecture_layout(str(path))["loops"] == _core.architecture_layout("jeffs2019")["loops"]
    car = tmp_path / "car.toml"
    car.write_text('base = "jeffs2019"\n[wings]\nspan_m = 3.0\n')
    with pytest.raises(hp_gym.ConfigurationError, match=r"car\.toml.*wings"):
        _core.vehicle_layout(str(car))


@pytest.mark.parametrize("architecture", hp_gym.names("architecture"))
def test_a_layout_names_columns_and_actuators_that_are_there(architecture: str) -> None:
    layout = _core.architecture_layout(architecture)
    signals = {name for name, _, _ in _core.signals(architecture)}
    actuators = {name for name, _, _, _ in _core.actuators(architecture)}
    flows = {row["flow"] for row in layout["flows"]}
    assert flows <= signals
    assert {row["temperature"] for row in layout["nodes"]} <= signals
    for group, keys in {
        "loops": ["supply", "return", "coolant_flow", "pump_power"],
        "branches": ["flow"],
        "exchangers": ["flow"],
        "heaters": ["power"],
        "cabins": ["air", "exhaust", "blower_power", "solar", "occupants"],
    }.items():
        for row in layout[group]:
            assert {row[key] for key in keys} <= signals, (group, row)
    named = [member["connection"] for member in layout["members"] if member["connection"]]
    assert set(named) <= signals
    assert {heater["actuator"] for heater in layout["heaters"]} <= actuators
    for link in layout["links"]:
        assert link["flow"] in flows
