"""Files of all kinds that are damaged, foreign, too large or too deep: one short line that names the file."""

import json
import math
import os
import subprocess
import sys
import tomllib
import warnings
from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors.numpy import load_file, save_file
from typer.testing import CliRunner

from hp_gym import _core, toml_files
from hp_gym.agents import policies
from hp_gym.agents.controllers import ControllerError, resolve
from hp_gym.agents.policies import PolicyError, SavedPolicy, onnx_file, reference
from hp_gym.agents.policies.checksum import CHECKSUM_KEY
from hp_gym.agents.policies.policy_file import METADATA_KEY, metadata_text, parse, tensors_of
from hp_gym.agents.training import checkpoint, configuration
from hp_gym.agents.training.checkpoint import CheckpointError
from hp_gym.agents.training.run_folder import RunFolder
from hp_gym.cli.app import app
from hp_gym.files import read_bytes
from hp_gym.messages import LONGEST_MESSAGE, FileError, OneLineError, UncheckedFileWarning
from hp_gym.studies.benchmark import grid
from hp_gym.studies.calibration import problem

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
from fuzz_damage import a_checkpoint

KINDS = ("training configuration", "benchmark", "calibration")
LOADERS: dict[str, Callable[[str], object]] = {
    "training configuration": configuration.load,
    "benchmark": grid.load,
    "calibration": problem.load,
}
WORDS = {
    "training configuration": "train",
    "benchmark": "benchmark --grid",
    "calibration": "calibrate --config",
}


SHIPPED = {"training configuration": "ppo", "benchmark": "heldout-v1", "calibration": "jeffs2019"}


def attempt(read: Callable[[], Any]) -> Any:
    """What a reader gives, or None if it refuses in a short line of this package."""
    try:
        return read()
    except OneLineError as error:
        line = str(error)
    assert len(line) <= LONGEST_MESSAGE
    assert "\n" not in line
    return None


def told(load: Callable[[str], object], path: Path) -> str:
    with pytest.raises(ValueError, match=path.name) as caught:
        load(str(path))
    line = str(caught.value)
    assert isinstance(caught.value, OneLineError)
    assert len(line) <= LONGEST_MESSAGE
    assert "\n" not in line
    return line


@pytest.fixture(scope="module")
def policy() -> SavedPolicy:
    return next(iter(reference.policies().values()))


