"""Trials of a search that was stopped: the same command goes on with them."""

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final, TypeAlias

from optuna.distributions import CategoricalDistribution
from optuna.trial import TrialState, create_trial

from hp_gym.build_identity import build
from hp_gym.files import OURS
from hp_gym.studies.axes import Axis
from hp_gym.studies.optimise import search_loop, trial_store
from hp_gym.studies.tuning.ambient_bands import BANDS, Band
from hp_gym.studies.tuning.rule_choices import Choices
from hp_gym.studies.tuning.rule_families import FAMILIES

Outcome: TypeAlias = tuple[float, float]
"""Mean score of a trip, and what it lacks in comfort, as the objective counts it."""

_DIRECTIONS: Final[trial_store.Directions] = ("maximize", "minimize")


class KeptTrials:
    """A file as `hp-gym optimise` has it, beside the folder of results; removed when the search has ended.

    Searches draw the same choices again for the same seed and the same outcomes, so that what a trial gave is
    all that is needed to go on.

    Args:
        folder: Folder of the results.
        command: What was asked for; trials of another command or build, and damaged ones, are forgotten.
        overrides: What differs in the car; part of what was asked for.

    Raises:
        OSError: The folder cannot be written to.
    """

    def __init__(self, folder: Path, command: str, overrides: Sequence[str] = ()) -> None:
        place = folder.resolve()
        self._path = place.with_name(f".{place.name}.{OURS}trials")
        definition = {"command": command, "overrides": list(overrides), "build": build()}
        try:
            self._study, _ = trial_store.join(self._path, definition, _DIRECTIONS)
        except trial_store.OptimiseError:
            self.remove()
            self._study, _ = trial_store.join(self._path, definition, _DIRECTIONS)
        trials = self._study.get_trials(deepcopy=False, states=(TrialState.COMPLETE,))
        self._outcomes = {_key(trial.params): (trial.values[0], trial.values[1]) for trial in trials}

    def __len__(self) -> int:
        """Number of trials."""
        return len(self._outcomes)

    def get(self, band: Band, choices: Choices) -> Outcome | None:
        """Returns what choices gave in a band, if that is known."""
        return self._outcomes.get(_key(_drawn(band, choices)))

    def add(self, band: Band, choices: Choices, outcome: Outcome) -> None:
        """Notes what choices gave in a band.

        Raises:
            OSError: The file cannot be written to.
        """
        params = _drawn(band, choices)
        self._outcomes[_key(params)] = outcome
        there = {
            "band": CategoricalDistribution(range(len(BANDS))),
            **search_loop.distributions(_axes(choices)),
        }
        self._study.add_trial(create_trial(params=params, distributions=there, values=outcome))

    def remove(self) -> None:
        """Removes the file."""
        shutil.rmtree(self._path, ignore_errors=True)


def _axes(choices: Choices) -> list[Axis]:
    """Those that choices are of; families that share a key share its axis."""
    axes = {axis.name: axis for family in FAMILIES.values() for axis in (*family.axes, *family.cooled_axes)}
    return [axis for axis in axes.values() if axis.keys[0] in choices.values]


def _drawn(band: Band, choices: Choices) -> dict[str, float | int]:
    return {"band": BANDS.index(band), **(search_loop.as_drawn(_axes(choices), choices.values) or {})}


def _key(params: Mapping[str, float | int]) -> str:
    return repr(sorted(params.items()))
