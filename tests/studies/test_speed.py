"""`hp-gym speed` tells what it says it does; how fast is no test's business."""

import json
import math
from typing import Any

import pytest
from typer.testing import CliRunner

from hp_gym import _core
from hp_gym.cli.app import app
from hp_gym.studies.speed import fastsim_step, rates

runner = CliRunner()


@pytest.fixture(scope="module")
def told() -> dict[str, Any]:
    result = runner.invoke(app, ["speed", "--quick", "--json"])
    assert result.exit_code == 0, result.output
    data: dict[str, Any] = json.loads(result.stdout)
    return data


def numbers(value: Any) -> list[float]:
    if isinstance(value, dict):
        return [number for one in value.values() for number in numbers(one)]
    return [value]


def test_every_key_holds_positive_finite_numbers(told: dict[str, Any]) -> None:
    names = [
        "plant_step_us",
        "plant_step_random_us",
        "single_env_steps_per_s",
        "vector_steps_per_s",
        "cartpole_single_steps_per_s",
        "cartpole_vector_steps_per_s",
        "thread_scaling",
        "bytes_per_environment",
    ]
    assert set(told) == {*names, "fastsim_step_us", "spread"}
    for name in names:
        for number in numbers(told[name]):
            assert math.isfinite(number), name
            assert number > 0.0, name


def test_vectors_are_told_by_environments_and_threads(told: dict[str, Any]) -> None:
    sizes = {"1", "64", "1024"}
    assert set(told["vector_steps_per_s"]) == set(told["cartpole_vector_steps_per_s"]) == sizes
    assert all(set(by_threads) == {"1", "2"} for by_threads in told["vector_steps_per_s"].values())


def test_the_median_of_one_repeat_is_its_lowest_and_highest(told: dict[str, Any]) -> None:
    assert told["spread"]["plant_step_us"] == [told["plant_step_us"]] * 2


def test_fastsim_is_null_exactly_where_it_is_not_installed(told: dict[str, Any]) -> None:
    assert (told["fastsim_step_us"] is None) == (fastsim_step.measurement() is None)


def test_tables_name_what_was_measured() -> None:
    result = runner.invoke(app, ["speed", "--quick"], env={"COLUMNS": "200"})
    assert result.exit_code == 0, result.output
    for text in ("Plant step", "FASTSim 3", "CartPole-v1", "1,024", "Two threads gain"):
        assert text in result.stdout


@pytest.mark.parametrize("repeats", ["0", "-1"])
def test_less_than_one_repeat_is_refused(repeats: str) -> None:
    result = runner.invoke(app, ["speed", "--repeats", repeats])
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == f"hp-gym: --repeats is {repeats}, but must be at least 1\n"


def test_timed_steps_are_as_many_as_the_compressor_runs() -> None:
    seconds, steps = _core.plant_step_seconds("jeffs2019/case1-4")
    assert 600 < steps <= 1800
    assert seconds > 0.0
    assert (
        _core.plant_step_seconds("jeffs2019/case1-4", 1)[1]
        == _core.plant_step_seconds("jeffs2019/case1-4", 1)[1]
    )
    with pytest.raises(_core.ConfigurationError, match="unknown scenario `nowhere`"):
        _core.plant_step_seconds("nowhere")


def test_another_action_every_step_changes_the_steps_timed() -> None:
    assert rates.plant_step_us(random=True) != rates.plant_step_us(random=False)
