"""The single environment."""

import copy
import pickle
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import given, settings
from hypothesis import strategies as st
from stable_baselines3.common.env_checker import check_env as check_env_of_sb3

import hp_gym
from hp_gym import _core
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.modes import MODES

MODES_OF_ACTION = [
    {},
    {"continuous": True},
    {"actions": "hpcu"},
    {"actions": "all", "continuous": True},
    {"actions": ["compressor_power", "cabin"], "control_interval_s": 30},
    {"observations": ["default", "preview", "time_left_s", "charge_soc"], "sensor_noise": 0.02},
]
PAPER = [f"jeffs2019/case1-{i}" for i in range(1, 6)] + [f"jeffs2019/case2-{i}" for i in range(1, 5)]
HTC, CHILLER = 1, 2


def make(**kwargs: Any) -> gym.Env[Any, Any]:
    return gym.make("EVHeatPump-v0", disable_env_checker=True, **kwargs)


def kpis(env: gym.Env[Any, Any]) -> dict[str, float]:
    inner: Any = env.unwrapped
    told: dict[str, float] = inner.kpis()
    return told


def drive(
    env: gym.Env[Any, Any], policy: Any, seed: int = 0
) -> tuple[np.ndarray, list[float], dict[str, Any]]:
    """Drives a trip to its end; returns all signals second by second, the rewards and the last info."""
    observation, _ = env.reset(seed=seed)
    inner: Any = env.unwrapped
    rows, rewards = [list(inner.signals().values())], []
    while True:
        observation, reward, terminated, _, info = env.step(policy(observation))
        rows.append(list(inner.signals().values()))
        rewards.append(float(reward))
        if terminated:
            return np.array(rows), rewards, info


@pytest.mark.parametrize("kwargs", MODES_OF_ACTION, ids=str)
def test_gymnasium_finds_nothing_to_complain_about(kwargs: dict[str, Any]) -> None:
    check_env(gym.make("EVHeatPump-v0", **kwargs).unwrapped)


@pytest.mark.parametrize("kwargs", MODES_OF_ACTION, ids=str)
def test_stable_baselines3_finds_nothing_to_complain_about(kwargs: dict[str, Any]) -> None:
    check_env_of_sb3(make(**kwargs))


@pytest.mark.parametrize("scenario", PAPER)
def test_hpcu_through_the_environment_drives_what_simulate_drives(scenario: str) -> None:
    expected = hp_gym.simulate(scenario)
    env = make(scenario=scenario, continuous=True, actions=HpcuPolicy.ACTIONS)
    rows, _, _ = drive(env, HpcuPolicy(env))
    np.testing.assert_array_equal(rows, expected.values)
    inner: Any = env.unwrapped
    assert inner.end_reason() == expected.end_reason
    summary = inner.summary()
    assert summary.pop("clipped_share") == 0.0
    np.testing.assert_equal(summary, dict(expected.summary))


@pytest.mark.parametrize("scenario", [*PAPER, "ours/hot-soak-plus35"])
def test_hpcu_on_levels_needs_within_5_percent_of_its_energy(scenario: str) -> None:
    expected = hp_gym.simulate(scenario).summary["energy_kwh"]
    env = make(scenario=scenario, actions=HpcuPolicy.ACTIONS)
    drive(env, HpcuPolicy(env))
    summary = env.unwrapped.summary()  # type: ignore[attr-defined]
    assert summary["energy_kwh"] == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("reward", ["balanced", "energy", "comfort", "stored-heat", "durable"])
def test_rewards_add_up_to_the_score(reward: str) -> None:
    env = make(scenario="ours/commute-minus5", reward=reward)
    _, rewards, info = drive(env, HpcuPolicy(env))
    assert sum(rewards) == pytest.approx(kpis(env)["score"], rel=1e-9)
    assert info["reward_heat_left"] == 0.0 or reward == "stored-heat"


