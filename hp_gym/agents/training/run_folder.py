"""The folder of a training run: what is needed to repeat it, how it goes, and what came out."""

import csv
import io
import json
import os
import platform
import re
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
from hp_gym.files import OURS, atomic_write, read_bytes
from hp_gym.json_text import dumps
from hp_gym.messages import FileError, OneLineError

_PACKAGES: Final = ("gymnasium", "numpy", "sb3-contrib", "stable-baselines3", "torch")
_KEPT_CHECKPOINTS: Final = 2
_LARGEST_BYTES: Final = 16 * 2**20
_HALF_WRITTEN: Final = re.compile(rf"\..+\.({OURS})?[0-9a-f]{{8}}\.(pt|json|toml|csv|safetensors|zip)")


class RunFolderError(OneLineError):
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
        self.require_new()
        self._checkpoints.mkdir(parents=True, exist_ok=True)
        self._remove_debris()
        self._write("run.json", _json({"name": name, "seed": seed, "starts": [_start()]}))
        self._write("config.toml", configuration.to_toml(training))

    @property
    def is_begun(self) -> bool:
        """Whether there is a run; `config.toml` is written last when one begins."""
        return (self.path / "config.toml").exists()

    def require_new(self) -> None:
        """Checks that no run has begun here.

        Raises:
            RunFolderError: There is a run already.
        """
        if self.is_begun:
            message = f"{self.path}: holds a run already; go on with --resume, or choose another --out"
            raise RunFolderError(message)

    def require_begun(self) -> None:
        """Checks that a run has begun here.

        Raises:
            RunFolderError: There is none.
        """
        if not self.is_begun:
            message = f"{self.path}: holds no run that could go on"
            raise RunFolderError(message)

    def how_to_go_on(self) -> str:
        """Returns what is kept of a run that was stopped, and the command that goes on with it."""
        if not self.is_begun:
            return "no run was begun, and nothing was written"
        made = max((path.stem for path in self._checkpoints.glob("[0-9]*.pt")), default="")
        where = (
            f"its checkpoint is at {int(made):,} decisions"
            if made.isdigit()
            else "there is no checkpoint yet"
        )
        does = "go on" if made.isdigit() else "begin anew"
        return f"{where}; {does} with: hp-gym train --resume {self.path}"

    def reopen(self) -> tuple[Training, str, int]:
        """Returns configuration, name and seed of a run that is to go on, and notes the new start.

        Raises:
            RunFolderError: There is no run, or it has finished.
            TrainingConfigurationError: The configuration is damaged.
            OSError: A file cannot be read or written.
        """
        self.require_begun()
        if self.status().get("state") == "finished":
            message = f"{self.path}: the run has finished"
            raise RunFolderError(message)
        training = configuration.read(self.path / "config.toml")
        try:
            told = json.loads(read_bytes(self.path / "run.json", _LARGEST_BYTES))
            name, seed = str(told["name"]), int(told["seed"])
            told["starts"].append(_start())
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError, RecursionError) as error:
            message = f"{self.path / 'run.json'}: damaged"
            raise RunFolderError(message) from error
        self._checkpoints.mkdir(exist_ok=True)
        self._remove_debris()
        self._write("run.json", _json(told))
        return training, name, seed

    def status(self) -> dict[str, Any]:
        """Returns the latest status; empty if there is none."""
        try:
            told = json.loads(read_bytes(self.path / "status.json", _LARGEST_BYTES))
        except (OSError, ValueError, RecursionError):
            return {}
        return told if isinstance(told, dict) else {}

    def write_status(self, told: Mapping[str, Any]) -> None:
        """Notes how the run goes."""
        # A power cut loses nothing that a checkpoint does not hold; a busy disk would hold up the run.
        self._write("status.json", _json(told), durable=False)

    def write_history(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Writes the history of validations."""
        text = io.StringIO()
        if rows:
            writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        self._write("validation.csv", text.getvalue(), durable=False)

    def checkpoint_path(self, decisions: int) -> Path:
        """Returns where a checkpoint goes."""
        return self._checkpoints / f"{decisions:012d}.pt"

    def latest_checkpoint(self) -> tuple[Path, dict[str, Any]] | None:
        """Returns the latest checkpoint that is whole, or None.

        Raises:
            CheckpointError: There are checkpoints, but none is whole.
        """
        damaged: OneLineError | None = None
        for path in sorted(self._checkpoints.glob("[0-9]*.pt"), reverse=True):
            try:
                return path, checkpoint.read(path)
            except (checkpoint.CheckpointError, FileError) as error:
                damaged = damaged or error
        if damaged is not None:
            raise damaged
        return None

    def forget_old_checkpoints(self) -> None:
        """Removes all but the latest checkpoints."""
        for path in sorted(self._checkpoints.glob("[0-9]*.pt"))[:-_KEPT_CHECKPOINTS]:
            path.unlink(missing_ok=True)

    def _remove_debris(self) -> None:
        """Removes what killed processes have left half-written; the run is locked, so nobody else writes."""
        for folder in (self.path, self._checkpoints):
            for path in folder.iterdir():
                if _HALF_WRITTEN.fullmatch(path.name):
                    path.unlink()

    def _write(self, name: str, text: str, *, durable: bool = True) -> None:
        with atomic_write(self.path / name, durable=durable) as temporary:
            temporary.write_text(text, encoding="utf-8")


def _json(told: Mapping[str, Any]) -> str:
    return dumps(told) + "\n"


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
