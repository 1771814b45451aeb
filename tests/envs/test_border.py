"""What clients see of the environments: ids, infos, limits of steps, bounds, rewards, seeds."""

import copy
import logging
import pickle
import warnings
from collections.abc import Mapping
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import TimeAwareObservation
from stable_baselines3.common.env_checker import check_env as check_env_of_sb3

import hp_gym
from hp_gym.envs.modes import MODES
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.registration import LONGEST_TRIP_STEPS, ids

SHORT: dict[str, Any] = {"control_interval_s": 60}
SCALAR_IDS = [env_id for env_id in ids() if env_id != "EVHeatPumpMO-v0"]
SPACES = {
    "EVHeatPump-v0": gym.spaces.MultiDiscrete,
    "EVHeatPumpContinuous-v0": gym.spaces.Box,
    "EVHeatPumpFlat-v0": gym.spaces.Discrete,
    "EVHeatPumpMO-v0": gym.spaces.MultiDiscrete,
    "EVHeatPump/train-v1": gym.spaces.MultiDiscrete,
    "EVHeatPump/train-v2": gym.spaces.MultiDiscrete,
    "EVHeatPump/test-v0": gym.spaces.MultiDiscrete,
    "EVHeatPump/test-v1": gym.spaces.MultiDiscrete,
}


def equal(one: Any, other: Any, place: str = "") -> None:
    """Fails where two results of a vector environment differ in a key, a type or a bit."""
    if isinstance(one, dict):
        assert one.keys() == other.keys(), place
        for key in one:
            equal(one[key], other[key], f"{place}/{key}")
    elif isinstance(one, np.ndarray) and one.dtype == object:
        for index, (left, right) in enumerate(zip(one, other, strict=True)):
            assert (left is None) == (right is None), f"{place}[{index}]"
            if left is not None:
                equal(left, right, f"{place}[{index}]")
    else:
        assert (one.dtype, one.shape) == (other.dtype, other.shape), place
        np.testing.assert_array_equal(one, other, err_msg=place)


def test_every_id_has_its_space_and_its_trips() -> None:
    assert set(ids()) == set(SPACES)
    for env_id, space in SPACES.items():
        env: Any = gym.make(env_id).unwrapped
        envs = gym.make_vec(env_id, num_envs=2)
        assert isinstance(env.action_space, space)
        assert envs.single_action_space == env.action_space
        env.reset(seed=1)
    test: Any = gym.make("EVHeatPump/test-v1").unwrapped
    test.reset(seed=0)
    assert test.trip()["cycle"] in {"hwfet", "artemis-road", "artemis-motorway-130"}


