"""`hp-gym train`: runs that can be repeated, killed and continued, and errors in one line."""

import csv
import json
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from safetensors.numpy import load_file
from typer.testing import CliRunner, Result

from hp_gym import _core
from hp_gym.agents import policies
from hp_gym.agents.training import configuration, train
from hp_gym.agents.training.checkpoint import CheckpointError
from hp_gym.agents.training.run_folder import RunFolder, RunFolderError
from hp_gym.cli.app import app

pytestmark = pytest.mark.training

SMALL = """
algorithm = "ppo"
total_decisions = 1536
checkpoint_interval_decisions = 512
torch_threads = 1
environments = { number = 8, threads = 1 }
environment = { control_interval_s = 60 }
learning_rate = { start = 1e-2, end = 1e-3, schedule = "cosine" }
network = { hidden_sizes = [8, 8] }
validation = { interval_decisions = 512, trips = 4 }

[hyperparameters]
n_steps = 32
batch_size = 128
n_epochs = 2
gamma = 0.9
ent_coef = 0.01
ent_coef_end = 0.0
"""

NORMALISED = "normalisation={observations = true, rewards = true, reward_scale = 0.5}"
SAC = [
    "algorithm=sac",
    "environment.continuous=true",
    "hyperparameters={buffer_size = 1000, learning_starts = 64, batch_size = 32, gamma = 0.9}",
]
CONSTRAINED = "comfort_constraint={interval_decisions = 300, ambient_degc = [-10, 20], trips = 4}"
CONVEX = CONSTRAINED.replace("trips = 4", "trips = 4, convex = true, start = 0.5")
RECURRENT = ["algorithm=recurrent-ppo", "hyperparameters.lstm_hidden_size=8"]


COMMAND = [sys.executable, "-c", "from hp_gym.cli.app import main; main()", "train"]


@pytest.fixture
def config(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["train", *(str(argument) for argument in arguments)])


def changes(given: list[str]) -> list[str]:
    return [part for change in given for part in ("--set", change)]


def fails(result: Result, reason: str) -> None:
    assert result.exit_code == 2, result.output
    assert reason in result.stderr
    assert len(result.stderr.splitlines()) == 1


def history(folder: Path) -> list[dict[str, str]]:
    with (folder / "validation.csv").open(newline="") as file:
        return [{k: v for k, v in row.items() if k != "wall_s"} for row in csv.DictReader(file)]


def assert_same_policies(one: Path, other: Path) -> None:
    for name in ("best", "final"):
        first, second = load_file(one / f"{name}.safetensors"), load_file(other / f"{name}.safetensors")
        assert first.keys() == second.keys()
        for key, value in first.items():
            np.testing.assert_array_equal(value, second[key], err_msg=f"{name} {key}")


@pytest.mark.parametrize("name", _core.names("training configuration"))
def test_every_shipped_configuration_is_right(name: str) -> None:
    loaded = configuration.load(name)
    assert configuration.parse(tomllib.loads(configuration.to_toml(loaded)), name) == loaded


