"""`hp-gym export`: ONNX that is proved equal, zip files only on request."""

import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import onnx
import onnxruntime
import pytest
from sb3_contrib import MaskablePPO
from stable_baselines3 import PPO, SAC
from typer.testing import CliRunner, Result

from hp_gym.agents import policies
from hp_gym.agents.policies.equality import compare
from hp_gym.agents.policies.from_sb3 import from_sb3
from hp_gym.agents.policies.onnx_file import to_model
from hp_gym.agents.policies.saved_policy import Normalisation, PolicyEnvironment, SavedPolicy
from hp_gym.cli.app import app
from hp_gym.envs.sb3 import SB3VecEnv

LEVELS: dict[str, Any] = {"control_interval_s": 20}


def untrained(algorithm: Any = PPO, environment: dict[str, Any] | None = None) -> Any:
    more = {} if algorithm is SAC else {"n_steps": 4, "batch_size": 8}
    envs = SB3VecEnv(2, **(environment or LEVELS))
    return algorithm("MlpPolicy", envs, seed=3, device="cpu", policy_kwargs={"net_arch": [16]}, **more)


def converted(algorithm: Any = PPO, environment: dict[str, Any] | None = None) -> SavedPolicy:
    settings = environment or LEVELS
    return from_sb3(untrained(algorithm, settings), PolicyEnvironment.resolve(**settings))


def normalised(policy: SavedPolicy) -> SavedPolicy:
    rows = len(policy.metadata.environment.observations)
    generator = np.random.default_rng(0)
    statistics = Normalisation(generator.normal(size=rows), generator.uniform(0.0, 0.2, rows), 1.5, 1e-8)
    return SavedPolicy(policy.metadata, policy.layers, statistics)


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["export", *(str(argument) for argument in arguments)])


@pytest.mark.parametrize(
    "policy",
    [
        pytest.param(converted, id="PPO with options"),
        pytest.param(lambda: normalised(converted()), id="PPO, observations normalised"),
        pytest.param(lambda: converted(MaskablePPO), id="MaskablePPO"),
        pytest.param(lambda: converted(PPO, LEVELS | {"continuous": True}), id="PPO with values"),
        pytest.param(lambda: converted(SAC, LEVELS | {"continuous": True}), id="SAC"),
    ],
)
def test_an_exported_policy_decides_as_before_and_can_be_loaded_again(policy: Any, tmp_path: Path) -> None:
    source, target = tmp_path / "policy.safetensors", tmp_path / "policy.onnx"
    original = policy()
    policies.save(source, original)
    result = run(source, "--out", target, "--json")
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert told["observations"] >= 10_000
    assert told["largest_output_difference"] < 1e-5
    again = policies.load(target)
    assert again.metadata == original.metadata
    observations = np.random.default_rng(1).uniform(-1, 1, (50, 63)).astype(np.float32)
    np.testing.assert_array_equal(again.outputs(observations), original.outputs(observations))


def test_a_graph_that_decides_otherwise_is_not_written(tmp_path: Path, monkeypatch: Any) -> None:
    policy = converted()
    policies.save(tmp_path / "policy.safetensors", policy)
    weight, bias = policy.layers[0]
    other = SavedPolicy(policy.metadata, ((weight, bias + np.float32(0.01)), *policy.layers[1:]))
    monkeypatch.setattr("hp_gym.agents.policies.onnx_file.to_model", lambda _: to_model(other))
    (tmp_path / "policy.onnx").write_text("an earlier result")
    result = run(tmp_path / "policy.safetensors", "--out", tmp_path / "policy.onnx")
    assert result.exit_code == 2
    assert "the exported network differs by" in result.stderr
    assert (tmp_path / "policy.onnx").read_text() == "an earlier result"


