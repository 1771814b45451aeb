"""Algorithms of stable-baselines3 and sb3-contrib train on the environment."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from sb3_contrib import MaskablePPO, RecurrentPPO
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import DummyVecEnv

from hp_gym import _core
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.sb3 import SB3VecEnv

SHORT = {"control_interval_s": 20}


@pytest.mark.parametrize(
    ("algorithm", "policy"),
    [
        (PPO, "MlpPolicy"),
        (MaskablePPO, "MlpPolicy"),
        (RecurrentPPO, "MlpLstmPolicy"),
    ],
)
def test_on_policy_algorithms_train(algorithm: Any, policy: str) -> None:
    envs = SB3VecEnv(32, **SHORT)
    model = algorithm(policy, envs, n_steps=64, batch_size=1024, n_epochs=1, seed=0, device="cpu")
    model.learn(2048)
    assert model.num_timesteps == 2048
    assert len(model.ep_info_buffer) > 0


def test_sac_trains_on_continuous_actions() -> None:
    envs = SB3VecEnv(16, continuous=True, **SHORT)
    model = SAC("MlpPolicy", envs, learning_starts=500, train_freq=8, seed=0, device="cpu")
    model.learn(2000)
    assert model.num_timesteps >= 2000


def test_the_adapter_returns_what_a_dummy_vec_env_returns() -> None:
    limit = 40
    ours = SB3VecEnv(3, max_episode_steps=limit, **SHORT)
    theirs = DummyVecEnv([lambda: gym.wrappers.TimeLimit(EVHeatPumpEnv(**SHORT), limit)] * 3)
    ours.seed(5)
    theirs.seed(5)
    np.testing.assert_array_equal(ours.reset(), theirs.reset())
    assert ours.reset_infos == theirs.reset_infos
    ours.action_space.seed(5)
    cut_off = set()
    for _ in range(300):
        actions = np.stack([ours.action_space.sample() for _ in range(3)])
        given, expected = ours.step(actions), theirs.step(actions)
        for one, other in zip(given[:3], expected[:3], strict=True):
            np.testing.assert_array_equal(one, other)
        for done, info, other_info in zip(given[2], given[3], expected[3], strict=True):
            if done:
                cut_off.add(info["TimeLimit.truncated"])
                assert info["TimeLimit.truncated"] == other_info["TimeLimit.truncated"]
                np.testing.assert_array_equal(
                    info["terminal_observation"], other_info["terminal_observation"]
                )
                parts = _core.reward_parts()
                assert [info[part] for part in parts] == [other_info[part] for part in parts]
    assert cut_off == {True, False}


def test_methods_and_attributes_of_environments() -> None:
    envs = SB3VecEnv(3, scenario="jeffs2019/case1-1", **SHORT)
    envs.reset()
    masks = envs.env_method("action_masks")
    assert [mask.shape for mask in masks] == [(62,)] * 3
    assert envs.has_attr("action_masks")
    assert envs.get_attr("action_masks", [1])[0]().shape == (62,)
    states = envs.env_method("get_state", indices=[0])
    envs.step(np.stack(envs.env_method("rule_based_action")))
    envs.env_method("set_state", states[0], indices=[1])
    assert envs.env_method("get_state", indices=[1]) == states
    assert envs.env_method("summary", indices=[0])[0]["duration_s"] == 20.0
    assert envs.get_attr("num_envs") == [3, 3, 3]
    with pytest.raises(AttributeError, match="no method `drive_home`"):
        envs.env_method("drive_home")


def test_the_rules_are_evaluated_as_a_model() -> None:
    envs = SB3VecEnv(2, scenario="jeffs2019/case1-1", **SHORT)
    model: Any = HpcuPolicy(envs.venv)
    mean, spread = evaluate_policy(model, envs, n_eval_episodes=2, warn=False)
    assert -100.0 < mean < -10.0
    assert spread == 0.0
