"""What a search has found: the best trial or the front; as a table, files of overrides, a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from optuna.trial import FrozenTrial, TrialState

from hp_gym import extras, notebooks
from hp_gym.files import atomic_write
from hp_gym.key_units import unit_of
from hp_gym.overrides import Value, assignments
from hp_gym.studies.axes import SELECTORS
from hp_gym.studies.optimise import trial_store
from hp_gym.studies.optimise.trial_store import DEFINITION, REFUSED, OptimiseError, excesses

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    import pandas as pd
    from matplotlib.figure import Figure

BEST: Final = "best.toml"


class Found:
    """The trials of a search that are complete.

    Args:
        path: Folder of the search.

    Raises:
        OptimiseError: There is no search in the folder, or no trial of it is complete.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        study = trial_store.load(self.path)
        self.definition: dict[str, Any] = study.user_attrs.get(DEFINITION, {})
        self.trials: list[FrozenTrial] = study.get_trials(states=(TrialState.COMPLETE,))
        failed = study.get_trials(deepcopy=False, states=(TrialState.FAIL,))
        self.refusals: list[str] = [
            trial.user_attrs[REFUSED] for trial in failed if REFUSED in trial.user_attrs
        ]
        if not self.trials or not self.definition:
            why = f", {len(self.refusals)} were refused: {self.refusals[0]}" if self.refusals else ""
            raise OptimiseError(f"{self.path}: no trial is complete{why}")

    @property
    def goals(self) -> list[str]:
        """Totals that are made small or large."""
        return [goal["kpi"] for goal in self.definition["goals"]]

    @property
    def allowed(self) -> list[FrozenTrial]:
        """Trials that keep all constraints."""
        return [trial for trial in self.trials if all(excess <= 0.0 for excess in excesses(trial))]

    @property
    def front(self) -> list[FrozenTrial]:
        """Allowed trials that no other allowed one beats in every goal, the best in the first goal first."""
        signs = [-1.0 if goal["larger"] else 1.0 for goal in self.definition["goals"]]
        costs = {
            trial.number: tuple(sign * value for sign, value in zip(signs, trial.values, strict=True))
            for trial in self.allowed
        }

        def beaten(number: int) -> bool:
            mine = costs[number]
            for other, cost in costs.items():
                better = all(theirs <= own for theirs, own in zip(cost, mine, strict=True))
                if better and (cost != mine or other < number):
                    return True
            return False

        left = [trial for trial in self.allowed if not beaten(trial.number)]
        return sorted(left, key=lambda trial: costs[trial.number])

    @property
    def best(self) -> FrozenTrial:
        """The trial that is best in the first goal.

        Raises:
            OptimiseError: No trial keeps all constraints.
        """
        front = self.front
        if not front:
            names = ["stranded", *(limit["kpi"] for limit in self.definition["constraints"])]
            least = [min(excesses(trial)[place] for trial in self.trials) for place in range(len(names))]
            missed = [f"{name} by {by:.3g}" for name, by in zip(names, least, strict=True) if by > 0.0]
            nearest = f"; missed at least: {', '.join(missed)}" if missed else ""
            raise OptimiseError(f"none of {len(self.trials)} trials keeps all constraints{nearest}")
        return front[0]

    def changes(self, trial: FrozenTrial) -> dict[str, Value]:
        """Overrides, and choices of scenario, controller or vehicle, of a trial."""
        changes: dict[str, Value] = {}
        for axis in self.definition["axes"]:
            value = self.value(trial, axis)
            if isinstance(value, dict):
                changes |= {f"{key}.{name}": inner for key in axis["keys"] for name, inner in value.items()}
            else:
                changes |= dict.fromkeys(axis["keys"], value)
        return changes

    def to_toml(self, trial: FrozenTrial) -> str:
        """A trial as a file of overrides, which every command reads with `--overrides`."""
        reached = ", ".join(f"{kpi} {value:.6g}" for kpi, value in zip(self.goals, trial.values, strict=True))
        lines = [f"# Trial {trial.number} of `hp-gym optimise`: {reached}"]
        lines += [f"# driven: {', '.join(self.definition['scenarios'])}", ""]
        lines += [f'"{text.replace("=", chr(34) + " = ", 1)}' for text in self.definition["overrides"]]
        for key, value in self.changes(trial).items():
            text = assignments({key: value})[0].partition("=")[2]
            lines.append(f"# {key}: {text}" if key in SELECTORS else f'"{key}" = {text}')
        return "\n".join(lines) + "\n"

    def write(self) -> list[Path]:
        """Writes a file of overrides for the best trial, and where there are several goals each of the front.

        Raises:
            OptimiseError: No trial keeps all constraints.
            OSError: A file cannot be written.
        """
        files = {self.path / BEST: self.best}
        if len(self.goals) > 1:
            (self.path / "front").mkdir(exist_ok=True)
            files |= {self.path / "front" / f"trial-{trial.number}.toml": trial for trial in self.front}
        for path, trial in files.items():
            with atomic_write(path, durable=False) as temporary:
                temporary.write_text(self.to_toml(trial), encoding="utf-8")
        return list(files)

    def value(self, trial: FrozenTrial, axis: Mapping[str, Any]) -> Value:
        """The value of an axis of the definition in a trial."""
        drawn: Value = trial.params[axis["name"]]
        if isinstance(axis["values"], dict):
            chosen: Value = axis["values"]["choices"][drawn]
            return chosen
        return drawn

    def rows(self, *, front: bool = False) -> list[dict[str, Any]]:
        """Returns number, values and goals of each trial, whether it is allowed, and on the front.

        Args:
            front: Only those of the front.
        """
        found = self.front
        on_front = {trial.number for trial in found}
        return [
            {
                "trial": trial.number,
                **{axis["name"]: self.value(trial, axis) for axis in self.definition["axes"]},
                **dict(zip(self.goals, trial.values, strict=True)),
                "allowed": all(excess <= 0.0 for excess in excesses(trial)),
                "on_front": trial.number in on_front,
            }
            for trial in (found if front else self.trials)
        ]

    def to_pandas(self, *, front: bool = False) -> pd.DataFrame:
        """Returns a table, one row a trial, with units in `attrs["units"]`.

        Args:
            front: Only those of the front.

        Raises:
            MissingExtraError: pandas is not installed.
        """
        with extras.needed("benchmark"):
            import pandas as pd

        frame = pd.DataFrame(self.rows(front=front))
        units = {axis["name"]: axis["unit"] for axis in self.definition["axes"]}
        frame.attrs["units"] = {name: units.get(name) or unit_of(name) for name in frame.columns}
        return frame

    def plot(self, path: str | os.PathLike[str] | None = None) -> Figure:
        """Draws the front, or of one goal the trials; see `hp_gym.studies.optimise.front_plot.plot`."""
        from hp_gym.studies.optimise.front_plot import plot

        return plot(self, path)

    def _repr_html_(self) -> str:
        """What a notebook shows: the best trial and the picture."""
        best = self.best
        cells = [
            (axis["name"], _shown(self.value(best, axis)), axis["unit"]) for axis in self.definition["axes"]
        ]
        cells += [
            (kpi, f"{value:.6g}", unit_of(kpi)) for kpi, value in zip(self.goals, best.values, strict=True)
        ]
        title = f"Trial {best.number}, the best of {len(self.trials)}; {len(self.front)} on the front"
        return notebooks.table(title, cells) + notebooks.picture(self.plot)


def _shown(value: Value) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
