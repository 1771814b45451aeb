"""Errors: their names, that they leave environments as they were, and what a mistake of ours leaves."""

import pickle
import struct
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from gymnasium.error import Error as GymnasiumError
from hypothesis import given, settings
from hypothesis import strategies as st

import hp_gym
from hp_gym import _core
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

if TYPE_CHECKING:
    from collections.abc import Callable

CASE = "jeffs2019/case1-1"
NUMBER = 3
HEADER = 30
"""Bytes of a state before its content; the last eight are a sum over all others."""

ERRORS = (ValueError, TypeError, OverflowError, GymnasiumError)


@pytest.mark.parametrize("name", ["ConfigurationError", "StateError", "InternalError"])
def test_errors_are_named_after_the_package_and_can_be_pickled(name: str) -> None:
    error = getattr(hp_gym, name)("why")
    assert f"{type(error).__module__}.{type(error).__qualname__}" == f"hp_gym.{name}"
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert copy.args == ("why",)


def test_the_message_of_an_error_comes_out_of_a_pool_of_processes() -> None:
    with (
        ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool,
        pytest.raises(hp_gym.ConfigurationError, match="unknown scenario `nowhere`"),
    ):
        pool.submit(hp_gym.simulate, "nowhere").result()


@pytest.fixture(scope="module")
def env() -> EVHeatPumpEnv:
    env = EVHeatPumpEnv(distribution="train-v2", sensor_noise=0.1)
    env.reset(seed=3)
    return env


@pytest.fixture(scope="module")
def envs() -> EVHeatPumpVectorEnv:
    envs = EVHeatPumpVectorEnv(NUMBER, threads=1, sensor_noise=0.1)
    envs.reset(seed=3)
    return envs


OTHER = EVHeatPumpEnv(scenario=CASE, continuous=True)
OTHER.reset(seed=0)
FOREIGN = OTHER.get_state()

WRONG_LEVELS = st.integers(-(2**40), -1) | st.integers(11, 2**40)
WRONG_ACTIONS = st.one_of(
    st.lists(st.integers(0, 1), min_size=0, max_size=20)
    .filter(lambda levels: len(levels) != 8)
    .map(np.array),
    st.tuples(st.integers(0, 7), WRONG_LEVELS).map(lambda at: np.eye(8, dtype=np.int64)[at[0]] * at[1]),
    st.just(np.full(8, np.nan)),
    st.just(np.zeros(11, dtype=np.complex128)),
    st.sampled_from([None, "up", {}, [[]], object()]),
)
NAMES = st.text(min_size=1, max_size=20).filter(lambda name: name not in hp_gym.names("scenario"))


def damage(state: bytes, place: int, value: int, cut: int) -> bytes:
    damaged = bytearray(state)
    damaged[place % len(damaged)] ^= value
    return bytes(damaged[: len(damaged) - cut])


DAMAGES = st.builds(
    lambda place, value, cut: lambda state: damage(state, place, value, cut),
    st.integers(0, 2**31),
    st.integers(1, 255),
    st.just(0) | st.integers(0, 5000),
) | st.sampled_from([lambda _: FOREIGN, lambda _: b"", lambda state: state + state])


@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_after_any_error_the_state_of_an_environment_is_the_same(
    env: EVHeatPumpEnv, data: st.DataObject
) -> None:
    if data.draw(st.booleans(), "drive on"):
        over = env.step(env.action_space.sample())[2]
        if over:
            env.reset()
    before = env.get_state()
    mistakes: dict[str, Callable[[], Any]] = {
        "action": lambda: env.step(data.draw(WRONG_ACTIONS)),
        "state": lambda: env.set_state(data.draw(DAMAGES)(before)),
        "scenario": lambda: env.reset(seed=5, options={"scenario": data.draw(NAMES)}),
        "distribution": lambda: env.reset(seed=5, options={"distribution": data.draw(NAMES)}),
        "option": lambda: env.reset(seed=5, options={"weather": 1}),
    }
    with pytest.raises(ERRORS):
        mistakes[data.draw(st.sampled_from(sorted(mistakes)))]()
    assert env.get_state() == before


WRONG_INDICES = st.lists(st.integers(-5, 9), max_size=5).filter(
    lambda indices: len(indices) != NUMBER or not all(0 <= index < NUMBER for index in indices)
)