@pytest.mark.parametrize("env_id", SCALAR_IDS)
def test_checkers_find_nothing_on_any_id(env_id: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Of a distribution with a later version gymnasium says so.
        warnings.filterwarnings("ignore", ".*is out of date", DeprecationWarning)
        check_env(gym.make(env_id).unwrapped)
        check_env_of_sb3(gym.make(env_id))


@pytest.mark.parametrize("limit", [None, 25])
@pytest.mark.parametrize("mode", list(AutoresetMode))
@pytest.mark.parametrize("env_id", ["EVHeatPump-v0", "EVHeatPumpContinuous-v0", "EVHeatPumpFlat-v0"])
def test_a_vector_gives_what_gymnasium_makes_of_single_ones(
    env_id: str, mode: AutoresetMode, limit: int | None
) -> None:
    """Bit for bit, infos with their keys and types included, over ends of trips and partial resets."""
    chosen: dict[str, Any] = {**SHORT, "info": ["cost", "action_mask", "terms"]}
    if limit is not None:
        chosen["max_episode_steps"] = limit
    ours = gym.make_vec(env_id, num_envs=3, autoreset_mode=mode, **chosen)
    theirs = gym.make_vec(
        env_id, num_envs=3, vectorization_mode="sync", vector_kwargs={"autoreset_mode": mode}, **chosen
    )
    for one, other in zip(ours.reset(seed=3), theirs.reset(seed=3), strict=True):
        equal(one, other, "reset")
    ours.action_space.seed(1)
    ended = 0
    for step in range(110):
        actions = ours.action_space.sample()
        results = ours.step(actions)
        for one, other in zip(results, theirs.step(actions), strict=True):
            equal(one, other, f"step {step}")
        over = results[2] | results[3]
        ended += int(over.sum())
        if mode == AutoresetMode.DISABLED and over.any():
            again = [envs.reset(options={"reset_mask": over.copy()}) for envs in (ours, theirs)]
            for one, other in zip(*again, strict=True):
                equal(one, other, f"reset after step {step}")
    assert ended >= 9


def test_infos_hold_the_same_numbers_at_reset_and_step() -> None:
    env: Any = gym.make("EVHeatPump-v0", info=["cost", "action_mask", "terms"], **SHORT)
    _, first = env.reset(seed=0)
    told = [first, *(env.step(env.action_space.sample())[4] for _ in range(5))]
    assert len({tuple(info) for info in told}) == 1
    for name, value in first.items():
        assert np.asarray(value).dtype.kind in "fi", name
        assert name == "action_mask" or value == 0.0
    np.testing.assert_array_equal(told[-1]["action_mask"], env.unwrapped.action_masks())
    assert set(gym.make("EVHeatPump-v0").reset(seed=0)[1]) == set(hp_gym._core.reward_parts())


def test_the_cost_is_that_of_comfort_and_limits() -> None:
    env: Any = gym.make("EVHeatPump-v0", info=["cost", "terms"], scenario="jeffs2019/case1-1", **SHORT)
    env.reset(seed=0)
    env.action_space.seed(0)
    total = 0.0
    over = False
    while not over:
        _, _, over, _, info = env.step(env.action_space.sample())
        limits = info["battery_window_k_h"] + info["protection_trips"] + info["stranded"]
        assert info["cost"] == pytest.approx(info["discomfort_k_h"] + limits, abs=1e-12)
        total += info["cost"]
    kpis = env.unwrapped.kpis()
    hours = env.unwrapped.trip()["duration_s"] / 3600.0
    least = kpis["discomfort_k"] * hours + kpis["battery_window_k_h"] + kpis["protection_trips"]
    assert total == pytest.approx(least, rel=1e-9)


def test_what_ended_in_a_step_is_told_in_every_mode() -> None:
    for mode in AutoresetMode:
        envs = EVHeatPumpVectorEnv(2, autoreset_mode=mode, scenario="jeffs2019/case1-1", **SHORT)
        single: Any = gym.make("EVHeatPump-v0", scenario="jeffs2019/case1-1", **SHORT).unwrapped
        envs.reset(seed=0)
        single.reset(seed=0)
        for _ in range(30):
            assert envs.finished == []
            actions = envs.rule_based_actions()
            envs.step(actions)
            single.step(actions[0])
            if single.end_reason() is not None:
                break
        trip = envs.finished[0]
        assert (trip.end_reason, trip.trip) == (single.end_reason(), single.trip())
        assert trip.kpis == single.kpis()
        np.testing.assert_equal(trip.summary, single.summary())
        if mode != AutoresetMode.SAME_STEP:
            assert envs.end_reason(0) == "arrived"
            assert envs.kpis(0) == trip.kpis


@pytest.mark.parametrize("interval_s", [1, 7, 60])
def test_the_registered_limit_cuts_no_trip(interval_s: int) -> None:
    chosen: dict[str, Any] = {"scenario": "jeffs2019/case1-1", "control_interval_s": interval_s}
    env: Any = gym.make("EVHeatPump-v0", **chosen)
    envs: Any = gym.make_vec("EVHeatPump-v0", num_envs=1, **chosen)
    assert env.spec.max_episode_steps == envs.spec.max_episode_steps == LONGEST_TRIP_STEPS
    env.reset(seed=0)
    envs.reset(seed=0)
    while True:
        action = env.unwrapped.rule_based_action()
        _, _, terminated, truncated, _ = env.step(action)
        _, _, ended, cut, _ = envs.step(action[None])
        assert (terminated, truncated) == (bool(ended[0]), bool(cut[0]))
        assert not truncated
        if terminated:
            break
    assert env.unwrapped.end_reason() == "arrived"


def test_time_aware_observations_and_a_limit_of_minus_1() -> None:
    env = TimeAwareObservation(gym.make("EVHeatPump-v0", max_episode_steps=500))
    observation, _ = env.reset(seed=0)
    assert env.observation_space.contains(observation)
    envs: Any = gym.make_vec("EVHeatPump-v0", num_envs=1, max_episode_steps=-1, **SHORT)
    envs.reset(seed=0)
    assert not any(envs.step(envs.action_space.sample())[3][0] for _ in range(40))
    with pytest.raises(hp_gym.ConfigurationError, match="max_episode_steps is 0"):
        EVHeatPumpVectorEnv(1, max_episode_steps=0)


@pytest.mark.parametrize("vehicle", hp_gym.names("vehicle"))
def test_no_default_row_is_clipped_under_adversarial_actions(vehicle: str) -> None:
    """`scripts/measure_clipping.py` does so for longer."""
    chance = np.random.default_rng(1)
    for distribution in ("train-v2", "test-v1"):
        envs = EVHeatPumpVectorEnv(12, vehicle=vehicle, distribution=distribution)
        envs.reset(seed=0)
        counts = envs.single_action_space.nvec  # type: ignore[attr-defined]
        for step in range(420):
            if step % 60 == 0:
                held = chance.integers(2, size=(12, len(counts))) * (counts - 1)
                held[:6, -1] = counts[-1] - 1
            envs.step(held)
        assert [envs.summary(index)["clipped_share"] for index in range(12)] == [0.0] * 12


def test_bounds_of_ones_own_hold_and_what_is_beyond_is_counted() -> None:
    chosen: dict[str, Any] = {
        "scenario": "jeffs2019/case1-1",
        "observations": ["soc", "cabin_temperature_degc"],
    }
    parked: Any = gym.make("EVHeatPump-v0", **chosen).unwrapped
    parked.reset(seed=0)
    start_degc = parked.signals()["cabin_temperature_degc"]
    low, high = start_degc - 0.05, start_degc + 0.05
    bounds = {"cabin_temperature_degc": (low, high), "soc": (0.0, 2.0)}
    narrow: Any = gym.make("EVHeatPump-v0", observation_bounds=bounds, **chosen).unwrapped
    narrow.reset(seed=0)
    steps = 0
    for _ in range(60):
        steps += 1
        observation = narrow.step(narrow.rule_based_action())[0]
        seen, signals = narrow.decode(observation), narrow.signals()
        assert seen["soc"] == pytest.approx(signals["soc"], abs=1e-6)
        assert observation[0] == pytest.approx(signals["soc"] - 1.0, abs=1e-6)
        if not low < signals["cabin_temperature_degc"] < high:
            assert abs(observation[1]) == 1.0
            break
    shares = narrow.clipped_shares()
    assert shares == {"soc": 0.0, "cabin_temperature_degc": pytest.approx(1.0 / (steps + 1))}
    state = narrow.get_state()
    narrow.reset()
    assert narrow.summary()["clipped_share"] == 0.0
    narrow.set_state(state)
    assert narrow.clipped_shares() == shares


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ({"cabin_temperature": (0.0, 1.0)}, r"unknown observation `cabin_temperature`.*nearest: cabin_temp"),
        ({"soc": (1.0, 1.0)}, r"observation_bounds of `soc` is \(1, 1\), but must be two finite numbers"),
        ({"soc": (0.0, float("nan"))}, "observation_bounds of `soc` is .*nan.*, but must be finite"),
        ({"soc": 3.0}, "observation_bounds of `soc` is 3.0, but must be two numbers"),
    ],
)
def test_bounds_that_are_none_are_refused(bounds: dict[str, Any], message: str) -> None:
    with pytest.raises(hp_gym.ConfigurationError, match=message):
        gym.make("EVHeatPump-v0", observation_bounds=bounds)