def test_kpis_agree_with_the_totals_of_simulate() -> None:
    env = make(scenario="jeffs2019/case1-1", continuous=True, actions="hpcu")
    drive(env, HpcuPolicy(env))
    summary = hp_gym.simulate("jeffs2019/case1-1").summary
    assert kpis(env)["chemical_energy_kwh"] == pytest.approx(summary["battery_chemical_energy_kwh"])
    assert kpis(env)["discomfort_k"] == pytest.approx(summary["discomfort_k"])


def test_reference_energy_depends_on_the_scenario_alone() -> None:
    references = []
    for policy in ("hpcu", "random"):
        env = make(scenario="jeffs2019/case1-1")
        env.action_space.seed(5)
        choose = HpcuPolicy(env) if policy == "hpcu" else lambda _, env=env: env.action_space.sample()
        drive(env, choose)
        references.append(kpis(env)["reference_energy_kwh"])
    assert references[0] == references[1]


def test_parts_of_the_reward_add_up_to_it() -> None:
    env = make()
    env.reset(seed=3)
    env.action_space.seed(3)
    for _ in range(200):
        _, reward, terminated, _, info = env.step(env.action_space.sample())
        assert sum(info[name] for name in _core.reward_parts()) == pytest.approx(reward, abs=1e-15)
        if terminated:
            env.reset()


@settings(max_examples=25)
@given(seed=st.integers(0, 2**31))
def test_a_mask_bit_equals_what_is_granted_in_the_first_second(seed: int) -> None:
    """Each option of each connection is tried from the same state, the air moved by the rules."""
    env: Any = make(actions="heat")
    env.reset(seed=seed)
    env.action_space.seed(seed)
    for _ in range(40):
        env.step(env.action_space.sample())
    inner: Any = env.unwrapped
    state, masks = inner.get_state(), inner.action_masks()
    counts = env.action_space.nvec
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    actuators = [(name, options) for name, _, options, _ in _core.actuators()]
    assert len(masks) == counts.sum()
    for row in range(6):
        name, options = actuators[row]
        for option, circuit in enumerate(options):
            inner.set_state(state)
            action = env.action_space.sample()
            action[row] = option
            env.step(action)
            granted = inner.signals()[f"{name}_connection"]
            wanted = {"isolated": 0, "htc": HTC, "chiller": CHILLER}[circuit]
            assert masks[starts[row] + option] == (granted == wanted), (name, circuit)
    assert masks[starts[6] :].all()


@settings(max_examples=10)
@given(seed=st.integers(0, 2**31))
def test_a_masked_connection_of_the_cabin_is_granted_with_no_air_that_an_agent_may_choose(seed: int) -> None:
    """Fresh or recirculated: one of both ends is granted where the mask says so, none where it does not."""
    env: Any = make()
    env.reset(seed=seed)
    env.action_space.seed(seed)
    for _ in range(40):
        env.step(env.action_space.sample())
    inner: Any = env.unwrapped
    state, masks, names = inner.get_state(), inner.action_masks(), inner.action_names
    starts = np.concatenate([[0], np.cumsum(env.action_space.nvec)[:-1]])
    cabin, recirculation, blower = (names.index(name) for name in ("cabin", "recirculation", "blower_level"))
    for option, circuit in enumerate((0, HTC, CHILLER)):
        granted = []
        for share in range(11):
            inner.set_state(state)
            action = env.action_space.sample()
            action[[cabin, recirculation, blower]] = option, share, 10
            env.step(action)
            granted.append(inner.signals()["cabin_connection"] == circuit)
        assert masks[starts[cabin] + option] == any(granted), (circuit, granted)