@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_after_any_error_the_states_of_all_environments_are_the_same(
    envs: EVHeatPumpVectorEnv, data: st.DataObject
) -> None:
    if data.draw(st.booleans(), "drive on"):
        envs.step(envs.action_space.sample())
    before = envs.get_state()
    place = data.draw(st.integers(0, NUMBER - 1))

    def one_wrong_action() -> None:
        wrong = np.zeros((NUMBER, 11), dtype=np.int64)
        wrong[place, data.draw(st.integers(0, 7))] = data.draw(WRONG_LEVELS)
        envs.step(wrong)

    def one_damaged_state() -> None:
        states = list(before)
        states[place] = data.draw(DAMAGES)(states[place])
        envs.set_state(states)

    def one_unknown_scenario() -> None:
        names: list[str | None] = [None] * NUMBER
        names[place] = data.draw(NAMES)
        envs.reset(seed=7, options={"scenario": names})

    mistakes: dict[str, Callable[[], Any]] = {
        "action": one_wrong_action,
        "actions": lambda: envs.step(data.draw(WRONG_ACTIONS)),
        "state": one_damaged_state,
        "states": lambda: envs.set_state(before[: data.draw(st.integers(0, NUMBER - 1))]),
        "indices": lambda: envs.set_state(before, data.draw(WRONG_INDICES)),
        "fork": lambda: envs.fork(data.draw(WRONG_INDICES)),
        "scenario": one_unknown_scenario,
        "mask": lambda: envs.reset(seed=7, options={"reset_mask": np.zeros(NUMBER, dtype=np.bool_)}),
        "seeds": lambda: envs.reset(seed=[1] * (NUMBER + 1)),
    }
    with pytest.raises(ERRORS):
        mistakes[data.draw(st.sampled_from(sorted(mistakes)))]()
    assert envs.get_state() == before


def summed(state: bytes) -> bytes:
    """A state whose sum is right, whatever it says: not damage, but intent."""
    found = 0xCBF29CE484222325
    for byte in state[: HEADER - 8] + state[HEADER:]:
        found = (found ^ byte) * 0x100000001B3 % 2**64
    return state[: HEADER - 8] + found.to_bytes(8, "little") + state[HEADER:]


def breaking_state(env: EVHeatPumpEnv, action: Any) -> bytes:
    """A state that is accepted, and that the plant's equations then panic over."""
    good = env.get_state()
    assert summed(good) == good
    for place in range(HEADER + 200, len(good) - 8):
        state = summed(good[:place] + struct.pack("<d", np.nan) + good[place + 8 :])
        try:
            env.set_state(state)
            env.step(action)
        except hp_gym.InternalError:
            return state
        except (ValueError, GymnasiumError):
            continue
    message = "no state breaks anything any more: take another way to a panic"
    raise AssertionError(message)


def test_a_panic_is_an_internal_error_until_the_environment_is_reset_or_restored(
    capfd: pytest.CaptureFixture[str],
) -> None:
    env = EVHeatPumpEnv(scenario=CASE)
    env.reset(seed=0)
    action = np.zeros(11, dtype=np.int64)
    for _ in range(5):
        env.step(action)
    good = env.get_state()
    after = env.step(action)
    bad = breaking_state(env, action)
    for heal in (lambda: env.set_state(good), lambda: env.reset(seed=1)):
        env.set_state(bad)
        with pytest.raises(hp_gym.InternalError, match="please report it") as caught:
            env.step(action)
        assert len(str(caught.value)) <= 500
        for use in (lambda: env.step(action), env.get_state, env.action_masks, env.signals, env.summary):
            with pytest.raises(hp_gym.InternalError, match="reset all of it"):
                use()
        with pytest.raises(hp_gym.StateError):
            env.set_state(good[:-1])
        with pytest.raises(hp_gym.InternalError, match="reset all of it"):
            env.step(action)
        heal()
        env.step(action)
    env.set_state(good)
    np.testing.assert_array_equal(env.step(action)[0], after[0])
    assert capfd.readouterr().err == ""


def test_a_panic_in_one_of_many_environments_leaves_all_refused_until_all_are_begun_anew() -> None:
    alone = EVHeatPumpEnv(scenario=CASE)
    alone.reset(seed=0)
    action = np.zeros(11, dtype=np.int64)
    bad = breaking_state(alone, action)
    envs = EVHeatPumpVectorEnv(40, threads=2, scenario=CASE)
    envs.reset(seed=0)
    actions = np.zeros((40, 11), dtype=np.int64)
    good = envs.get_state()
    expected = envs.step(actions)[0]
    # States of a single environment are those of many.
    envs.set_state([bad], [33])
    with pytest.raises(hp_gym.InternalError, match="please report it"):
        envs.step(actions)
    mask = np.arange(40) == 33
    for use in (lambda: envs.step(actions), lambda: envs.reset(options={"reset_mask": mask})):
        with pytest.raises(hp_gym.InternalError, match="reset all of it"):
            use()
    envs.set_state(good)
    np.testing.assert_array_equal(envs.step(actions)[0], expected)


@pytest.mark.parametrize(
    ("lists", "threads", "message"),
    [
        (([None] * 2, ["train-v2"], [None] * 2), 1, "are 2, 1 and 2, but must be one each"),
        (([], [], []), 1, "are 0, 0 and 0"),
        (([None] * 2, ["train-v2"] * 2, [None] * 2), 0, "threads is 0, but must be between 1 and"),
        (([None] * 2, ["train-v2"] * 2, [None] * 2), 3, "threads is 3, but must be between 1 and the 2"),
    ],
)
def test_the_core_refuses_lists_and_threads_that_do_not_fit(
    lists: tuple[list[str | None], ...], threads: int, message: str
) -> None:
    with pytest.raises(hp_gym.ConfigurationError, match=message):
        _core.Vector(_core.default_settings(), *lists, "NextStep", None, threads)