def test_a_car_wider_than_the_bounds_is_told_of_once(caplog: pytest.LogCaptureFixture) -> None:
    wide = {"vehicle.refrigeration.compressor.maximum_power_w": 9000.0, "vehicle.body.mass_kg": 1911.0}
    chosen: dict[str, Any] = {"vehicle": "jeffs2019-40ah", "overrides": wide}
    with caplog.at_level(logging.WARNING, logger="hp_gym"):
        for _ in range(2):
            gym.make("EVHeatPump-v0", **chosen)
            gym.make_vec("EVHeatPump-v0", num_envs=2, **chosen)
        gym.make("EVHeatPump-v0")
    (record,) = caplog.records
    assert "`jeffs2019-40ah` can reach compressor_power_w = 9000, but observations end at 8000" in (
        record.getMessage()
    )


def plain(parts: Mapping[str, Any]) -> Any:
    """A reward for single environments and vectors alike."""
    energy = -2.0 * parts["chemical_energy_kwh"] - parts["discomfort_k_h"] / parts["occupied_h"]
    return 1.0 + energy + parts["reward_penalties"]


@pytest.mark.parametrize("mode", list(AutoresetMode)[:2])
@pytest.mark.parametrize("limit", [None, 17])
def test_a_function_of_named_parts_is_a_reward(mode: AutoresetMode, limit: int | None) -> None:
    """It has a constant term and is not finite where nothing was driven."""
    chosen: dict[str, Any] = {**SHORT, "reward": plain, "scenario": "jeffs2019/case1-1"}
    if limit is not None:
        chosen["max_episode_steps"] = limit
    kind: dict[str, Any] = {"vectorization_mode": "sync", "vector_kwargs": {"autoreset_mode": mode}}
    theirs: Any = gym.make_vec("EVHeatPump-v0", num_envs=2, **kind, **chosen)
    ours: Any = gym.make_vec("EVHeatPump-v0", num_envs=2, autoreset_mode=mode, **chosen)
    theirs.reset(seed=0)
    ours.reset(seed=0)
    ours.action_space.seed(0)
    ended = 0
    for _ in range(80):
        actions = ours.action_space.sample()
        results = ours.step(actions)
        for one, other in zip(results, theirs.step(actions), strict=True):
            equal(one, other)
        ended += int((results[2] | results[3]).sum())
    assert ended >= 4
    assert set(ours.reset()[1]) == {key for part in hp_gym._core.reward_parts() for key in (part, f"_{part}")}