@pytest.mark.parametrize("copier", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])
def test_a_copy_continues_bit_for_bit(copier: Any) -> None:
    env = make(sensor_noise=0.01)
    env.reset(seed=11)
    env.action_space.seed(11)
    actions = [env.action_space.sample() for _ in range(4000)]
    for action in actions[:100]:
        env.step(action)
    twin = copier(env)
    for action in actions[100:]:
        ours, theirs = env.step(action), twin.step(action)
        np.testing.assert_array_equal(ours[0], theirs[0])
        assert ours[1:4] == theirs[1:4]
        if ours[2]:
            np.testing.assert_array_equal(env.reset()[0], twin.reset()[0])


def test_set_state_goes_back_to_get_state() -> None:
    env: Any = make().unwrapped
    env.reset(seed=1)
    env.action_space.seed(1)
    actions = [env.action_space.sample() for _ in range(300)]
    state = env.get_state()
    first = [env.step(action)[1] for action in actions]
    env.set_state(state)
    assert [env.step(action)[1] for action in actions] == first


def test_a_state_is_refused_by_other_settings_and_when_damaged() -> None:
    env: Any = make().unwrapped
    env.reset(seed=1)
    state = env.get_state()
    other: Any = make(reward="comfort").unwrapped
    with pytest.raises(hp_gym.ConfigurationError, match="with other parameters"):
        other.set_state(state)
    for damaged, why in [(b"", "0 bytes"), (b"x" * 99, "something else"), (state[:-3], "damaged")]:
        with pytest.raises(hp_gym.ConfigurationError, match=why):
            env.set_state(damaged)
    with pytest.raises(hp_gym.ConfigurationError, match="version 10"):
        env.set_state(state[:4] + b"\x0a\x00" + state[6:])
    env.step(env.action_space.sample())


def test_an_action_is_held_for_the_control_interval() -> None:
    slow, fast = make(control_interval_s=10, actions="heat"), make(actions="heat")
    for env in (slow, fast):
        env.reset(seed=4)
    action = np.array([0, 1, 0, 1, 0, 1, 1, 6])
    _, reward, *_ = slow.step(action)
    rewards = [float(fast.step(action)[1]) for _ in range(10)]
    assert reward == pytest.approx(sum(rewards), rel=1e-12)
    assert slow.unwrapped.signals() == fast.unwrapped.signals()  # type: ignore[attr-defined]


def test_reset_options_choose_a_trip_once() -> None:
    env = make()
    inner: Any = env.unwrapped
    env.reset(seed=2, options={"scenario": "jeffs2019/case2-1"})
    assert inner.trip()["scenario"] == "jeffs2019/case2-1"
    env.reset(options={"distribution": "test-v0"})
    assert inner.trip()["cycle"] in {"hwfet", "artemis-road", "artemis-motorway-130"}
    env.reset()
    assert inner.trip()["cycle"] not in {"hwfet", "artemis-road", "artemis-motorway-130"}


def test_the_same_seed_draws_the_same_trips_and_another_does_not() -> None:
    env: Any = make().unwrapped
    trips: list[list[dict[str, Any]]] = []
    for seed in (8, 8, 9):
        env.reset(seed=seed)
        trips.append([])
        for _ in range(3):
            env.reset()
            trips[-1].append(env.trip())
    assert trips[0] == trips[1] != trips[2]


def test_without_a_seed_two_environments_drive_different_trips() -> None:
    trips = []
    for _ in range(2):
        env: Any = make().unwrapped
        env.reset()
        trips.append(env.trip())
    assert trips[0] != trips[1]


def test_an_empty_battery_ends_the_trip_at_a_price() -> None:
    nearly_empty = {"scenario.initial.state_of_charge_pct": 5.0}
    env = make(scenario="jeffs2019/case1-1", overrides=nearly_empty, actions="heat")
    env.reset(seed=0)
    action = np.array([0, 0, 0, 0, 0, 1, 1, 0])
    while True:
        _, reward, terminated, truncated, _ = env.step(action)
        if terminated:
            break
    inner: Any = env.unwrapped
    assert inner.end_reason() == "battery_empty"
    assert not truncated
    assert float(reward) < -400.0


