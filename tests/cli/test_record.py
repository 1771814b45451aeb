"""`hp-gym record`: Minari data sets whose trips can be driven again, written whole or not at all."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from typer.testing import CliRunner, Result

import hp_gym
from hp_gym.cli.app import app
from hp_gym.registration import ENV_ID

minari = pytest.importorskip("minari", reason="Minari is not installed (extra `data`)")

FAILING = """
import numpy as np

class Late:
    environment = {"control_interval_s": 60}
    trips = 0

    def begin(self, env):
        Late.trips += env.num_envs
        if Late.trips > 16:
            raise ERROR

    def predict(self, observations):
        return np.zeros((len(observations), 11), dtype=np.int64)
"""

Recorder = Callable[..., Result]


@pytest.fixture
def record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Recorder:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "sets"))

    def invoke(*arguments: object) -> Result:
        words = ["record", *arguments, "--out", "sets"]
        return CliRunner().invoke(app, [str(word) for word in words])

    return invoke


def drive_again(data: Any) -> None:
    """Checks every trip against the environment that the data set gives back, bit for bit."""
    env = data.recover_environment()
    for episode, told in zip(
        data.iterate_episodes(), data.storage.get_episode_metadata(data.episode_indices), strict=True
    ):
        seen, info = env.reset(seed=told["seed"])
        rows = [(seen, info)]
        for step, action in enumerate(episode.actions):
            seen, reward, terminated, truncated, info = env.step(action)
            rows.append((seen, info))
            assert reward == episode.rewards[step]
            assert (terminated, truncated) == (episode.terminations[step], episode.truncations[step])
        assert terminated
        np.testing.assert_array_equal(episode.observations, [seen for seen, _ in rows])
        assert episode.infos.keys() == info.keys()
        for name, values in episode.infos.items():
            np.testing.assert_array_equal(values, [info[name] for _, info in rows], err_msg=name)
    env.close()


@pytest.mark.parametrize("controller", ["hpcu", "random", "off"])
def test_recorded_trips_are_those_of_the_environment_that_comes_with_them(
    controller: str, record: Recorder
) -> None:
    result = record(controller, "--episodes", 3, "--seed", 5, "--info", "cost", "--info", "action_mask")
    assert result.exit_code == 0, result.output
    data = minari.load_dataset(f"evheatpump/{controller}-v0")
    assert data.total_episodes == 3
    drive_again(data)
    assert list(minari.list_local_datasets()) == [f"evheatpump/{controller}-v0"]


def test_trips_of_more_than_one_batch_are_numbered_through_and_driven_by_each_training_seed(
    record: Recorder,
) -> None:
    result = record("ppo", "--seeds", "0,2", "--episodes", 19, "--distribution", "test-v0", "--json")
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    data = minari.load_dataset("evheatpump/ppo-v0")
    assert (
        (told["episodes"], told["steps"]) == (data.total_episodes, data.total_steps) == (19, data.total_steps)
    )
    assert [one["seed"] for one in data.storage.get_episode_metadata(range(19))] == list(range(19))
    assert data.storage.metadata["controller_seeds"] == [0, 2]
    assert told["mean_return"] == pytest.approx(
        np.mean([episode.rewards.sum() for episode in data.iterate_episodes()])
    )
    drive_again(data.filter_episodes(lambda episode: episode.id >= 15))


def test_random_actions_differ_from_batch_to_batch(record: Recorder) -> None:
    assert record("random", "--episodes", 17).exit_code == 0
    first, *_, last = minari.load_dataset("evheatpump/random-v0").iterate_episodes()
    steps = min(len(first.actions), len(last.actions))
    assert (first.actions[:steps] != last.actions[:steps]).mean() > 0.3


def test_metadata_tell_where_the_data_come_from(record: Recorder) -> None:
    words = ["--id", "evheatpump/cold/rules-v3", "--episodes", 2, "--distribution", "test-v0", "--seed", 9]
    result = record(
        "hpcu-tuned", *words, "--author", "A. Writer", "--license", "CC-BY-4.0", "--code-link", "here"
    )
    assert result.exit_code == 0, result.output
    told = minari.load_dataset("evheatpump/cold/rules-v3").storage.metadata
    assert told["author"] == {"A. Writer"}
    assert told["license"] == "CC-BY-4.0"
    assert told["code_permalink"] == "here"
    assert told["algorithm_name"] == told["controller"] == "hpcu-tuned"
    assert told["hp_gym_version"] == hp_gym.__version__
    assert told["minari_version"] == minari.__version__
    assert (told["distribution"], told["seed"]) == ("test-v0", 9)
    assert "test-v0" in told["description"]
    assert gym.envs.registration.EnvSpec.from_json(told["env_spec"]).id == ENV_ID


@pytest.mark.parametrize(("error", "code"), [("ValueError('no more')", 2), ("KeyboardInterrupt", 130)])
def test_a_recording_that_ends_early_leaves_the_earlier_data_set_and_nothing_else(
    error: str, code: int, record: Recorder, tmp_path: Path
) -> None:
    module = f"late_{code}"
    (tmp_path / f"{module}.py").write_text(FAILING.replace("ERROR", error), encoding="utf-8")
    assert record("off", "--id", "evheatpump/one-v0", "--episodes", 1).exit_code == 0
    sets = tmp_path / "sets"
    before = {path: path.read_bytes() for path in sets.rglob("*") if path.is_file()}
    result = record(f"{module}:Late", "--id", "evheatpump/one-v0", "--episodes", 20)
    assert result.exit_code == code, result.output
    assert len(result.stderr.splitlines()) == 1, result.stderr
    assert {path: path.read_bytes() for path in sets.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["hpcu", "--id", "../outside-v0"], "must read namespace/name-v0"),
        (["hpcu", "--id", "evheatpump/hpcu"], "must read namespace/name-v0"),
        (["autopilot"], "unknown controller `autopilot`"),
        (["hpcu", "--distribution", "nowhere"], "nowhere"),
        (["hpcu", "--info", "weather"], "unknown info `weather`"),
        (["ppo", "--seeds", "one"], "--seeds is `one`"),
    ],
    ids=str,
)
def test_a_mistake_gets_one_line_and_nothing_is_written(
    arguments: list[str], reason: str, record: Recorder, tmp_path: Path
) -> None:
    result = record(*arguments)
    assert result.exit_code == 2
    assert reason in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not (tmp_path / "sets").exists()


def test_the_snippet_of_the_page_on_learning_reads_what_its_command_records(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = (Path(__file__).parents[2] / "docs" / "rl.md").read_text(encoding="utf-8")
    (command,) = re.findall(r"^uv run --extra data hp-gym (record .*)$", page, flags=re.MULTILINE)
    (snippet,) = (
        code for code in re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL) if "minari" in code
    )
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MINARI_DATASETS_PATH", "")
    result = CliRunner().invoke(app, command.replace("--episodes 100", "--episodes 2").split())
    assert result.exit_code == 0, result.output
    read: dict[str, Any] = {}
    exec(compile(snippet, "docs/rl.md", "exec"), read)
    assert read["data"].total_episodes == 2
    drive_again(read["data"])
