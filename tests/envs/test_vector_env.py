"""The vector environment against single environments, bit for bit."""

import copy
import os
import pickle
import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from hypothesis import given, settings
from hypothesis import strategies as st

from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

SHORT = {"control_interval_s": 20}
"""Trips of 15 to 90 steps: many ends in a thousand steps."""


def single(limit: int | None, kwargs: dict[str, Any]) -> gym.Env[Any, Any]:
    env: gym.Env[Any, Any] = EVHeatPumpEnv(**kwargs)
    return env if limit is None else gym.wrappers.TimeLimit(env, limit)


def same(ours: Any, theirs: Any, where: str) -> None:
    """Compares what two vector environments return, infos included."""
    if isinstance(ours, tuple):
        for place, (one, other) in enumerate(zip(ours, theirs, strict=True)):
            same(one, other, f"{where}[{place}]")
    elif isinstance(ours, dict):
        assert set(ours) == set(theirs), where
        for key in ours:
            same(ours[key], theirs[key], f"{where}.{key}")
    elif isinstance(ours, np.ndarray) and ours.dtype == object:
        assert [type(one) for one in ours] == [type(one) for one in theirs], where
        for one, other in zip(ours, theirs, strict=True):
            same(one, other, where)
    elif isinstance(ours, np.ndarray):
        assert ours.dtype == theirs.dtype, where
        np.testing.assert_array_equal(ours, theirs, err_msg=where)
    else:
        assert ours == theirs, where


@pytest.mark.parametrize("mode", list(AutoresetMode))
@settings(max_examples=4)
@given(
    seed=st.integers(0, 2**40),
    count=st.integers(1, 7),
    threads=st.integers(1, 3),
    limit=st.sampled_from([None, 37]),
    continuous=st.booleans(),
    noise=st.sampled_from([0.0, 0.05]),
)
def test_every_autoreset_mode_equals_single_environments(  # noqa: PLR0917
    mode: AutoresetMode,
    seed: int,
    count: int,
    threads: int,
    limit: int | None,
    continuous: bool,
    noise: float,
) -> None:
    kwargs = {**SHORT, "continuous": continuous, "sensor_noise": noise}
    ours = EVHeatPumpVectorEnv(count, autoreset_mode=mode, threads=threads, max_episode_steps=limit, **kwargs)
    theirs = SyncVectorEnv([lambda: single(limit, kwargs)] * count, autoreset_mode=mode)
    same(ours.reset(seed=seed), theirs.reset(seed=seed), "reset")
    ours.action_space.seed(seed)
    ends = 0
    for step in range(1000):
        actions = ours.action_space.sample()
        given, expected = ours.step(actions), theirs.step(actions)
        same(given, expected, f"step {step}")
        done = given[2] | given[3]
        ends += int(done.sum())
        if mode is AutoresetMode.DISABLED and done.any():
            options = {"reset_mask": done}
            same(ours.reset(options=options), theirs.reset(options=dict(options)), f"reset of step {step}")
    assert ends > 10 * count


def test_results_do_not_depend_on_the_number_of_threads() -> None:
    envs = [gym.make_vec("EVHeatPump-v0", num_envs=70, threads=threads, **SHORT) for threads in (1, 2, 5)]
    observations = [env.reset(seed=3)[0] for env in envs]
    envs[0].action_space.seed(3)
    for _ in range(150):
        actions = envs[0].action_space.sample()
        results = [env.step(actions) for env in envs]
        for other in results[1:]:
            same(other, results[0], "step")
    assert not np.array_equal(observations[0], results[0][0])


def test_each_environment_may_have_its_own_scenario() -> None:
    scenarios = ["jeffs2019/case1-1", None, "ours/hot-soak-plus35"]
    distributions = [None, "test-v0", None]
    envs = EVHeatPumpVectorEnv(3, scenario=scenarios, distribution=distributions)
    envs.reset(seed=0)
    driven = [envs.trip(index)["scenario"] for index in range(3)]
    assert driven == ["jeffs2019/case1-1", "ours/commute-minus5", "ours/hot-soak-plus35"]
    envs.reset(options={"scenario": ["jeffs2019/case2-1", None, None]})
    assert envs.trip(0)["scenario"] == "jeffs2019/case2-1"
    envs.reset()
    assert envs.trip(0)["scenario"] == "jeffs2019/case1-1"