def test_a_weak_car_arrives_late_with_the_whole_way_driven_and_pays_for_it() -> None:
    weak = {"scenario.cycle": "us06", "vehicle.motor.maximum_mechanical_power_w": 40_000.0}
    rows = ["default", "distance_behind_m"]
    env = make(scenario="jeffs2019/case1-1", overrides=weak, observations=rows, actions="heat")
    env.reset(seed=0)
    inner: Any = env.unwrapped
    duration_s, rewards, behind_m, terminated = inner.trip()["duration_s"], [], [], False
    while not terminated:
        observation, reward, terminated, truncated, _ = env.step(np.array([0, 0, 0, 0, 0, 1, 1, 0]))
        rewards.append(float(reward))
        behind_m.append(inner.decode(observation)["distance_behind_m"])
    delay_s = len(rewards) - duration_s
    assert inner.end_reason() == "arrived"
    assert not truncated
    assert inner.kpis()["delay_s"] == inner.summary()["delay_s"] == delay_s > 30
    assert max(behind_m) == pytest.approx(inner.summary()["furthest_behind_m"], rel=1e-3)
    experiment = _core.Experiment("jeffs2019/case1-1", None, ['scenario.cycle="us06"'])
    assert inner.summary()["distance_km"] == pytest.approx(experiment.distance_m / 1000.0, abs=1e-3)
    # 1000 points an hour, besides energy and discomfort.
    assert sum(rewards) < -1000.0 / 3600.0 * delay_s


def test_returned_arrays_are_the_callers() -> None:
    env = make(scenario="jeffs2019/case1-1")
    first, _ = env.reset(seed=0)
    kept = first.copy()
    second = env.step(env.action_space.sample())[0]
    second[:] = 7.0
    np.testing.assert_array_equal(first, kept)
    assert env.observation_space.contains(env.step(env.action_space.sample())[0])


def test_flat_actions_are_modes_of_the_same_environment() -> None:
    flat = partial(gym.make, "EVHeatPumpFlat-v0", disable_env_checker=True)
    env: Any = flat(scenario="jeffs2019/case1-1").unwrapped
    assert isinstance(env.action_space, gym.spaces.Discrete)
    env.reset(seed=0)
    assert env.action_masks().shape == (len(MODES),)
    assert env.action_masks()[0]
    plain: Any = make(scenario="jeffs2019/case1-1", actions="heat").unwrapped
    plain.reset(seed=0)
    for mode, options in enumerate(MODES):
        named = plain.option_names
        action = [
            named[name].index(options[name]) if isinstance(options.get(name), str) else options.get(name, 0)
            for name in named
        ]
        np.testing.assert_array_equal(env.step(np.int64(mode))[0], plain.step(np.array(action))[0])
    with pytest.raises(ValueError, match="from 0 to"):
        env.step(np.int64(len(MODES)))
    with pytest.raises(hp_gym.ConfigurationError, match="unknown action `heater`"):
        flat(modes=[{}, {"heater": 1}])
    with pytest.raises(hp_gym.ConfigurationError, match=r"`cabin` is 'hot'.*isolated, htc, chiller"):
        flat(modes=[{}, {"cabin": "hot"}])
    with pytest.raises(hp_gym.ConfigurationError, match="at least two modes"):
        flat(modes=[{}])
    with pytest.raises(hp_gym.ConfigurationError, match="continuous is True"):
        flat(continuous=True)


def test_pictures_are_drawn_in_the_size_asked_for() -> None:
    env = make(scenario="jeffs2019/case1-1", actions="heat", render_mode="rgb_array", render_size=(640, 360))
    env.reset(seed=0)
    before: Any = env.render()
    for _ in range(60):
        env.step(np.array([1, 1, 0, 1, 0, 1, 1, 10]))
    after: Any = env.render()
    assert before.shape == after.shape == (360, 640, 3)
    assert (before != after).any()