def test_a_run_leaves_what_is_needed_to_repeat_it(config: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    result = run(config, "--seed", 3, "--out", out, "--json")
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert told["decisions"] == 1536
    assert told["plant_seconds_per_s"] == pytest.approx(60 * told["decisions_per_s"])
    status = json.loads((out / "status.json").read_text())
    assert status["state"] == "finished"
    record = json.loads((out / "run.json").read_text())
    assert record["seed"] == 3
    assert set(record["starts"][0]) == {"time", "command", "versions", "git", "hardware"}
    assert configuration.read(out / "config.toml") == configuration.load(str(config))
    rows = history(out)
    assert [row["decisions"] for row in rows] == ["512", "1024", "1536"]
    assert len({row["hpcu_score"] for row in rows}) == 1
    assert list((out / "tensorboard").glob("events.*"))
    best = policies.load(out / "best.safetensors")
    assert best.metadata.seed == 3
    assert best.metadata.configuration == "small"
    assert str(best.metadata.decisions) == max(rows, key=lambda row: float(row["score"]))["decisions"]
    assert policies.load(out / "final.safetensors").metadata.decisions == 1536

    again = tmp_path / "again"
    assert run(out / "config.toml", "--seed", 3, "--out", again).exit_code == 0
    assert history(again) == rows
    assert_same_policies(out, again)

    other = tmp_path / "other"
    assert run(config, "--seed", 4, "--out", other).exit_code == 0
    assert history(other) != rows


class _Killed(BaseException):
    """What a killed process would not catch either."""


@pytest.mark.parametrize(
    "given",
    [
        pytest.param([], id="ppo"),
        pytest.param(["algorithm=maskable-ppo"], id="maskable-ppo"),
        pytest.param([NORMALISED], id="normalised"),
        pytest.param(["normalisation.typical_cost=[[-20, 60], [20, 3], [40, 20]]"], id="typical cost"),
        pytest.param([CONSTRAINED, NORMALISED], id="constrained"),
        pytest.param([CONVEX], id="constrained and convex"),
        pytest.param([*SAC, NORMALISED], id="sac"),
        pytest.param(RECURRENT, id="recurrent-ppo"),
    ],
)
def test_a_resumed_run_equals_an_uninterrupted_one(
    given: list[str], config: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    training = configuration.load(str(config), given)
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    train.start(training, "small", 1, whole)
    from hp_gym.agents.training.watch import Watch

    original = Watch._on_step

    def killed(self: Any) -> bool:
        if self.model.num_timesteps > 1200:
            raise _Killed
        return original(self)

    with monkeypatch.context() as patch:
        patch.setattr(Watch, "_on_step", killed)
        with pytest.raises(_Killed):
            train.start(training, "small", 1, cut)
    torch.rand(3)
    np.random.random(3)  # noqa: NPY002
    outcome = train.resume(cut)
    assert outcome.decisions == 1536
    assert history(cut) == history(whole)
    if given is not RECURRENT:
        assert_same_policies(whole, cut)
    starts = json.loads((cut / "run.json").read_text())["starts"]
    assert len(starts) == 2


def test_a_process_killed_at_any_moment_is_continued(config: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    more = [
        "--decisions",
        "6000",
        *changes(["checkpoint_interval_decisions=256", "validation.interval_decisions=3000"]),
    ]
    process = subprocess.Popen(
        [*COMMAND, str(config), "--out", str(out), *more], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    deadline = time.monotonic() + 120
    while not list((out / "checkpoints").glob("[0-9]*.pt")):
        assert process.poll() is None, process.communicate()[1]
        assert time.monotonic() < deadline
        time.sleep(0.01)
    process.kill()
    assert process.wait() == -signal.SIGKILL
    assert process.stderr is not None
    process.stderr.close()
    assert json.loads((out / "status.json").read_text())["state"] == "running"
    made = max(int(path.stem) for path in (out / "checkpoints").glob("[0-9]*.pt"))
    assert 256 <= made < 6000
    result = run("--resume", out)
    assert result.exit_code == 0, result.output
    assert f"Going on from {made:,} decisions" in result.stderr
    assert json.loads((out / "status.json").read_text())["decisions"] >= 6000
    fails(run("--resume", out), "the run has finished")


def test_a_run_that_is_stopped_tells_how_to_go_on(
    config: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(self: Any) -> bool:
        if self.model.num_timesteps > 600:
            raise KeyboardInterrupt
        return True

    out = tmp_path / "run"
    with monkeypatch.context() as patch:
        patch.setattr("hp_gym.agents.training.watch.Watch._on_step", stopped)
        result = run(config, "--out", out)
    assert result.exit_code == 130
    assert f"hp-gym train --resume {out}" in result.stderr
    assert json.loads((out / "status.json").read_text())["state"] == "interrupted"
    assert run("--resume", out).exit_code == 0


def test_the_checkpoint_before_a_damaged_one_is_used(config: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    assert run(config, "--out", out).exit_code == 0
    (out / "status.json").unlink()
    folder = RunFolder(out)
    first, second = folder.checkpoint_path(512), folder.checkpoint_path(1024)
    second.write_bytes(second.read_bytes()[:-200])
    found = folder.latest_checkpoint()
    assert found is not None
    assert found[0] == first
    first.write_text("no checkpoint")
    with pytest.raises(CheckpointError, match="no complete checkpoint"):
        folder.latest_checkpoint()
    fails(run("--resume", out), "no complete checkpoint")


def test_a_checkpoint_of_another_configuration_is_refused(config: Path, tmp_path: Path) -> None:
    out, other = tmp_path / "run", tmp_path / "other"
    assert run(config, "--out", out).exit_code == 0
    assert run(config, "--out", other, "--set", "network.hidden_sizes=[4]").exit_code == 0
    (out / "status.json").unlink()
    for name in ("000000000512.pt", "000000001024.pt"):
        (out / "checkpoints" / name).write_bytes((other / "checkpoints" / name).read_bytes())
    fails(run("--resume", out), "does not fit the run's configuration")


def test_a_run_without_checkpoint_begins_anew(config: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    RunFolder(out).create(configuration.load(str(config)), "small", 0)
    assert run("--resume", out).exit_code == 0
    assert len(history(out)) == 3


def test_a_folder_with_a_run_is_not_overwritten(config: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    RunFolder(out).create(configuration.load(str(config)), "small", 0)
    before = (out / "run.json").read_text()
    fails(run(config, "--out", out), "holds a run already")
    assert (out / "run.json").read_text() == before
    fails(run("--resume", tmp_path), "holds no run that could go on")
    fails(run("--resume", out, "--decisions", 5), "without --out, --set and --decisions")
    (out / "run.json").write_text("{}")
    with pytest.raises(RunFolderError, match=r"run\.json: damaged"):
        RunFolder(out).reopen()


def test_a_folder_that_cannot_be_written_is_named(config: Path, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    fails(run(config, "--out", tmp_path / "file" / "run"), "Not a directory")


def test_a_full_disk_leaves_what_was_written_before(config: Path, tmp_path: Path) -> None:
    out = tmp_path / "run"
    # A limit on the size of files stands in for a full disk: checkpoints of eight environments pass it.
    limited = (
        "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (12_000, 12_000)); "
        "from hp_gym.cli.app import main; main()"
    )
    finished = subprocess.run(
        [sys.executable, "-c", limited, "train", str(config), "--out", str(out)],
        check=False,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert finished.returncode == 2, finished.stderr
    lines = finished.stderr.splitlines()
    assert "File too large" in lines[-1]
    assert "Traceback" not in finished.stderr
    assert policies.load(out / "best.safetensors").metadata.decisions == 512
    assert len(history(out)) == 1
    assert json.loads((out / "status.json").read_text())["state"] == "interrupted"
    assert not list(out.glob("**/.*"))
    result = run("--resume", out)
    assert result.exit_code == 0, result.output
    assert len(history(out)) == 3


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ("hyperparameters.n_steps=1.5", "`hyperparameters.n_steps` is 1.5, but should be a valid integer"),
        ("hyperparameters.gamma=2", "`hyperparameters.gamma` is 2, but should be less than or equal to 1"),
        ("hyperparameters.batch_size=100", "batch_size 100 does not divide the 256 decisions"),
        ("algorithm=dqn", "`algorithm` is 'dqn', but must be one of 'ppo', 'maskable-ppo'"),
        ("algorithm=sac", "`hyperparameters.buffer_size` is missing"),
        ("environment.wings=2", "`environment.wings` is unknown"),
        ("environment.actions=['wings']", "unknown action `wings`"),
        ("environment.reward=greed", "unknown reward `greed`"),
        ("validation.distribution=mars", "unknown distribution of episodes `mars`"),
        (CONSTRAINED.replace("-10, 20", "20, -10"), "must be rising temperatures"),
        (CONSTRAINED.replace("trips = 4", "trips = 4, rules = 'nobody'"), "unknown controller `nobody`"),
        ("nonsense", "`nonsense` must have the form key=value"),
    ],
)
def test_wrong_configurations_are_told_in_a_line(
    change: str, reason: str, config: Path, tmp_path: Path
) -> None:
    fails(run(config, "--out", tmp_path / "run", "--set", change), reason)
    assert not (tmp_path / "run").exists()


def test_paths_in_a_configuration_count_from_its_folder(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (inner / "below.toml").write_text(
        'base = "ppo"\n[environment]\ndistribution = "mine.toml"\n[imitation]\nteacher = "hpcu"\n',
        encoding="utf-8",
    )
    (tmp_path / "above.toml").write_text(
        'base = "inner/below.toml"\n[validation]\ndistribution = "other.toml"\n', encoding="utf-8"
    )
    loaded = configuration.load(str(tmp_path / "above.toml"))
    assert loaded.environment.distribution == str(inner / "mine.toml")
    assert loaded.validation.distribution == str(tmp_path / "other.toml")
    assert isinstance(loaded, configuration.PPOTraining)
    assert loaded.imitation is not None
    assert loaded.imitation.teacher == "hpcu"


def test_a_configuration_names_another_as_its_base(config: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.toml"
    other.write_text(f'base = "{config}"\n[hyperparameters]\nn_epochs = 5\n')
    hyperparameters: Any = configuration.load(str(other)).hyperparameters
    assert (hyperparameters.n_epochs, hyperparameters.n_steps) == (5, 32)
    config.write_text(f'base = "{other}"\n')
    with pytest.raises(configuration.TrainingConfigurationError, match="chain of `base` files is too long"):
        configuration.load(str(other))
