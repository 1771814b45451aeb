"""Policy files: equal to the trained model, and refused with a clear line where something is wrong."""

import json
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from safetensors.numpy import load_file, save_file
from sb3_contrib import MaskablePPO, RecurrentPPO
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.vec_env import VecNormalize

from hp_gym import ConfigurationError, _core
from hp_gym.agents import policies
from hp_gym.agents.policies import reference
from hp_gym.agents.policies.checksum import CHECKSUM_KEY, checksum
from hp_gym.agents.policies.from_sb3 import from_sb3
from hp_gym.agents.policies.policy_file import METADATA_KEY
from hp_gym.agents.policies.saved_policy import PolicyEnvironment, SavedPolicy
from hp_gym.envs.sb3 import SB3VecEnv
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

REFERENCE_POLICIES = Path(__file__).parents[2] / "agents" / "reference_policies"
LEVELS: dict[str, Any] = {"control_interval_s": 20}
CONTINUOUS: dict[str, Any] = {"control_interval_s": 20, "continuous": True}


def recorded(environment: dict[str, Any], count: int = 600) -> tuple[NDArray[Any], NDArray[Any] | None]:
    """Observations, and masks where there are any, of trips driven at random."""
    envs = EVHeatPumpVectorEnv(20, **environment)
    envs.action_space.seed(0)
    seen, masks = [envs.reset(seed=0)[0]], []
    for _ in range(count // 20 - 1):
        if not environment.get("continuous"):
            masks.append(envs.action_masks())
        seen.append(envs.step(envs.action_space.sample())[0])
    if environment.get("continuous"):
        return np.concatenate(seen), None
    masks.append(envs.action_masks())
    return np.concatenate(seen), np.concatenate(masks)


def ppo(environment: dict[str, Any], algorithm: Any = PPO, **policy: Any) -> Any:
    envs = SB3VecEnv(8, **environment)
    # A large last layer, so that options differ by more than rounding.
    model = algorithm(
        "MlpPolicy", envs, n_steps=16, batch_size=64, seed=1, policy_kwargs=policy, device="cpu"
    )
    model.learn(128)
    return model


@pytest.fixture(scope="module")
def policy() -> SavedPolicy:
    return from_sb3(ppo(LEVELS), PolicyEnvironment.resolve(**LEVELS), seed=1, configuration="test")


@pytest.fixture
def file(policy: SavedPolicy, tmp_path: Path) -> Path:
    path = tmp_path / "policy.safetensors"
    policies.save(path, policy)
    return path


def reloaded(model: Any, environment: dict[str, Any], folder: Path, **given: Any) -> SavedPolicy:
    policies.save(
        folder / "it.safetensors", from_sb3(model, PolicyEnvironment.resolve(**environment), **given)
    )
    return policies.load(folder / "it.safetensors")


def test_ppo_with_options_decides_as_its_file(tmp_path: Path) -> None:
    observations, masks = recorded(LEVELS)
    model = ppo(LEVELS, net_arch=[32, 16, 8])
    saved = reloaded(model, LEVELS, tmp_path)
    expected = model.predict(observations, deterministic=True)[0]
    np.testing.assert_array_equal(saved.predict(observations), expected)
    np.testing.assert_array_equal(saved.predict(observations, masks), expected)
    assert len(np.unique(expected, axis=0)) > 1
    assert saved.metadata.network.hidden_sizes == (32, 16, 8)


def test_maskable_ppo_decides_as_its_file(tmp_path: Path) -> None:
    observations, masks = recorded(LEVELS)
    assert masks is not None
    model = ppo(LEVELS, MaskablePPO)
    saved = reloaded(model, LEVELS, tmp_path)
    expected = model.predict(observations, deterministic=True, action_masks=masks)[0]
    np.testing.assert_array_equal(saved.predict(observations, masks), expected)
    assert (expected != model.predict(observations, deterministic=True)[0]).any()
    assert saved.needs_masks
    with pytest.raises(policies.PolicyError, match=r"masks have the shape None, but the policy was"):
        saved.predict(observations)


def test_ppo_with_continuous_actions_decides_as_its_file(tmp_path: Path) -> None:
    observations, _ = recorded(CONTINUOUS)
    model = ppo(CONTINUOUS)
    model.policy.action_net.bias.data[:2] = model.policy.action_net.bias.data.new_tensor([-3.0, 3.0])
    saved = reloaded(model, CONTINUOUS, tmp_path)
    expected = model.predict(observations, deterministic=True)[0]
    np.testing.assert_allclose(saved.predict(observations), expected, rtol=0, atol=1e-6)
    assert (expected[:, 0] == -1.0).all()
    assert (expected[:, 1] == 1.0).all()


@pytest.mark.parametrize("algorithm", [SAC, TD3])
def test_off_policy_decides_as_its_file(algorithm: Any, tmp_path: Path) -> None:
    observations, _ = recorded(CONTINUOUS)
    model = algorithm("MlpPolicy", SB3VecEnv(4, **CONTINUOUS), learning_starts=40, seed=1, device="cpu")
    model.learn(100)
    saved = reloaded(model, CONTINUOUS, tmp_path)
    expected = model.predict(observations, deterministic=True)[0]
    np.testing.assert_allclose(saved.predict(observations), expected, rtol=0, atol=1e-6)
    assert saved.metadata.network.activation == "relu"


def test_normalised_observations_are_those_of_the_wrapper(tmp_path: Path) -> None:
    observations, _ = recorded(LEVELS)
    envs = VecNormalize(SB3VecEnv(8, **LEVELS), clip_obs=2.0)
    model = PPO("MlpPolicy", envs, n_steps=16, batch_size=64, seed=1, device="cpu")
    model.learn(1024)
    saved = reloaded(model, LEVELS, tmp_path, normalisation=envs)
    expected = model.predict(envs.normalize_obs(observations), deterministic=True)[0]
    np.testing.assert_array_equal(saved.predict(observations), expected)
    assert saved.normalisation is not None
    np.testing.assert_array_equal(
        saved.normalisation.apply(observations), envs.normalize_obs(observations).astype(np.float32)
    )


def test_a_file_keeps_everything(policy: SavedPolicy, file: Path) -> None:
    again = policies.load(file)
    assert again.metadata == policy.metadata
    assert again.metadata.seed == 1
    assert again.metadata.decisions == 128
    assert again.metadata.configuration == "test"
    for given, kept in zip(policy.layers, again.layers, strict=True):
        np.testing.assert_array_equal(given[0], kept[0])
        np.testing.assert_array_equal(given[1], kept[1])
    envs = EVHeatPumpVectorEnv(3, **again.environment)
    observations, _ = envs.reset(seed=0)
    envs.step(again.predict(observations))


def test_deciding_needs_no_torch(file: Path) -> None:
    code = (
        "import sys, numpy; from hp_gym.agents import policies; policy = policies.load(sys.argv[1]); "
        "policy.predict(numpy.zeros((2, 63), numpy.float32)); assert 'torch' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code, str(file)], check=True)


def test_recurrent_and_other_networks_are_refused() -> None:
    envs = SB3VecEnv(2, **LEVELS)
    environment = PolicyEnvironment.resolve(**LEVELS)
    recurrent = RecurrentPPO("MlpLstmPolicy", envs, n_steps=2, batch_size=4, device="cpu")
    with pytest.raises(policies.PolicyError, match="a recurrent policy cannot be saved"):
        from_sb3(recurrent, environment)
    import torch

    other = PPO("MlpPolicy", envs, policy_kwargs={"activation_fn": torch.nn.ELU}, device="cpu")
    with pytest.raises(policies.PolicyError, match=r"Linear, ELU, .* only Linear with Tanh or ReLU"):
        from_sb3(other, environment)


def test_another_environment_than_the_model_s_is_refused() -> None:
    model = ppo(LEVELS)
    with pytest.raises(policies.PolicyError, match=r"observes \(63,\), but the environment has 64 rows"):
        from_sb3(model, PolicyEnvironment.resolve(observations=("default", "time_left_s")))
    with pytest.raises(policies.PolicyError, match="acts on MultiDiscrete"):
        from_sb3(model, PolicyEnvironment.resolve(continuous=True))


def header(file: Path) -> dict[str, Any]:
    data = file.read_bytes()
    (length,) = struct.unpack("<Q", data[:8])
    told: dict[str, Any] = json.loads(json.loads(data[8 : 8 + length])["__metadata__"][METADATA_KEY])
    return told


def rewrite(
    file: Path,
    change: Callable[[dict[str, Any]], object] = lambda _: None,
    tensors: Callable[[dict[str, Any]], object] = lambda _: None,
) -> None:
    metadata, numbers = header(file), load_file(file)
    change(metadata)
    tensors(numbers)
    text = json.dumps(metadata)
    save_file(numbers, file, {METADATA_KEY: text, CHECKSUM_KEY: checksum(text, numbers)})


def refused(file: Path, reason: str) -> None:
    with pytest.raises(policies.PolicyError, match=reason) as caught:
        policies.load(file)
    assert str(file) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kept", [0, 5, 100, 4000, -1])
def test_a_truncated_file_is_refused(file: Path, kept: int) -> None:
    file.write_bytes(file.read_bytes()[:kept])
    refused(file, "no complete safetensors file")


def test_foreign_files_are_refused(tmp_path: Path) -> None:
    text = tmp_path / "notes.safetensors"
    text.write_text("These are notes, and no policy at all, however long they become.")
    refused(text, "no complete safetensors file")
    other = tmp_path / "other.safetensors"
    save_file({"weights": np.zeros(3)}, other)
    refused(other, "no policy of hp_gym")
    refused(tmp_path / "policy.pt", "ends with .safetensors or .onnx")
    refused(tmp_path / "policy.zip", "can run code")
    with pytest.raises(FileNotFoundError):
        policies.load(tmp_path / "absent.safetensors")


def test_a_policy_sees_rows_within_the_bounds_that_it_was_trained_with(file: Path) -> None:
    policy = policies.load(file)
    own = policy.metadata.environment
    assert own.observation_bounds is not None
    assert own.observation_bounds["compressor_power_w"] == (0.0, 8000.0)
    older = own.model_copy(update={"observation_bounds": None})
    assert older.keywords()["observation_bounds"]["compressor_power_w"] == (0.0, 5000.0)
    envs = EVHeatPumpVectorEnv(1, scenario="jeffs2019/case1-1", **older.keywords())
    envs.reset(seed=0)
    for _ in range(60):
        observations = envs.step(envs.rule_based_actions())[0]
    place = own.observations.index("compressor_power_w")
    power_w = envs.signals(0)["compressor_power_w"]
    assert power_w > 100.0
    assert observations[0, place] == pytest.approx(power_w / 2500.0 - 1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda told: told.update(format_version=3), "`format_version` is 3, but should be 1 or 2"),
        (lambda told: told.pop("algorithm"), "`algorithm` is missing"),
        (lambda told: told.update(extra=1), "`extra` is unknown"),
        (lambda told: told["network"].update(activation="sin"), "`network.activation` is 'sin'"),
        (lambda told: told["environment"].update(control_interval_s=0), "control_interval_s` is 0"),
        (lambda told: told["environment"]["actions"].__setitem__(0, "wings"), "unknown action `wings`"),
        (
            lambda told: told["environment"]["observations"].__setitem__(0, "mood"),
            "unknown observation `mood`",
        ),
        (lambda told: told["environment"]["observations"].append("time_left_s"), "layers.0.weight"),
        (lambda told: told["environment"]["observation_bounds"].pop("soc"), "`observations` differ in `soc`"),
        (lambda told: told["option_counts"].__setitem__(0, 4), "in this version of hp_gym"),
        (lambda told: told.update(output="clip"), "`output` clip does not fit"),
        (lambda told: told["network"].update(hidden_sizes=[64]), r"layers\.1\.bias` is float32\[64\]"),
    ],
)
def test_metadata_that_do_not_fit_are_refused(file: Path, change: Any, reason: str) -> None:
    rewrite(file, change)
    refused(file, reason)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda numbers: numbers.pop("layers.2.bias"), r"`layers\.2\.bias` is missing"),
        (lambda numbers: numbers.update(more=np.zeros(1)), "`more` is unknown"),
        (lambda numbers: numbers.update({"layers.0.bias": np.zeros(3, np.float32)}), r"float32\[3\]"),
        (lambda numbers: numbers.update({"layers.0.bias": np.zeros(64)}), r"float64\[64\]"),
        (lambda numbers: numbers["layers.0.bias"].__setitem__(0, np.nan), "finite numbers"),
        (
            lambda numbers: numbers.update({"observation.mean": np.zeros(63)}),
            r"`observation\.clip` is missing",
        ),
    ],
)
def test_tensors_that_do_not_fit_are_refused(file: Path, change: Any, reason: str) -> None:
    rewrite(file, tensors=change)
    refused(file, reason)


