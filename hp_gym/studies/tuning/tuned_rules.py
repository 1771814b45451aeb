"""What `hp-gym tune` does, without the terminal: both searches in all bands, and their files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, TypeAlias

from rich.progress import Progress

from hp_gym.studies.tuning import rule_choices, search
from hp_gym.studies.tuning.ambient_bands import BANDS, Band
from hp_gym.studies.tuning.kept_trials import KeptTrials
from hp_gym.studies.tuning.objective import Comfort, objective
from hp_gym.terminal import progress_console
from hp_gym.transactions import new_contents

Found: TypeAlias = list[tuple[Band, search.Result]]
"""What a search found in each band."""

_FILES: Final = (
    ("hpcu-best-mode", "Best fixed modes of the HPCU in each ambient band, the paper's set points"),
    ("hpcu-tuned", "HPCU with modes, set points and thresholds tuned in each ambient band"),
)


def tune(
    out: Path,
    trials: int,
    trips: int,
    seed: int,
    command: str,
    *,
    overrides: Sequence[str] = (),
    comfort: Comfort = "pooled",
) -> tuple[Found, Found]:
    """Searches modes, and modes with set points, in each band, and writes both controller files.

    A search that was stopped goes on where it was if it is asked for with the same numbers again.

    Args:
        out: Folder for the two controller files.
        trials: Trials of the search in each band.
        trips: Training trips in each band.
        seed: Seed of trips and search.
        command: What was asked for, for the files.
        overrides: Changes for all trips, `key=value`.
        comfort: What rules are held to.

    Returns:
        Best modes, and best modes with set points.

    Raises:
        InUseError: Another process writes to the folder.
        OSError: The folder cannot be written to; what was there before is intact.
    """
    with new_contents(out) as folder:
        kept = KeptTrials(out, command, overrides)
        if kept:
            progress_console.print(
                f"Going on after {len(kept)} trials that were driven before.", soft_wrap=True
            )
        try:
            best, tuned = _search(kept, trials, trips, seed, overrides=overrides, comfort=comfort)
        finally:
            if not kept:
                kept.remove()
        for (name, what), results in zip(_FILES, (best, tuned), strict=True):
            description = f"{what}; chosen on training trips:\n{command}"
            choices = [(band, result.choices) for band, result in results]
            rule_choices.write(folder / f"{name}.toml", description, choices)
    kept.remove()
    return best, tuned


def _search(
    kept: KeptTrials, trials: int, trips: int, seed: int, *, overrides: Sequence[str], comfort: Comfort
) -> tuple[Found, Found]:
    best: Found = []
    tuned: Found = []
    with Progress(console=progress_console, disable=not progress_console.is_terminal) as progress:
        task = progress.add_task("", total=len(BANDS) * (trials + len(search.modes())))
        for band in BANDS:
            progress.update(task, description=band.title)
            with objective(band, trips, seed, kept, overrides=overrides, comfort=comfort) as goal:
                best.append((band, search.best_mode(goal, lambda: progress.advance(task))))
                start = best[-1][1].choices
                result = search.tuned(goal, start, trials, seed, lambda: progress.advance(task))
                tuned.append((band, result))
    return best, tuned