@pytest.mark.parametrize(
    ("reward", "message"),
    [
        (lambda parts: np.nan * parts["reward_energy"], "returned nan.*, but must return finite numbers"),
        (lambda _: np.zeros(7), r"returned the shape \(7,\), but must return"),
        (lambda _: "much", "returned 'much', but must return numbers"),
        (lambda _: None, "`<lambda>` returned"),
    ],
)
def test_a_function_that_gives_no_reward_is_refused(reward: Any, message: str) -> None:
    env: Any = gym.make("EVHeatPump-v0", reward=reward)
    envs = EVHeatPumpVectorEnv(2, reward=reward)
    for one in (env, envs):
        one.reset(seed=0)
        with pytest.raises(ValueError, match=message):
            one.step(one.action_space.sample())


def test_the_vector_of_rewards_adds_up_to_the_reward() -> None:
    objectives: Any = gym.make("EVHeatPumpMO-v0", **SHORT)
    scalar: Any = gym.make("EVHeatPump-v0", **SHORT)
    many: Any = gym.make_vec("EVHeatPumpMO-v0", num_envs=2, autoreset_mode=AutoresetMode.SAME_STEP, **SHORT)
    for env in (objectives, scalar, many):
        env.reset(seed=4)
    for _ in range(100):
        action = scalar.unwrapped.rule_based_action()
        _, vector, over, _, info = objectives.step(action)
        _, reward, *_ = scalar.step(action)
        rewards = many.step(np.stack([action, action]))[1]
        assert objectives.unwrapped.reward_space.contains(vector)
        assert vector.sum() == pytest.approx(reward, abs=1e-12)
        assert list(vector) == [info[part] for part in hp_gym._core.reward_parts()]
        assert rewards.shape == (2, 4)
        np.testing.assert_array_equal(rewards[0], vector)
        if over:
            break
    assert over
    with pytest.raises(hp_gym.ConfigurationError, match="reward is a function"):
        gym.make("EVHeatPumpMO-v0", reward=plain)