@pytest.fixture(scope="module")
def saved(policy: SavedPolicy, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("policy") / "saved.safetensors"
    policies.save(path, policy)
    return path.read_bytes()


@pytest.fixture(scope="module")
def sealed(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A checkpoint as a training writes it."""
    return a_checkpoint(tmp_path_factory.mktemp("checkpoint"))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "text",
    [
        pytest.param("x = " + "[" * 10_000, id="10,000 lists"),
        pytest.param("x = " + "{a = " * 10_000, id="10,000 tables"),
        pytest.param("a" + ".a" * 10_000 + " = 1", id="10,000 dots"),
        pytest.param("[a" + ".a" * 10_000 + "]", id="10,000 sections"),
        pytest.param("a" + ".a" * 400_000 + " = 1", id="400,000 dots, once minutes"),
        pytest.param("x = " + "9" * 5_000, id="5,000 digits"),
        pytest.param('x = "' + "long " * 1_000_000 + '"', id="5 MB"),
        pytest.param("base = 3", id="base is a number"),
        pytest.param("k" * 5_000 + " = 1", id="long key"),
        pytest.param("= nothing", id="no TOML"),
    ],
)
def test_configurations_out_of_bounds_get_one_line(kind: str, text: str, tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    path.write_text(text, encoding="utf-8")
    told(LOADERS[kind], path)


@pytest.mark.parametrize("kind", KINDS)
def test_a_message_of_a_command_names_the_file_and_is_short(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    path.write_text("x = " + "[" * 10_000, encoding="utf-8")
    result = CliRunner().invoke(app, [*WORDS[kind].split(), str(path)])
    assert result.exit_code == 2
    assert str(path) in result.stderr
    assert len(result.stderr) <= LONGEST_MESSAGE + 20


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes")
def test_a_pipe_or_a_device_is_no_configuration(kind: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    assert "is no regular file" in told(LOADERS[kind], tmp_path / "pipe.toml")
    (tmp_path / "zero.toml").symlink_to("/dev/zero")
    assert "is no regular file" in told(LOADERS[kind], tmp_path / "zero.toml")
    (tmp_path / "folder.toml").mkdir()
    assert "is no regular file" in told(LOADERS[kind], tmp_path / "folder.toml")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes")
def test_a_pipe_or_a_device_is_no_policy_and_no_checkpoint(tmp_path: Path) -> None:
    for name in ("p.safetensors", "p.onnx"):
        os.mkfifo(tmp_path / name)
        assert "is no regular file" in told(policies.load, tmp_path / name)
    (tmp_path / "1.pt").symlink_to("/dev/zero")
    with pytest.raises(FileError, match="is no regular file"):
        checkpoint.read(tmp_path / "1.pt")


def test_a_file_may_have_the_largest_size_and_not_a_byte_more(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    assert read_bytes(path, 5) == b"12345"
    with pytest.raises(FileError, match="has 5 bytes, but may have at most 4"):
        read_bytes(path, 4)


@pytest.mark.parametrize("kind", KINDS)
def test_a_byte_order_mark_does_not_matter(kind: str, tmp_path: Path) -> None:
    name = _core.names(kind)[0]
    path = tmp_path / "file.toml"
    path.write_text("\ufeff" + _core.config_text(kind, name), encoding="utf-8")
    assert toml_files.load(kind, str(path)) == toml_files.load(kind, name)


@pytest.mark.parametrize("kind", KINDS)
def test_files_that_are_their_own_base_end(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    path.write_text(f"base = {json.dumps(str(path))}", encoding="utf-8")
    with pytest.raises(FileError, match="too long or closed"):
        list(toml_files.chain(kind, str(path)))


def test_a_change_with_10_000_parts_is_refused() -> None:
    for change in ("a" + ".a" * 10_000 + "=1", "network=" + "[" * 10_000):
        with pytest.raises(configuration.TrainingConfigurationError) as caught:
            configuration.load("ppo", [change])
        assert len(str(caught.value)) <= LONGEST_MESSAGE


def leaves(value: Any, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    if isinstance(value, dict):
        return [place, *(leaf for key, inner in value.items() for leaf in leaves(inner, (*place, key)))]
    if isinstance(value, list):
        return [place, *(leaf for i, inner in enumerate(value[:2]) for leaf in leaves(inner, (*place, i)))]
    return [place]


STRANGE = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=5)
    | st.just(10**400)
    # Copies, as one may be put into another.
    | st.sampled_from([[], {}, [[]], {"deep": {"unknown": 1}}, [{}], "vehicle.", "x" * 10_000]).map(deepcopy)
)


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=150)
@given(data=st.data())
def test_any_value_of_another_kind_gets_an_error_of_the_package(kind: str, data: st.DataObject) -> None:
    tables = tomllib.loads(_core.config_text(kind, SHIPPED[kind]))
    for _ in range(data.draw(st.integers(1, 3))):
        *steps, last = data.draw(st.sampled_from([leaf for leaf in leaves(tables) if leaf]))
        place: Any = tables
        try:
            for step in steps:
                place = place[step]
            place[last] = data.draw(STRANGE)
        except (KeyError, IndexError, TypeError):
            continue
    parsers: dict[str, Callable[[Any], object]] = {
        "calibration": problem.parse,
        "benchmark": lambda given: grid.parse("changed", given),
        "training configuration": lambda given: configuration.parse(given, "changed"),
    }
    attempt(lambda: parsers[kind](tables))


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"calibration": 3}, "`calibration`"),
        ({"target": 3}, "`target`"),
        ({"target": [3]}, r"`target\.0`"),
        ({"target": [{"scenario": "a", "energy_kwh": "much"}]}, r"`target\.0\.energy_kwh`"),
        ({"target": [{"scenario": "a", "energy_kwh": math.inf}]}, r"`target\.0\.energy_kwh`"),
        (
            {"parameter": [{"key": "a", "low": [], "high": 2, "prior": 1, "source": ""}]},
            r"`parameter\.0\.low`",
        ),
        (
            {"parameter": [{"keys": 3, "low": 1, "high": 2, "prior": 1, "source": ""}]},
            r"`parameter\.0\.keys`",
        ),
        ({"soft_claim": [{"id": "one", "weight": 1}]}, r"`soft_claim\.0\.id`"),
        ({"soft_claim": [{"id": 1, "weight": 1, "wait": 1}]}, r"`soft_claim\.0\.wait` is unknown"),
    ],
)
def test_calibrations_of_the_wrong_kind_say_where(change: dict[str, object], place: str) -> None:
    tables = tomllib.loads(_core.config_text("calibration", "jeffs2019")) | change
    with pytest.raises(problem.CalibrationError, match=place):
        problem.parse(tables)


def same(one: SavedPolicy, other: SavedPolicy) -> bool:
    first, second = tensors_of(one), tensors_of(other)
    return metadata_text(one) == metadata_text(other) and all(
        first[name].tobytes() == second[name].tobytes() for name in first
    )


def damage(data: bytes, changes: list[tuple[int, int]], cut: int) -> bytes:
    damaged = bytearray(data)
    for place, value in changes:
        damaged[place % len(damaged)] ^= value
    return bytes(damaged[: len(damaged) - cut])


DAMAGES = st.lists(st.tuples(st.integers(0, 2**31), st.integers(1, 255)), max_size=4)
CUTS = st.just(0) | st.integers(0, 300)


@settings(max_examples=300)
@given(changes=DAMAGES, cut=CUTS)
def test_a_damaged_policy_is_refused_or_the_same(
    saved: bytes, policy: SavedPolicy, changes: list[tuple[int, int]], cut: int
) -> None:
    read = attempt(lambda: parse("damaged", damage(saved, changes, cut)))
    assert read is None or same(read, policy)


@settings(max_examples=200)
@given(place=st.integers(0, 2**31), bit=st.integers(0, 7))
def test_a_bit_flipped_in_a_policy_s_numbers_is_refused(saved: bytes, place: int, bit: int) -> None:
    header = 8 + int.from_bytes(saved[:8], "little")
    changes = [(header + place % (len(saved) - header), 1 << bit)]
    with pytest.raises(PolicyError, match=r"checksum|finite"):
        parse("damaged", damage(saved, changes, 0))


@settings(max_examples=100)
@given(changes=DAMAGES, cut=CUTS)
def test_a_damaged_onnx_file_is_refused_or_the_same(
    policy: SavedPolicy, changes: list[tuple[int, int]], cut: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.onnx"
    path.write_bytes(damage(onnx_file.to_model(policy).SerializeToString(), changes, cut))
    read = attempt(lambda: policies.load(path))
    assert read is None or same(read, policy)


def test_an_onnx_file_with_a_name_that_is_no_text_is_refused(policy: SavedPolicy, tmp_path: Path) -> None:
    path = tmp_path / "policy.onnx"
    data = onnx_file.to_model(policy).SerializeToString()
    path.write_bytes(data.replace(b"layers.0.bias", b"layers.\xff.bias"))
    told(policies.load, path)
    path.write_bytes(data.replace(b"MaskablePPO", b"Maskabl\xffPPO").replace(b'"PPO"', b'"P\xffO"'))
    told(policies.load, path)


def test_numbers_of_an_onnx_file_in_another_file_are_refused(policy: SavedPolicy, tmp_path: Path) -> None:
    model = onnx_file.to_model(policy)
    path = tmp_path / "policy.onnx"
    onnx.save_model(model, path, save_as_external_data=True, location="numbers", size_threshold=0)
    assert (tmp_path / "numbers").exists()
    assert "are in another file" in told(policies.load, path)


def test_an_older_policy_is_checked_value_by_value_and_noted(policy: SavedPolicy, tmp_path: Path) -> None:
    path = tmp_path / "older.safetensors"
    text = policy.metadata.model_copy(update={"format_version": 1}).model_dump_json()
    save_file(tensors_of(policy), path, {METADATA_KEY: text})
    with pytest.warns(UncheckedFileWarning, match=r"older\.safetensors: without checksum"):
        assert same(policies.load(path), policy)
    numbers = load_file(path)
    numbers["layers.0.bias"][0] = np.inf
    save_file(numbers, path, {METADATA_KEY: text})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UncheckedFileWarning)
        assert "finite numbers" in told(policies.load, path)
    save_file(tensors_of(policy), path, {METADATA_KEY: metadata_text(policy)})
    assert "its checksum is missing" in told(policies.load, path)


def test_a_command_notes_an_older_policy_in_one_line(policy: SavedPolicy, tmp_path: Path) -> None:
    path = tmp_path / "older.safetensors"
    text = policy.metadata.model_copy(update={"format_version": 1}).model_dump_json()
    save_file(tensors_of(policy), path, {METADATA_KEY: text})
    words = ["export", str(path), "--out", str(tmp_path / "newer.safetensors")]
    code = "from hp_gym.cli.app import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, *words], check=False, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == f"hp-gym: note: {path}: without checksum, only its values are checked\n"
    assert same(policies.load(tmp_path / "newer.safetensors"), policy)


def test_every_reference_policy_has_a_checksum() -> None:
    for name in _core.reference_policy_names():
        assert CHECKSUM_KEY.encode() in _core.reference_policy(name)


def equal(one: Any, other: Any) -> bool:
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(equal(value, other[key]) for key, value in one.items())
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(equal, one, other))
    return torch.equal(one, other) if isinstance(one, torch.Tensor) else bool(one == other)


@settings(max_examples=200)
@given(changes=DAMAGES, cut=CUTS)
def test_a_damaged_checkpoint_is_refused_or_the_same(
    sealed: bytes, changes: list[tuple[int, int]], cut: int, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "000000000001.pt"
    path.write_bytes(sealed)
    whole = checkpoint.read(path)
    path.write_bytes(damage(sealed, changes, cut))
    read = attempt(lambda: checkpoint.read(path))
    assert read is None or equal(read, whole)


def test_a_checkpoint_without_its_checksum_counts_as_damaged(sealed: bytes, tmp_path: Path) -> None:
    folder = RunFolder(tmp_path)
    (tmp_path / "checkpoints").mkdir()
    folder.checkpoint_path(1).write_bytes(sealed)
    folder.checkpoint_path(2).write_bytes(sealed[:-78])
    folder.checkpoint_path(3).write_bytes(sealed[:-1] + b"0" if sealed[-1:] != b"0" else sealed[:-1] + b"1")
    found = folder.latest_checkpoint()
    assert found is not None
    assert found[0] == folder.checkpoint_path(1)


def test_an_older_checkpoint_is_checked_value_by_value_and_noted(sealed: bytes, tmp_path: Path) -> None:
    path = tmp_path / "000000000001.pt"
    path.write_bytes(sealed)
    content = checkpoint.read(path)
    content |= {"format_version": 1, "notes": json.dumps(content["notes"])}
    torch.save(content, path)
    with pytest.warns(UncheckedFileWarning, match="without checksum"):
        checkpoint.read(path)
    content["environments"]["episode_returns"][0] = torch.nan
    torch.save(content, path)
    with pytest.raises(CheckpointError, match="`episode_returns` holds numbers that are not finite"):
        checkpoint.read(path)


CLASSES = {
    "at_import": ("x = 1\n1 / 0\n", "ZeroDivisionError: division by zero", 2),
    "no_python": ("class (:\n", "SyntaxError", 1),
    "leaves": ("import sys\nsys.exit(3)\n", "SystemExit: 3", 2),
    "cannot_be_made": (
        "class C:\n    def __init__(self):\n        raise KeyError('why')\n",
        "KeyError: 'why'",
        3,
    ),
    "bad_property": (
        "class C:\n    @property\n    def predict(self):\n        raise OSError('no')\n",
        "OSError: no",
        4,
    ),
}


@pytest.mark.parametrize("name", CLASSES)
def test_a_user_s_module_that_raises_gets_one_line_with_its_place(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text, reason, line = CLASSES[name]
    (tmp_path / f"edges_{name}.py").write_text(text)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ControllerError) as caught:
        resolve(f"edges_{name}:C")
    assert reason in str(caught.value)
    assert f"edges_{name}.py, line {line})" in str(caught.value)
    assert "\n" not in str(caught.value)