FEW: dict[str, Any] = {
    "actions": ["compressor_power", "battery", "ptc"],
    "observations": ["cabin_temperature_degc", "soc", "previous_battery"],
}


def test_a_policy_fits_every_car_that_has_its_rows() -> None:
    policy = from_sb3(ppo(FEW), PolicyEnvironment.resolve(**FEW))
    for vehicle in ("jeffs2019", "jeffs2019-no-thermal-battery", "jeffs2019-three-loops"):
        envs = EVHeatPumpVectorEnv(2, vehicle=vehicle, scenario="ours/commute-minus5", **policy.environment)
        assert envs.option_names["battery"] == ("isolated", "htc", "chiller")
        observations, _ = envs.reset(seed=0)
        for _ in range(20):
            observations, *_ = envs.step(policy.predict(observations))
    whole = from_sb3(ppo(LEVELS), PolicyEnvironment.resolve(**LEVELS))
    with pytest.raises(
        ConfigurationError, match=r"unknown action `thermal_battery`; available: .*\(nearest: "
    ):
        EVHeatPumpVectorEnv(2, vehicle="jeffs2019-no-thermal-battery", **whole.environment)


def test_a_policy_of_another_car_keeps_the_names_of_its_options(tmp_path: Path) -> None:
    environment: dict[str, Any] = {"vehicle": "jeffs2019-direct", "actions": ["cabin_condenser", "ptc"]}
    saved = reloaded(ppo(environment), environment, tmp_path)
    options = {"cabin_condenser": ["closed", "open"], "ptc": ["off", "allowed"]}
    assert saved.environment["action_options"] == options
    EVHeatPumpVectorEnv(2, vehicle="jeffs2019-direct", **saved.environment).reset(seed=0)
    with pytest.raises(ConfigurationError, match="unknown action `cabin_condenser`"):
        EVHeatPumpVectorEnv(2, **saved.environment)