@pytest.mark.parametrize("kind", [int, np.int32, np.uint64, np.int64])
def test_a_seed_may_be_any_integer(kind: Any) -> None:
    env: Any = gym.make("EVHeatPump-v0").unwrapped
    np.testing.assert_array_equal(env.reset(seed=kind(7))[0], env.reset(seed=7)[0])
    envs = EVHeatPumpVectorEnv(2)
    expected = envs.reset(seed=7)[0]
    np.testing.assert_array_equal(envs.reset(seed=kind(7))[0], expected)
    np.testing.assert_array_equal(envs.reset(seed=[kind(7), kind(8)])[0], expected)


@pytest.mark.parametrize(("seed", "error"), [(1.5, TypeError), (-1, ValueError)])
def test_what_is_no_seed_is_refused(seed: Any, error: type[Exception]) -> None:
    for env in (gym.make("EVHeatPump-v0").unwrapped, EVHeatPumpVectorEnv(1)):
        with pytest.raises(error, match="seed"):
            env.reset(seed=seed)


def test_unknown_infos_are_refused() -> None:
    with pytest.raises(hp_gym.ConfigurationError, match="unknown info `mask`; available: cost, action_mask"):
        gym.make("EVHeatPump-v0", info="mask")


def test_an_id_that_is_not_there_is_refused_with_what_is() -> None:
    with pytest.raises(gym.error.Error, match="EVHeatPump"):
        gym.make("EVHeatPumpDiscrete-v0")
    with pytest.raises(hp_gym.ConfigurationError, match="only one may be given"):
        gym.make("EVHeatPump/test-v1", scenario="jeffs2019/case1-1")


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_a_restored_end_is_an_end(mode: AutoresetMode) -> None:
    """A state of a single environment knows no clock of a vector's."""
    single: Any = gym.make("EVHeatPump-v0", scenario="jeffs2019/case1-1", **SHORT).unwrapped
    single.reset(seed=0)
    while single.end_reason() is None:
        single.step(single.rule_based_action())
    envs = EVHeatPumpVectorEnv(1, autoreset_mode=mode, scenario="jeffs2019/case1-1", **SHORT)
    envs.set_state([single.get_state()])
    if mode == AutoresetMode.DISABLED:
        with pytest.raises(gym.error.ResetNeeded):
            envs.step(envs.rule_based_actions())
        return
    envs.step(envs.rule_based_actions())
    assert envs.summary(0)["duration_s"] == 0.0
    assert envs.step(envs.rule_based_actions())[1][0] < 0.0


def test_partial_resets_without_a_seed_draw_trips_of_their_own() -> None:
    envs = EVHeatPumpVectorEnv(4, autoreset_mode=AutoresetMode.DISABLED)
    envs.reset(options={"reset_mask": np.array([True, False, False, False])})
    envs.reset(options={"reset_mask": np.array([False, True, True, True])})
    assert len({envs.trip(index)["ambient_temperature_degc"] for index in range(4)}) == 4


def test_a_vector_can_be_copied_after_a_step_that_ended_a_trip() -> None:
    envs = EVHeatPumpVectorEnv(1, scenario="jeffs2019/case1-1", **SHORT)
    envs.reset(seed=0)
    while not envs.finished:
        envs.step(envs.rule_based_actions())
    for copied in (copy.deepcopy(envs), pickle.loads(pickle.dumps(envs))):
        np.testing.assert_array_equal(copied.rule_based_actions(), envs.rule_based_actions())
        assert copied.finished == []


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_partial_reset_leaves_the_others_as_they_are(noise: float) -> None:
    chosen: dict[str, Any] = {
        "scenario": "jeffs2019/case1-1",
        "observation_bounds": {"speed_m_s": (0.0, 1.0)},
        "sensor_noise": noise,
    }
    envs = EVHeatPumpVectorEnv(2, autoreset_mode=AutoresetMode.DISABLED, **chosen)
    single: Any = gym.make("EVHeatPump-v0", **chosen).unwrapped
    envs.reset(seed=0)
    single.reset(seed=0)
    for step in range(60):
        actions = envs.rule_based_actions()
        seen, expected = envs.step(actions)[0], single.step(actions[0])[0]
        np.testing.assert_array_equal(seen[0], expected)
        seen[:] = 7.0
        if step % 3 == 0:
            again = envs.reset(options={"reset_mask": np.array([False, True])})[0]
            np.testing.assert_array_equal(again[0], expected)
    assert 0.0 < single.clipped_shares()["speed_m_s"] < 1.0
    assert envs.clipped_shares(0) == single.clipped_shares()
    state = envs.get_state()
    envs.step(envs.rule_based_actions())
    before = envs.signals(0)["cabin_temperature_degc"]
    envs.set_state(state)
    seen = envs.reset(options={"reset_mask": np.array([False, True])})[0]
    assert envs.signals(0)["cabin_temperature_degc"] != before
    assert envs.decode(seen)["time_s"][0] == pytest.approx(60.0, abs=7200.0 * 3.0 * noise + 1e-2)