@pytest.mark.parametrize("continuous", [False, True])
def test_masks_rules_and_totals_are_those_of_single_environments(continuous: bool) -> None:
    envs = EVHeatPumpVectorEnv(40, continuous=continuous, threads=2)
    singles = [EVHeatPumpEnv(continuous=continuous) for _ in range(40)]
    envs.reset(seed=20)
    for index, env in enumerate(singles):
        env.reset(seed=20 + index)
    for _ in range(50):
        np.testing.assert_array_equal(envs.action_masks(), [env.action_masks() for env in singles])
        actions = envs.rule_based_actions()
        assert (actions.shape, actions.dtype) == (envs.action_space.shape, envs.action_space.dtype)
        assert envs.action_space.contains(actions)
        np.testing.assert_array_equal(actions, [env.rule_based_action() for env in singles])
        np.testing.assert_array_equal(actions, envs.rule_based_actions())
        envs.step(actions)
        for env, action in zip(singles, actions, strict=True):
            env.step(action)
    for index, env in enumerate(singles):
        assert envs.summary(index) == pytest.approx(env.summary(), rel=0, abs=0, nan_ok=True)


def test_totals_of_a_finished_trip_last_until_its_environment_is_reset() -> None:
    envs = EVHeatPumpVectorEnv(2, scenario=["jeffs2019/case1-1", None], **SHORT)
    envs.reset(seed=0)
    terminated = np.zeros(2, dtype=np.bool_)
    while not terminated[0]:
        _, _, terminated, _, _ = envs.step(envs.rule_based_actions())
    assert envs.summary(0)["duration_s"] == 1800.0
    envs.step(envs.rule_based_actions())
    assert envs.summary(0)["duration_s"] == 0.0
    with pytest.raises(ValueError, match="index is 2, but must be below 2"):
        envs.summary(2)


def test_fork_continues_all_from_the_chosen_ones() -> None:
    envs = EVHeatPumpVectorEnv(4, sensor_noise=0.01, **SHORT)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    for _ in range(20):
        envs.step(envs.action_space.sample())
    envs.fork([2, 2, 0, 3])
    one = envs.single_action_space
    one.seed(1)
    for _ in range(200):
        observations, rewards, *_ = envs.step(np.stack([one.sample()] * 4))
        np.testing.assert_array_equal(observations[0], observations[1])
        assert rewards[0] == rewards[1]
    assert not np.array_equal(observations[0], observations[2])
    with pytest.raises(ValueError, match="index is 4, but must be below 4"):
        envs.fork([0, 1, 2, 4])
    with pytest.raises(ValueError, match="3 entries, but must have 4"):
        envs.fork([0, 1, 2])


@pytest.mark.parametrize("copier", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copy_continues_bit_for_bit(copier: Any) -> None:
    envs = EVHeatPumpVectorEnv(3, max_episode_steps=33, **SHORT)
    envs.reset(seed=0)
    envs.action_space.seed(0)
    for _ in range(50):
        envs.step(envs.action_space.sample())
    twin = copier(envs)
    for _ in range(150):
        actions = envs.action_space.sample()
        same(envs.step(actions), twin.step(actions), "step")


def test_states_go_back_all_or_none() -> None:
    envs = EVHeatPumpVectorEnv(2, **SHORT, actions="heat")
    envs.reset(seed=0)
    states = envs.get_state()
    actions = np.zeros((2, 8), dtype=np.int64)
    first = envs.step(actions)
    moved = envs.get_state()
    with pytest.raises(ValueError, match="damaged"):
        envs.set_state([states[0], states[1][:-1]])
    assert envs.get_state() == moved
    envs.set_state(states)
    same(envs.step(actions), first, "step")


def test_without_autoreset_a_step_after_the_end_names_the_environments() -> None:
    envs = EVHeatPumpVectorEnv(2, autoreset_mode="Disabled", max_episode_steps=1, actions="heat")
    envs.reset(seed=0)
    actions = np.zeros((2, 8), dtype=np.int64)
    envs.step(actions)
    with pytest.raises(ResetNeeded, match="environments 0, 1 have ended"):
        envs.step(actions)


def test_the_metadata_name_the_autoreset_mode() -> None:
    for mode in AutoresetMode:
        envs = gym.make_vec("EVHeatPump-v0", num_envs=2, autoreset_mode=mode)
        assert envs.metadata["autoreset_mode"] is mode


@pytest.mark.skipif(sys.platform == "win32", reason="no fork on Windows")
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_forked_process_steps_on_with_threads_of_its_own() -> None:
    envs = EVHeatPumpVectorEnv(64, threads=2, actions="heat")
    envs.reset(seed=0)
    actions = np.zeros((64, 8), dtype=np.int64)
    envs.step(actions)
    child = os.fork()
    if child == 0:
        envs.step(actions)
        os._exit(7)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7


def test_pictures_of_all_environments() -> None:
    envs = gym.make_vec("EVHeatPump-v0", num_envs=2, render_mode="rgb_array", render_size=(480, 270))
    envs.reset(seed=0)
    pictures = envs.render()
    assert pictures is not None
    assert [picture.shape for picture in pictures] == [(270, 480, 3)] * 2
