"""Bad input to the environments: what was given and what is allowed."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError, ResetNeeded

import hp_gym
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

GOOD = np.array([0, 0, 0, 0, 0, 0, 0, 0])


@pytest.mark.parametrize(
    ("kwargs", "message"),
    [
        ({"scenario": "nowhere"}, r"unknown scenario `nowhere`; available: jeffs2019/case1-1"),
        (
            {"distribution": "nothing"},
            r"unknown distribution of episodes `nothing`; available: test-v0, test-v1, train-v1",
        ),
        ({"scenario": "jeffs2019/case1-1", "distribution": "train-v1"}, "only one may be given"),
        ({"reward": "fame"}, "unknown reward `fame`; available: balanced"),
        ({"reward": {"energy_per_kwh": -1.0}}, r"`energy_per_kwh` is -1, but must be between 0 and 1000"),
        ({"reward": {"money": 1.0}}, "unknown field `money`"),
        (
            {"actions": "everything"},
            "unknown set of actions `everything`; available: default, heat, hpcu, all",
        ),
        ({"actions": ["heater"]}, "`heater`; available: battery, motor"),
        ({"actions": ["ptc", "ptc"]}, "`ptc` twice"),
        ({"actions": []}, "at least one action"),
        ({"observations": ["smell"]}, "unknown observation `smell`; available: default, preview, time_s"),
        ({"observations": ["soc", "default"]}, "`soc` twice"),
        ({"control_interval_s": 0}, "control_interval_s is 0, but must be between 1 and 3600"),
        ({"control_interval_s": 1.5}, "control_interval_s.*1.5"),
        ({"sensor_noise": -0.1}, "sensor_noise is -0.1, but must be between 0 and 1"),
        ({"sensor_noise": float("nan")}, "sensor_noise"),
        ({"continuous": "yes"}, "continuous.*yes"),
        ({"overrides": {"vehicle.wings": 2}, "scenario": "jeffs2019/case1-1"}, "wings"),
        ({"overrides": {"wings": 2}, "scenario": "jeffs2019/case1-1"}, "must begin with one of"),
        ({"render_mode": "ascii"}, "render_mode is 'ascii'"),
    ],
    ids=str,
)
def test_a_wrong_setting_is_named(kwargs: dict[str, Any], message: str) -> None:
    for kind in (EVHeatPumpEnv, EVHeatPumpVectorEnv):
        with pytest.raises(hp_gym.ConfigurationError, match=message):
            kind(**kwargs)


def test_a_distribution_file_of_ones_own_is_read_and_checked(tmp_path: Path) -> None:
    text = hp_gym._core.config_text("distribution of episodes", "train-v1")
    path = tmp_path / "mine.toml"
    path.write_text(text.replace("ambient_low_degc = -20.0", "ambient_low_degc = 39.0"))
    env = EVHeatPumpEnv(distribution=path)
    env.reset(seed=0)
    assert env.trip()["ambient_temperature_degc"] >= 39.0
    path.write_text(text.replace("ambient_low_degc = -20.0", "ambient_low_degc = 45.0"))
    with pytest.raises(
        hp_gym.ConfigurationError, match=r"ambient_low_degc` is 45, but must be between -inf and 40"
    ):
        EVHeatPumpEnv(distribution=path)


LEVELS = [
    (np.zeros(7, dtype=np.int64), ValueError, r"shape \[7\], but must have \(8,\): battery, motor"),
    (np.zeros((1, 8), dtype=np.int64), ValueError, r"shape \[1, 8\]"),
    (np.array(3), ValueError, r"shape \[\]"),
    (np.zeros(8), TypeError, "action is of type float64, but must be integer"),
    (np.zeros(8, dtype=bool), TypeError, "bool"),
    ("drive", TypeError, "must be integer"),
    (
        np.array([3, 0, 0, 0, 0, 0, 0, 0]),
        ValueError,
        r"action\[0\] \(battery\) is 3.*0 and 2 \(isolated, htc",
    ),
    (np.array([0, 0, 0, 0, 0, 0, 0, 11]), ValueError, r"action\[7\] \(compressor_power\) is 11.*0 and 10"),
    (np.array([0, -1, 0, 0, 0, 0, 0, 0]), ValueError, r"action\[1\] \(motor\) is -1"),
]
VALUES = [
    (np.zeros(9, dtype=np.float32), ValueError, r"shape \[9\]"),
    (np.zeros(8, dtype=np.int64), TypeError, "action is of type int64, but must be floating point"),
    (
        np.full(8, np.nan, dtype=np.float32),
        ValueError,
        r"action\[0\] \(battery\) is NaN, but must be a finite number",
    ),
    (
        np.array([0, 0, 0, 0, 0, 0, 0, np.inf], dtype=np.float32),
        ValueError,
        r"action\[7\] \(compressor_power\) is inf",
    ),
]


@pytest.mark.parametrize(
    ("continuous", "action", "error", "message"),
    [(False, *case) for case in LEVELS] + [(True, *case) for case in VALUES],
    ids=str,
)
def test_a_wrong_action_is_refused_and_changes_nothing(
    continuous: bool, action: Any, error: type[Exception], message: str
) -> None:
    env = EVHeatPumpEnv(scenario="jeffs2019/case1-1", continuous=continuous, actions="heat")
    env.reset(seed=0)
    before = env.get_state()
    with pytest.raises(error, match=message):
        env.step(action)
    assert env.get_state() == before


@pytest.mark.parametrize("other", [np.int32, np.uint8])
def test_other_integers_and_strides_mean_the_same_action(other: type) -> None:
    env = EVHeatPumpEnv(scenario="jeffs2019/case1-1", actions="heat")
    env.reset(seed=0)
    state = env.get_state()
    action = np.array([1, 1, 0, 1, 0, 1, 1, 9])
    expected = env.step(action)[1]
    for same in (action.astype(other), np.repeat(action, 2)[::2], action.tolist()):
        env.set_state(state)
        assert env.step(same)[1] == expected


def test_step_before_reset_after_the_end_and_after_close() -> None:
    env = EVHeatPumpEnv(scenario="ours/commute-minus5", control_interval_s=3600, actions="heat")
    with pytest.raises(ResetNeeded, match=r"reset\(\) first"):
        env.step(GOOD)
    env.reset(seed=0)
    assert env.step(GOOD)[2]
    with pytest.raises(ResetNeeded, match="has ended"):
        env.step(GOOD)
    env.close()
    env.close()
    for call in (lambda: env.step(GOOD), env.reset, env.action_masks):
        with pytest.raises(ClosedEnvironmentError, match="closed"):
            call()


def test_an_unknown_reset_option_or_scenario_leaves_the_trip_as_it_is() -> None:
    env = EVHeatPumpEnv(scenario="jeffs2019/case1-1", actions="heat")
    env.reset(seed=0)
    env.step(GOOD)
    before = env.get_state()
    with pytest.raises(
        hp_gym.ConfigurationError, match="unknown reset option `weather`; available: scenario"
    ):
        env.reset(options={"weather": "fine"})
    with pytest.raises(hp_gym.ConfigurationError, match="unknown scenario `nowhere`"):
        env.reset(options={"scenario": "nowhere"})
    assert env.get_state() == before


def test_one_wrong_action_stops_a_vector_step_before_any_environment_moves() -> None:
    envs = EVHeatPumpVectorEnv(3, scenario="jeffs2019/case1-1", actions="heat")
    with pytest.raises(ResetNeeded):
        envs.step(np.zeros((3, 8), dtype=np.int64))
    envs.reset(seed=0)
    before = envs.get_state()
    actions = np.zeros((3, 8), dtype=np.int64)
    actions[2, 5] = 4
    with pytest.raises(ValueError, match=r"action\[2, 5\] \(cabin\) is 4"):
        envs.step(actions)
    with pytest.raises(ValueError, match=r"shape \[2, 8\], but must have \(3, 8\)"):
        envs.step(actions[:2])
    assert envs.get_state() == before


@pytest.mark.parametrize(
    ("kwargs", "error", "message"),
    [
        ({"num_envs": 0}, hp_gym.ConfigurationError, "num_envs is 0"),
        ({"threads": -1}, hp_gym.ConfigurationError, "threads is -1"),
        ({"max_episode_steps": 0}, hp_gym.ConfigurationError, "max_episode_steps is 0"),
        ({"autoreset_mode": "never"}, hp_gym.ConfigurationError, "autoreset_mode is 'never'.*NextStep"),
        (
            {"num_envs": 2, "scenario": ["jeffs2019/case1-1"]},
            ValueError,
            "scenario has 1 entries",
        ),
    ],
    ids=str,
)
def test_a_wrong_setting_of_the_vector_environment_is_named(
    kwargs: dict[str, Any], error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        EVHeatPumpVectorEnv(**kwargs)


@pytest.mark.parametrize(
    ("mask", "error", "message"),
    [
        ([True, False], TypeError, "array of bool"),
        (np.array([1, 0]), TypeError, "array of bool"),
        (np.array([True]), ValueError, r"must have \(2,\)"),
        (np.array([False, False]), ValueError, "at least one environment"),
    ],
    ids=str,
)
def test_a_wrong_reset_mask_is_refused(mask: Any, error: type[Exception], message: str) -> None:
    envs = gym.make_vec("EVHeatPump-v0", num_envs=2, autoreset_mode="Disabled")
    envs.reset(seed=0)
    with pytest.raises(error, match=message):
        envs.reset(options={"reset_mask": mask})