def test_what_ended_counts_its_last_observation_too() -> None:
    chosen: dict[str, Any] = {"scenario": "jeffs2019/case1-1", **SHORT}
    chosen["observation_bounds"] = {"time_s": (0.0, 100.0)}
    single: Any = gym.make("EVHeatPump-v0", **chosen).unwrapped
    single.reset(seed=0)
    while single.end_reason() is None:
        single.step(single.rule_based_action())
    for mode in AutoresetMode:
        envs = EVHeatPumpVectorEnv(1, autoreset_mode=mode, **chosen)
        envs.reset(seed=0)
        while not envs.finished:
            envs.step(envs.rule_based_actions())
        assert envs.finished[0].summary["clipped_share"] == single.summary()["clipped_share"] > 0.5


def test_nothing_that_is_returned_is_shared() -> None:
    envs = EVHeatPumpVectorEnv(2, autoreset_mode=AutoresetMode.SAME_STEP, info=["action_mask"], **SHORT)
    mask = np.array([True, True])
    infos = envs.reset(seed=0, options={"reset_mask": mask})[1]
    mask[:] = False
    assert all(marks.all() for name, marks in infos.items() if name.startswith("_"))
    while not envs.finished:
        infos = envs.step(envs.rule_based_actions())[4]
    infos["_reward_energy"][:] = False
    assert infos["_reward_discomfort"].all()
    trip = envs.finished[0]
    assert trip.last_observation is not None
    kept = trip.last_observation.copy()
    infos["final_obs"][trip.index][:] = 7.0
    np.testing.assert_array_equal(trip.last_observation, kept)
    flat: Any = gym.make("EVHeatPumpFlat-v0").unwrapped
    flat.modes[1]["cabin"] = "chiller"
    assert MODES[1] == {"cabin": "htc"}


def test_a_function_gets_parts_of_its_own() -> None:
    """The same in a single environment and in a vector, whatever else infos hold."""
    seen: list[set[str]] = []

    def greedy(parts: Any) -> Any:
        seen.append(set(parts))
        return -1.0 * parts.pop("reward_energy")

    env: Any = gym.make("EVHeatPump-v0", reward=greedy, info=["cost"], **SHORT)
    env.reset(seed=0)
    assert "reward_energy" in env.step(env.action_space.sample())[4]
    envs = EVHeatPumpVectorEnv(2, reward=greedy, info=["cost"], **SHORT)
    envs.reset(seed=0)
    assert "reward_energy" in envs.step(envs.action_space.sample())[4]
    assert seen[0] == seen[1]


def test_continuous_values_beyond_the_range_are_held() -> None:
    envs: Any = gym.make_vec("EVHeatPumpContinuous-v0", num_envs=2, scenario="jeffs2019/case1-1")
    one: Any = gym.make("EVHeatPumpContinuous-v0", scenario="jeffs2019/case1-1").unwrapped
    other: Any = gym.make("EVHeatPumpContinuous-v0", scenario="jeffs2019/case1-1").unwrapped
    for env in (envs, one, other):
        env.reset(seed=0)
    chance = np.random.default_rng(0)
    for _ in range(20):
        wild = (3.0 * chance.standard_normal(11)).astype(np.float32)
        kept = wild.copy()
        expected = other.step(np.clip(wild, -1.0, 1.0))
        equal(one.step(wild)[0], expected[0])
        equal(envs.step(np.stack([wild, wild]))[0][1], expected[0])
        np.testing.assert_array_equal(wild, kept)
