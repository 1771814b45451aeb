"""The folder of a training run: what is needed to repeat it, how it goes, and what came out."""

import csv
import io
import json
import os
import platform
import subprocess
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any, Final

import hp_gym
from hp_gym.agents.training import checkpoint, configuration
from hp_gym.agents.training.configuration import Training
from hp_gym.files import atomic_write

_PACKAGES: Final = ("gymnasium", "numpy", "sb3-contrib", "stable-baselines3", "torch")
_KEPT_CHECKPOINTS: Final = 2


class RunFolderError(ValueError):
    """A run that cannot be started or continued; the message says which and why."""


class RunFolder:
    """The files of a run.

    | File | What |
    |---|---|
    | `config.toml` | the configuration, every default spelled out |
    | `run.json` | command, seed, versions, hardware, once for each start |
    | `status.json` | how far it is, times, latest figures |
    | `validation.csv` | a row for each validation |
    | `checkpoints/*.pt` | the latest two |
    | `tensorboard/` | logs |
    | `best.safetensors`, `final.safetensors` | policies: best on the validation trips, and last |
    | `final.zip` | the last model as stable-baselines3 saves it |

    Args:
        path: The folder.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.tensorboard = path / "tensorboard"
        self._checkpoints = path / "checkpoints"

    def create(self, training: Training, name: str, seed: int) -> None:
        """Begins a run.

        Raises:
            RunFolderError: There is a run already.
            OSError: The folder cannot be written to.
        """
        if (self.path / "config.toml").exists() or (self.path / "run.json").exists():
            message = f"{self.path}: holds a run already; go on with --resume, or choose another --out"
            raise RunFolderError(message)
        self._checkpoints.mkdir(parents=True, exist_ok=True)
        self._write("run.json", _json({"name": name, "seed": seed, "starts": [_start()]}))
        self._write("config.toml", configuration.to_toml(training))

    def reopen(self) -> tuple[Training, str, int]:
        """Returns configuration, name and seed of a run that is to go on, and notes the new start.

        Raises:
            RunFolderError: There is no run, or it has finished.
            TrainingConfigurationError: The configuration is damaged.
            OSError: A file cannot be read or written.
        """
        if not (self.path / "config.toml").exists():
            message = f"{self.path}: holds no run that could go on"
            raise RunFolderError(message)
        if self.status().get("state") == "finished":
            message = f"{self.path}: the run has finished"
            raise RunFolderError(message)
        training = configuration.read(self.path / "config.toml")
        try:
            told = json.loads((self.path / "run.json").read_text(encoding="utf-8"))
            name, seed = str(told["name"]), int(told["seed"])
            told["starts"].append(_start())
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            message = f"{self.path / 'run.json'}: damaged"
            raise RunFolderError(message) from error
        self._checkpoints.mkdir(exist_ok=True)
        self._write("run.json", _json(told))
        return training, name, seed

    def status(self) -> dict[str, Any]:
        """Returns the latest status; empty if there is none."""
        try:
            told = json.loads((self.path / "status.json").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {}
        return told if isinstance(told, dict) else {}

    def write_status(self, told: Mapping[str, Any]) -> None:
        """Notes how the run goes."""
        self._write("status.json", _json(told))

    def write_history(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Writes the history of validations."""
        text = io.StringIO()
        if rows:
            writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        self._write("validation.csv", text.getvalue())

    def checkpoint_path(self, decisions: int) -> Path:
        """Returns where a checkpoint goes."""
        return self._checkpoints / f"{decisions:012d}.pt"

    def latest_checkpoint(self) -> tuple[Path, dict[str, Any]] | None:
        """Returns the latest checkpoint that is whole, or None.

        Raises:
            CheckpointError: There are checkpoints, but none is whole.
        """
        damaged: checkpoint.CheckpointError | None = None
        for path in sorted(self._checkpoints.glob("[0-9]*.pt"), reverse=True):
            try:
                return path, checkpoint.read(path)
            except checkpoint.CheckpointError as error:
                damaged = damaged or error
        if damaged is not None:
            raise damaged
        return None

    def forget_old_checkpoints(self) -> None:
        """Removes all but the latest checkpoints, and what killed processes have left half-written."""
        for path in sorted(self._checkpoints.glob("[0-9]*.pt"))[:-_KEPT_CHECKPOINTS]:
            path.unlink()
        for path in self._checkpoints.glob(".*.pt"):
            path.unlink()

    def _write(self, name: str, text: str) -> None:
        with atomic_write(self.path / name) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _json(told: Mapping[str, Any]) -> str:
    return json.dumps(told, indent=2) + "\n"


def _start() -> dict[str, Any]:
    return {
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": sys.argv,
        "versions": {
            "python": platform.python_version(),
            "hp_gym": hp_gym.__version__,
            **{package: metadata.version(package) for package in _PACKAGES},
        },
        "git": _git(),
        "hardware": {
            "system": platform.platform(),
            "processor": _processor(),
            "cores": os.cpu_count(),
        },
    }


def _git() -> dict[str, Any] | None:
    """Commit of the checkout, and whether files were changed; None outside a checkout."""
    folder = Path(hp_gym.__file__).parent

    def ask(*arguments: str) -> str:
        command = ["git", "-C", str(folder), *arguments]
        return subprocess.run(command, check=True, capture_output=True, text=True, timeout=10).stdout.strip()

    try:
        # An installed package may lie in somebody else's checkout.
        if not ask("ls-files", "__init__.py"):
            return None
        return {"commit": ask("rev-parse", "HEAD"), "dirty": bool(ask("status", "--porcelain"))}
    except (OSError, subprocess.SubprocessError):
        return None


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()
