"""Training from start or checkpoint to the end."""

import signal
import threading
from collections.abc import Generator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from hp_gym import extras
from hp_gym.agents.training import algorithms, checkpoint, environments, imitation
from hp_gym.agents.training.comfort import ComfortConstraint
from hp_gym.agents.training.configuration import MaskablePPOTraining, PPOTraining, Training
from hp_gym.agents.training.memory_need import require_memory
from hp_gym.agents.training.run_folder import RunFolder
from hp_gym.agents.training.validation import Figures, Validation
from hp_gym.agents.training.watch import Run, Watch
from hp_gym.locks import lock
from hp_gym.terminal import progress_console

with extras.needed("train"):
    import torch
    from stable_baselines3.common.base_class import BaseAlgorithm
    from stable_baselines3.common.logger import Logger, TensorBoardOutputFormat
    from stable_baselines3.common.on_policy_algorithm import OnPolicyAlgorithm
    from torch.utils.tensorboard.writer import SummaryWriter


@dataclass(frozen=True)
class Outcome:
    """What a finished training has to tell.

    Attributes:
        folder: The run's folder.
        decisions: Decisions in all.
        wall_s: Time in all processes.
        decisions_per_s: Speed of this process, validation and checkpoints included.
        control_interval_s: Plant seconds of a decision.
        best: Best validation.
        rules: The rule-based HPCU on the same trips.
    """

    folder: Path
    decisions: int
    wall_s: float
    decisions_per_s: float
    control_interval_s: int
    best: dict[str, Any]
    rules: Figures


def start(training: Training, name: str, seed: int, out: Path) -> Outcome:
    """Trains from the beginning.

    Args:
        training: The configuration.
        name: Its name, noted in the policies.
        seed: Seed of weights, decisions and trips.
        out: The run's folder; must hold no run yet.

    Raises:
        RunFolderError: The folder holds a run.
        InUseError: Another process writes to the folder.
        ConfigurationError: An argument of the environment is not accepted.
        OSError: A file cannot be written; all that was written before is intact.
    """
    folder = RunFolder(out)
    with lock(out):
        folder.require_new()
        # Before the folder is made, so that a wrong configuration leaves nothing behind.
        model = _model(training, seed)
        notes = _first_notes(training)
        folder.create(training, name, seed)
        return _learn(Run(training, name, seed, folder), model, notes)


def resume(out: Path) -> Outcome:
    """Goes on from the latest checkpoint of a run, or from the beginning if there is none.

    Raises:
        RunFolderError: There is no run, or it has finished.
        InUseError: Another process writes to the folder.
        CheckpointError: There are checkpoints, but none is whole or fits.
        OSError: A file cannot be read or written.
    """
    folder = RunFolder(out)
    folder.require_begun()
    with lock(out):
        return _resume(folder)


def _resume(folder: RunFolder) -> Outcome:
    training, name, seed = folder.reopen()
    model = _model(training, seed)
    found = folder.latest_checkpoint()
    run = Run(training, name, seed, folder)
    if found is None:
        return _learn(run, model, _first_notes(training))
    path, content = found
    checkpoint.restore(content, model, path)
    progress_console.print(f"Going on from {model.num_timesteps:,} decisions.")
    return _learn(run, model, content["notes"])


def _model(training: Training, seed: int) -> BaseAlgorithm:
    require_memory(training)
    torch.set_num_threads(training.torch_threads)
    return algorithms.make(training, environments.make(training), seed)


def _first_notes(training: Training) -> dict[str, Any]:
    """What the rules do, before anything is learned."""
    notes: dict[str, Any] = {"rules": asdict(Validation(training).of_rules())}
    if training.comfort_constraint is not None:
        notes["comfort"] = ComfortConstraint.begin(training, training.comfort_constraint).notes()
    return notes


def _learn(run: Run, model: BaseAlgorithm, notes: dict[str, Any]) -> Outcome:
    training, folder = run.training, run.folder
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:,.0f}/{task.total:,.0f}, {task.fields[told]}"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with (
        _quiet_threads(),
        _logger(folder.tensorboard, model.num_timesteps) as logger,
        Progress(
            *columns,
            console=progress_console,
            speed_estimate_period=120,
            disable=not progress_console.is_terminal,
        ) as progress,
    ):
        model.set_logger(logger)
        task = progress.add_task(
            "train", total=training.total_decisions, told="", completed=model.num_timesteps
        )
        if training.comfort_constraint is not None:
            assert model.env is not None
            ComfortConstraint(training, training.comfort_constraint, notes["comfort"]).weigh(model.env)
        if model.num_timesteps == 0:
            _imitate(model, run, progress)
        watch = Watch(run, progress, task, notes)
        remaining = training.total_decisions - model.num_timesteps
        try:
            # In stable-baselines3 the total grows by the decisions already made.
            with _stops(watch):
                model.learn(
                    remaining,
                    callback=watch,
                    reset_num_timesteps=model.num_timesteps == 0,
                    log_interval=_LOG[training.algorithm],
                )
            watch.finish()
        except (KeyboardInterrupt, OSError) as error:
            # On a full disk this may fail as well; the first error is the one to tell.
            with suppress(OSError):
                if isinstance(error, KeyboardInterrupt):
                    watch.keep_work()
                watch.interrupted(str(error) or "stopped by the user")
            raise
        finally:
            assert model.env is not None
            model.env.close()
    best = max(watch.history, key=lambda row: float(row["score"]))
    return Outcome(
        folder=folder.path,
        decisions=model.num_timesteps,
        wall_s=watch.wall_s(),
        decisions_per_s=watch.speed_decisions_s(),
        control_interval_s=training.environment.control_interval_s,
        best=best,
        rules=watch.rules,
    )


def _imitate(model: BaseAlgorithm, run: Run, progress: Progress) -> None:
    """The warm start, where the configuration has one."""
    training = run.training
    if not isinstance(training, PPOTraining | MaskablePPOTraining) or training.imitation is None:
        return
    assert isinstance(model, OnPolicyAlgorithm)
    passes = training.imitation.rounds * training.imitation.epochs
    task = progress.add_task("imitate", total=passes, told="passes over demonstrations")
    imitation.warm_start(model, training, run.seed, lambda: progress.advance(task))


# In rollouts, and for SAC in trips.
_LOG = {"ppo": 1, "maskable-ppo": 1, "recurrent-ppo": 1, "sac": 50}


@contextmanager
def _logger(folder: Path, decisions: int) -> Generator[Logger]:
    """TensorBoard logs in which a process that was killed leaves no trace beyond its checkpoint."""
    folder.mkdir(parents=True, exist_ok=True)
    written = _TensorBoard(SummaryWriter(str(folder), purge_step=decisions or None))
    try:
        yield Logger(str(folder), [written])
    finally:
        written.writer.close()


class _TensorBoard(TensorBoardOutputFormat):
    """Writes to a given writer."""

    def __init__(self, writer: SummaryWriter) -> None:
        self.writer = writer
        self._is_closed = False


@contextmanager
def _stops(watch: Watch) -> Generator[None]:
    """Lets Ctrl-C stop the training where it can go on from."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, lambda *_: watch.stop())
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def _quiet_threads() -> Generator[None]:
    """TensorBoard's thread hands its errors on; its traceback need not be seen too."""
    before = threading.excepthook
    threading.excepthook = lambda given: None if isinstance(given.exc_value, OSError) else before(given)
    try:
        yield
    finally:
        threading.excepthook = before