def test_options_swapped_in_the_graph_are_noticed() -> None:
    policy = converted()
    graph = to_model(policy)
    concatenation = next(node for node in graph.graph.node if node.op_type == "Concat")
    first, *others = list(concatenation.input)
    del concatenation.input[:]
    concatenation.input.extend([*others, first])
    with pytest.raises(policies.PolicyError, match="exported actions differ"):
        compare(graph, policy)


def test_the_file_needs_no_python_of_ours(tmp_path: Path) -> None:
    policy = normalised(converted())
    policies.save(tmp_path / "policy.safetensors", policy)
    assert run(tmp_path / "policy.safetensors", "--out", tmp_path / "policy.onnx").exit_code == 0
    session = onnxruntime.InferenceSession(tmp_path / "policy.onnx")
    observations = np.zeros((3, 63), np.float32)
    actions, _ = session.run(None, {"observations": observations})
    np.testing.assert_array_equal(actions, policy.predict(observations))
    assert actions.dtype == np.int64


def test_truncated_foreign_and_changed_onnx_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "policy.onnx"
    model = to_model(converted())
    path.write_bytes(model.SerializeToString()[:-100])
    with pytest.raises(policies.PolicyError, match="no complete ONNX file"):
        policies.load(path)
    path.write_bytes(onnx.ModelProto().SerializeToString())
    with pytest.raises(policies.PolicyError, match="no ONNX file of a policy of hp_gym"):
        policies.load(path)
    model.graph.node[1].op_type = "Relu"
    path.write_bytes(model.SerializeToString())
    with pytest.raises(policies.PolicyError, match="not the one that its metadata describe"):
        policies.load(path)


def test_a_zip_file_is_loaded_on_request_only(tmp_path: Path) -> None:
    untrained().save(tmp_path / "model.zip")
    result = run(tmp_path / "model.zip", "--out", tmp_path / "policy.onnx", "--control-interval-s", 20)
    assert result.exit_code == 2
    assert "can run code" in result.stderr
    assert not (tmp_path / "policy.onnx").exists()
    result = run(
        tmp_path / "model.zip", "--out", tmp_path / "policy.onnx", "--control-interval-s", 20, "--allow-code"
    )
    assert result.exit_code == 0, result.output
    assert "Warning: loading a zip file" in result.stderr
    assert policies.load(tmp_path / "policy.onnx").environment["control_interval_s"] == 20


def test_a_zip_file_may_name_a_schedule_of_a_module_that_is_gone(tmp_path: Path, monkeypatch: Any) -> None:
    gone = ModuleType("gone")
    exec("def rate(remaining):\n    return 1e-4 * remaining", gone.__dict__)
    path = tmp_path / "model.zip"
    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "gone", gone)
        model = untrained()
        model.learning_rate = gone.rate
        model.save(path)
    result = run(path, "--out", tmp_path / "policy.onnx", "--control-interval-s", 20, "--allow-code")
    assert result.exit_code == 0, result.output


def test_zip_files_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.zip"
    untrained().save(path)
    for arguments, reason in (
        (["--observations", "default", "--observations", "time_left_s"], "but the environment has 64 rows"),
        (["--continuous"], "the model acts on MultiDiscrete"),
        (["--actions", "wings"], "unknown action `wings`"),
    ):
        result = run(path, "--out", tmp_path / "policy.onnx", "--allow-code", *arguments)
        assert result.exit_code == 2
        assert reason in result.stderr
    path.write_bytes(path.read_bytes()[:500])
    result = run(path, "--out", tmp_path / "policy.onnx", "--allow-code")
    assert result.exit_code == 2
    assert "no complete zip file of stable-baselines3" in result.stderr


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    policies.save(tmp_path / "policy.safetensors", converted())
    (tmp_path / "file").touch()
    result = run(tmp_path / "policy.safetensors", "--out", tmp_path / "file" / "policy.onnx")
    assert result.exit_code == 2
    assert "Not a directory" in result.stderr
    assert len(result.stderr.splitlines()) == 1
