"""Distributions of trips: what they promise, and what is said of wrong ones."""

from pathlib import Path

import numpy as np
import pytest

import hp_gym
from hp_gym.agents.training.trips import drive
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv


def distribution(name: str) -> str:
    return hp_gym._core.config_text("distribution of episodes", name)


def test_a_training_trip_strands_only_by_what_a_controller_does() -> None:
    """A vehicle whose heat pump and PTC stay off arrives, however cold it is."""
    envs = EVHeatPumpVectorEnv(600, distribution="train-v2", actions="heat")
    off = np.zeros((600, 8), dtype=np.int64)
    driven = drive(envs, range(600), lambda *_: off)
    assert driven.ambient_degc.min() < -19.0
    assert driven.arrived.all()


def test_test_trips_are_those_of_the_first_version() -> None:
    """No value of `test-v0` has changed since, and so no trip may have."""
    env = EVHeatPumpEnv(distribution="test-v0")
    trips = []
    for seed in (0, 1, None):
        env.reset(seed=seed)
        trips.append(env.trip())
    assert [(trip["cycle"], trip["duration_s"]) for trip in trips] == [
        ("hwfet", 765),
        ("artemis-motorway-130", 1067),
        ("artemis-road", 1081),
    ]
    expected_degc = [21.746029306863818, -11.62150422856667, 30.111902423079023]
    np.testing.assert_array_equal([trip["ambient_temperature_degc"] for trip in trips], expected_degc)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "least_battery_temperature_degc = 0.0",
            "least_battery_temperature_degc = 60.0",
            r"cycles\[4\].least_battery_temperature_degc` is 60, but must be between -40 and 50",
        ),
        (
            "plugged_in_low_degc = -10.0",
            "plugged_in_low_degc = 20.0",
            "plugged_in_low_degc` is 20, but must be between -inf and 15",
        ),
        ("plugged_in_share = 0.3", "plugged_in_share = 1.3", "plugged_in_share` is 1.3"),
        ("plugged_in_share = 0.3", "", "plugged_in_share"),
        ('name = "udds"', 'name = "uds"', "unknown drive cycle `uds`"),
        ('name = "udds"', 'title = "udds"', "title"),
    ],
    ids=str,
)
def test_a_wrong_value_is_named(old: str, new: str, message: str, tmp_path: Path) -> None:
    text = distribution("train-v2")
    assert old in text
    path = tmp_path / "mine.toml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(hp_gym.ConfigurationError, match=message):
        EVHeatPumpEnv(distribution=path)


def test_cycles_by_name_alone_are_refused_with_their_place(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    head = distribution("train-v2").split("[ranges]")[0]
    ranges = distribution("train-v2").split("[ranges]")[1].split("[[cycles]]")[0]
    path.write_text(f'{head}cycles = ["udds"]\n[ranges]{ranges}')
    with pytest.raises(hp_gym.ConfigurationError, match=r"mine.toml: `cycles.*expected a table with `name`"):
        EVHeatPumpEnv(distribution=path)
