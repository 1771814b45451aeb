"""What happens between updates: validation, policies, checkpoints, status."""

from dataclasses import asdict, dataclass
from time import perf_counter
from typing import Any

from rich.progress import Progress, TaskID

from hp_gym import extras
from hp_gym.agents.policies import PolicyEnvironment, SavedPolicy, save
from hp_gym.agents.policies.from_sb3 import from_sb3
from hp_gym.agents.training import checkpoint, environments
from hp_gym.agents.training.comfort import ComfortConstraint
from hp_gym.agents.training.configuration import Training
from hp_gym.agents.training.run_folder import RunFolder
from hp_gym.agents.training.trips import Decide
from hp_gym.agents.training.validation import Figures, Validation
from hp_gym.files import atomic_write
from hp_gym.terminal import progress_console

with extras.needed("train"):
    from stable_baselines3.common.callbacks import BaseCallback


@dataclass(frozen=True)
class Run:
    """A training run.

    Attributes:
        training: The configuration.
        name: Its name.
        seed: Seed of weights, decisions and trips.
        folder: The run's folder.
    """

    training: Training
    name: str
    seed: int
    folder: RunFolder


class Watch(BaseCallback):
    """Watches a training and keeps its folder.

    Args:
        run: The run.
        progress: Bar to move.
        task: The bar's task.
        notes: What was remembered at a checkpoint; from the beginning `rules`, the figures of the HPCU, and
            `comfort`, where comfort is constrained.
    """

    def __init__(
        self,
        run: Run,
        progress: Progress,
        task: TaskID,
        notes: dict[str, Any],
    ) -> None:
        super().__init__()
        self._run, self._training, self._folder = run, run.training, run.folder
        self._progress, self._task = progress, task
        self._validation = Validation(run.training)
        environment = run.training.environment
        self._environment = PolicyEnvironment.resolve(
            vehicle=environment.vehicle,
            continuous=environment.continuous,
            actions=environment.actions,
            observations=environment.observations,
            control_interval_s=environment.control_interval_s,
        )
        self._history: list[dict[str, Any]] = notes.get("history", [])
        self._rules = Figures(**notes["rules"])
        self._next_validation: int = notes.get("next_validation", run.training.validation.interval_decisions)
        self._next_checkpoint: int = notes.get("next_checkpoint", run.training.checkpoint_interval_decisions)
        self._earlier_s: float = notes.get("wall_s", 0.0)
        self._validation_s: float = notes.get("validation_s", 0.0)
        self._checkpoint_s: float = notes.get("checkpoint_s", 0.0)
        self._began_s = perf_counter()
        self._decisions_at_start = 0
        self._latest_checkpoint: int | None = None
        self._kept: tuple[int, bytes] | None = None
        self._is_between = False
        self._is_asked_to_stop = False
        constraint = run.training.comfort_constraint
        self._comfort = None
        if constraint is not None:
            self._comfort = ComfortConstraint(run.training, constraint, notes["comfort"])

    @property
    def history(self) -> list[dict[str, Any]]:
        """Validations so far."""
        return self._history

    @property
    def rules(self) -> Figures:
        """The rule-based HPCU on the validation trips."""
        return self._rules

    def _on_training_start(self) -> None:
        self._decisions_at_start = self.model.num_timesteps
        self._latest_checkpoint = self.model.num_timesteps or None
        self._began_s = perf_counter()
        self._write_status("running")
        self._show()

    def stop(self) -> None:
        """Ends the training where it can go on from: now, or for off-policy algorithms in a moment.

        Raises:
            KeyboardInterrupt: That is now, or it was asked for before.
        """
        if self._keeps_rollouts() or self._is_between or self._is_asked_to_stop:
            raise KeyboardInterrupt
        self._is_asked_to_stop = True

    def _on_rollout_start(self) -> None:
        self._is_between = True
        if self._is_asked_to_stop:
            raise KeyboardInterrupt
        self._look_after()
        # Before it decides on: what a stop in the middle of a rollout goes back to. Buffers of off-policy
        # algorithms are too large for that, but their rollouts take a moment only.
        if self._keeps_rollouts() and (self._kept is None or self._kept[0] != self.model.num_timesteps):
            self._keep()
        self._is_between = False

    def _keeps_rollouts(self) -> bool:
        return getattr(self.model, "replay_buffer", None) is None

    def _look_after(self) -> None:
        decisions = self.model.num_timesteps
        self._anneal_entropy()
        if self._comfort is not None and self._comfort.is_due(decisions):
            self._hold_comfort(self._comfort)
        if decisions >= self._next_validation:
            self._next_validation = decisions + self._training.validation.interval_decisions
            self._validate()
        if decisions >= self._next_checkpoint:
            self._next_checkpoint = decisions + self._training.checkpoint_interval_decisions
            self._write_checkpoint()
        self._show()

    def _on_step(self) -> bool:
        return True

    def finish(self) -> None:
        """Validates a last time and writes what the training leaves."""
        if not self._history or self._history[-1]["decisions"] != self.model.num_timesteps:
            self._validate()
        self._save_policy("final")
        with atomic_write(self._folder.path / "final.zip") as temporary:
            self.model.save(temporary)
        self._write_status("finished")
        self._show()

    def interrupted(self, reason: str) -> None:
        """Notes why the training ended early."""
        self._write_status("interrupted", reason=reason)

    def keep_work(self) -> None:
        """Writes a checkpoint of where the rollout under way began, if there is none yet.

        Raises:
            OSError: It cannot be written.
        """
        kept = self._kept
        if self._is_between and not self._keeps_rollouts():
            kept = self._keep()
        if kept is not None and kept[0] != self._latest_checkpoint:
            self._write_kept(*kept)

    def wall_s(self) -> float:
        """Returns the time that the training took, in all processes."""
        return self._earlier_s + perf_counter() - self._began_s

    def speed_decisions_s(self) -> float:
        """Returns decisions a second of this process, everything included."""
        made = self.model.num_timesteps - self._decisions_at_start
        return made / max(perf_counter() - self._began_s, 1e-9)

    def _anneal_entropy(self) -> None:
        end = getattr(self._training.hyperparameters, "ent_coef_end", None)
        if end is not None:
            start = self._training.hyperparameters.ent_coef
            share = min(self.model.num_timesteps / self._training.total_decisions, 1.0)
            self.model.ent_coef = start + (end - start) * share  # type: ignore[attr-defined]

    def _validate(self) -> None:
        began_s = perf_counter()
        decide, masked = self._decide()
        figures = self._validation.of_policy(decide, masked=masked)
        earlier = [row["score"] for row in self._history]
        row = {"decisions": self.model.num_timesteps, "wall_s": round(self.wall_s(), 1), **asdict(figures)}
        self._history.append(row | {f"hpcu_{key}": value for key, value in asdict(self._rules).items()})
        self._folder.write_history(self._history)
        if not earlier or figures.score > max(earlier):
            self._save_policy("best")
        for key, value in asdict(figures).items():
            self.logger.record(f"validation/{key}", value)
        self.logger.dump(self.model.num_timesteps)
        self._validation_s += perf_counter() - began_s
        self._write_status("running")
        progress_console.print(
            f"{self.model.num_timesteps:,} decisions, {self.wall_s():.0f} s: {self._figures(figures)}",
            soft_wrap=True,
        )

    def _hold_comfort(self, comfort: ComfortConstraint) -> None:
        began_s = perf_counter()
        decide, masked = self._decide()
        excess_k = comfort.update(self.model.num_timesteps, decide, masked=masked)
        comfort.weigh(self.training_env)
        assert self._training.comfort_constraint is not None
        degc = self._training.comfort_constraint.ambient_degc
        for ambient_degc, excess, multiplier in zip(degc, excess_k, comfort.multipliers, strict=True):
            self.logger.record(f"comfort/excess_k_at_{ambient_degc:g}_degc", float(excess))
            self.logger.record(f"comfort/multiplier_at_{ambient_degc:g}_degc", float(multiplier))
        self._validation_s += perf_counter() - began_s

    def _decide(self) -> tuple[Decide, bool]:
        """The policy without chance, and whether it needs masks."""
        if self._training.algorithm == "recurrent-ppo":
            return _Recurrent(self.model, self.training_env), False
        policy = self._policy()
        return policy.predict, policy.needs_masks

    def _policy(self) -> SavedPolicy:
        return from_sb3(
            self.model,
            self._environment,
            normalisation=environments.normaliser(self.training_env),
            seed=self._run.seed,
            configuration=self._run.name,
        )

    def _save_policy(self, what: str) -> None:
        if self._training.algorithm != "recurrent-ppo":
            save(self._folder.path / f"{what}.safetensors", self._policy())
        elif what == "best":
            with atomic_write(self._folder.path / "best.zip") as temporary:
                self.model.save(temporary)

    def _write_checkpoint(self) -> None:
        began_s = perf_counter()
        self._write_kept(*self._keep())
        self._checkpoint_s += perf_counter() - began_s
        self._write_status("running")

    def _keep(self) -> tuple[int, bytes]:
        """Remembers where the training is, all of it."""
        notes = {
            "history": self._history,
            "rules": asdict(self._rules),
            "comfort": self._comfort.notes() if self._comfort is not None else {},
            "next_validation": self._next_validation,
            "next_checkpoint": self._next_checkpoint,
            "wall_s": self.wall_s(),
            "validation_s": self._validation_s,
            "checkpoint_s": self._checkpoint_s,
        }
        self._kept = None
        kept = self.model.num_timesteps, checkpoint.encode(self.model, notes)
        if self._keeps_rollouts():
            self._kept = kept
        return kept

    def _write_kept(self, decisions: int, data: bytes) -> None:
        checkpoint.write(self._folder.checkpoint_path(decisions), data)
        self._folder.forget_old_checkpoints()
        self._latest_checkpoint = decisions

    def _write_status(self, state: str, **more: Any) -> None:
        speed = self.speed_decisions_s()
        best = max(self._history, key=lambda row: row["score"], default=None)
        self._folder.write_status(
            {
                "state": state,
                "decisions": self.model.num_timesteps,
                "total_decisions": self._training.total_decisions,
                "wall_s": round(self.wall_s(), 1),
                "validation_s": round(self._validation_s, 1),
                "checkpoint_s": round(self._checkpoint_s, 1),
                "decisions_per_s": round(speed),
                "plant_seconds_per_s": round(speed * self._training.environment.control_interval_s),
                "latest_checkpoint": self._latest_checkpoint,
                "latest_validation": self._history[-1] if self._history else None,
                "best_validation": best,
                **more,
            }
        )

    def _figures(self, figures: Figures) -> str:
        return (
            f"score {figures.score:.2f} (HPCU {self._rules.score:.2f}), "
            f"energy {figures.attributable_energy_kwh:.3f} kWh ({self._rules.attributable_energy_kwh:.3f}), "
            f"discomfort {figures.discomfort_k:.2f} K ({self._rules.discomfort_k:.2f})"
        )

    def _show(self) -> None:
        latest = self._history[-1]["score"] if self._history else None
        score = "" if latest is None else f", score {latest:.2f} (HPCU {self._rules.score:.2f})"
        self._progress.update(
            self._task,
            completed=self.model.num_timesteps,
            told=f"{self.speed_decisions_s():,.0f} decisions/s{score}",
        )


class _Recurrent:
    """A recurrent model, with its memory of the trips under way."""

    def __init__(self, model: Any, envs: Any) -> None:
        self._model, self._wrapper = model, environments.normaliser(envs)
        self._state: Any = None

    def __call__(self, observations: Any, masks: Any) -> Any:  # noqa: ARG002
        # A trip that follows another one keeps its memory, but is not counted.
        if self._wrapper is not None:
            observations = self._wrapper.normalize_obs(observations)
        actions, self._state = self._model.predict(observations, state=self._state, deterministic=True)
        return actions
