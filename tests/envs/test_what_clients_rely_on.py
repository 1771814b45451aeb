"""What outside clients rely on, checked without them (`.ci/clients` runs the clients themselves)."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import vector as vector_wrappers

import hp_gym  # noqa: F401, registers the ids

IDS = ("EVHeatPump-v0", "EVHeatPumpContinuous-v0", "EVHeatPumpFlat-v0")


def drive(env: gym.Env[Any, Any]) -> list[dict[str, Any]]:
    """Drives a trip at random; the infos of its steps."""
    env.action_space.seed(0)
    infos, over = [env.reset(seed=0)[1]], False
    while not over:
        _, _, terminated, truncated, info = env.step(env.action_space.sample())
        infos.append(info)
        over = terminated or truncated
    return infos


@pytest.mark.parametrize("name", IDS)
def test_every_value_of_an_info_has_a_dtype_and_the_same_keys_come_at_each_step(name: str) -> None:
    """TorchRL registers infos by the `dtype` of what the first reset gave."""
    infos = drive(gym.make(name, control_interval_s=20, info=["cost", "action_mask", "terms"]))
    for info in infos:
        assert info.keys() == infos[0].keys()
        assert {key: value.dtype for key, value in info.items()} == {
            key: value.dtype for key, value in infos[0].items()
        }


@pytest.mark.parametrize("name", [*IDS, "EVHeatPumpMO-v0"])
def test_an_argument_that_is_not_there_is_refused_in_pythons_words(name: str) -> None:
    """TorchRL offers `frameskip` to every environment, and looks for these words."""
    with pytest.raises(TypeError, match="unexpected keyword argument 'frameskip'"):
        gym.make(name, frameskip=1)
    with pytest.raises(TypeError, match="unexpected keyword argument 'frameskip'"):
        gym.make_vec(name, num_envs=2, frameskip=1)


@pytest.mark.parametrize("kind", [np.int32, np.int64, np.uint64])
def test_numpy_seeds_are_those_of_python(kind: type[np.integer[Any]]) -> None:
    env = gym.make("EVHeatPump-v0")
    wanted, _ = env.reset(seed=7)
    np.testing.assert_array_equal(env.reset(seed=kind(7))[0], wanted)
    envs = gym.make_vec("EVHeatPump-v0", num_envs=2)
    both, _ = envs.reset(seed=7)
    np.testing.assert_array_equal(envs.reset(seed=kind(7))[0], both)
    np.testing.assert_array_equal(envs.reset(seed=np.array([7, 8]).astype(kind))[0], both)
    np.testing.assert_array_equal(envs.reset(seed=[kind(7), kind(8)])[0], both)


def test_time_aware_observations_count_as_far_as_the_spec_or_the_user_says() -> None:
    env = gym.wrappers.TimeAwareObservation(gym.make("EVHeatPump-v0"), normalize_time=False)
    observation, _ = env.reset(seed=0)
    assert env.observation_space.contains(observation)
    observation, *_ = env.step(env.action_space.sample())
    assert env.observation_space.contains(observation)
    assert observation[-1] == 1
    own = gym.wrappers.TimeAwareObservation(
        gym.make("EVHeatPump-v0", max_episode_steps=4), normalize_time=True
    )
    own.reset(seed=0)
    seen = [own.step(own.action_space.sample()) for _ in range(4)]
    assert [step[0][-1] for step in seen] == [0.25, 0.5, 0.75, 1.0]
    assert [step[3] for step in seen] == [False, False, False, True]


def trips_seen(name: str, mode: Any) -> tuple[list[int], list[float]]:
    """Lengths and returns of trips as Gymnasium's wrappers of vectors tell them."""
    envs: Any = gym.make_vec(name, num_envs=3, vectorization_mode=mode, control_interval_s=20)
    envs = vector_wrappers.RecordEpisodeStatistics(envs)
    envs = vector_wrappers.NormalizeReward(vector_wrappers.NormalizeObservation(envs))
    envs.reset(seed=0)
    envs.action_space.seed(0)
    lengths, returns = [], []
    for _ in range(200):
        *_, infos = envs.step(envs.action_space.sample())
        if "episode" in infos:
            lengths += infos["episode"]["l"][infos["_episode"]].tolist()
            returns += infos["episode"]["r"][infos["_episode"]].tolist()
    envs.close()
    return lengths, returns


@pytest.mark.parametrize("name", IDS)
def test_vector_wrappers_see_the_same_trips_native_and_in_gymnasiums_own_vector(name: str) -> None:
    lengths, returns = trips_seen(name, "vector_entry_point")
    assert len(lengths) > 3
    assert trips_seen(name, "sync") == (lengths, pytest.approx(returns))