def test_observations_of_another_shape_are_refused(policy: SavedPolicy) -> None:
    with pytest.raises(policies.PolicyError, match=r"the shape \(2, 3\), but the policy takes \(n, 63\)"):
        policy.predict(np.zeros((2, 3), np.float32))


def test_a_failed_write_leaves_the_old_file(policy: SavedPolicy, file: Path, monkeypatch: Any) -> None:
    before = file.read_bytes()

    def full(*_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="No space left"):
        policies.save(file, policy)
    assert file.read_bytes() == before
    assert list(file.parent.iterdir()) == [file]


def test_reference_policies_are_found_by_name(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files = ["ablations/ppo-seed0", "ppo-preview-seed0", "ppo-seed10", "ppo-seed2"]
    monkeypatch.setattr(_core, "reference_policy_names", lambda: files)
    monkeypatch.setattr(_core, "reference_policy", lambda _: file.read_bytes())
    assert list(reference.policies("ppo")) == ["ppo-seed2", "ppo-seed10"]
    assert reference.names() == ["ppo", "ppo-preview"]
    assert list(reference.ablations()) == ["ppo-seed0"]
    with pytest.raises(policies.PolicyError, match="no reference policy `sac`; available: ppo, ppo-preview"):
        reference.policies("sac")


def test_compiled_in_are_the_reference_policies_of_the_checkout() -> None:
    files = {
        path.relative_to(REFERENCE_POLICIES).with_suffix("").as_posix(): path.read_bytes()
        for path in REFERENCE_POLICIES.rglob("*.safetensors")
    }
    assert _core.reference_policy_names() == sorted(files)
    assert {name: _core.reference_policy(name) for name in files} == files
    with pytest.raises(ConfigurationError, match="unknown reference policy `sac-seed0`; available: abl"):
        _core.reference_policy("sac-seed0")
