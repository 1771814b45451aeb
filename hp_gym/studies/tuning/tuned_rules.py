"""What `hp-gym tune` does, without the terminal: the searches in all bands, and their files."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, TypeAlias

from rich.progress import Progress

from hp_gym.studies.tuning import rule_choices, search
from hp_gym.studies.tuning.ambient_bands import BANDS, Band
from hp_gym.studies.tuning.kept_trials import KeptTrials
from hp_gym.studies.tuning.objective import Comfort, objective
from hp_gym.studies.tuning.rule_families import RuleFamily
from hp_gym.terminal import progress_console
from hp_gym.transactions import new_contents

Found: TypeAlias = list[tuple[Band, search.Result]]
"""What a search found in each band."""

BEST_MODE: Final = "hpcu-best-mode"
"""Rules that all searches begin with."""

_BEST_MODE_IS: Final = "Best fixed modes of the HPCU in each ambient band, the paper's set points"


def tune(
    out: Path,
    families: Sequence[RuleFamily],
    effort: search.Effort,
    command: str,
    *,
    overrides: Sequence[str] = (),
    comfort: Comfort = "pooled",
) -> dict[str, Found]:
    """Searches modes, and modes with numbers of each family, in each band, and writes the controller files.

    A search that was stopped goes on where it was if it is asked for with the same numbers again.

    Args:
        out: Folder for the controller files.
        families: Rules to tune.
        effort: Trials and trips in each band, and their seed.
        command: What was asked for, for the files.
        overrides: Changes for all trips, `key=value`.
        comfort: What rules are held to.

    Returns:
        What was found for each file, by its name; first the best modes.

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
            found = _search(kept, families, effort, overrides=overrides, comfort=comfort)
        finally:
            if not kept:
                kept.remove()
        what = {BEST_MODE: _BEST_MODE_IS, **{family.name: family.what for family in families}}
        for name, results in found.items():
            description = f"{what[name]}; chosen on training trips:\n{command}"
            choices = [(band, result.choices) for band, result in results]
            rule_choices.write(folder / f"{name}.toml", description, choices)
    kept.remove()
    return found


def _search(
    kept: KeptTrials,
    families: Sequence[RuleFamily],
    effort: search.Effort,
    *,
    overrides: Sequence[str],
    comfort: Comfort,
) -> dict[str, Found]:
    found: dict[str, Found] = {BEST_MODE: [], **{family.name: [] for family in families}}
    with Progress(console=progress_console, disable=not progress_console.is_terminal) as progress:
        each_band = len(search.modes()) + len(families) * effort.trials
        task = progress.add_task("", total=len(BANDS) * each_band)
        for band in BANDS:
            progress.update(task, description=band.title)
            with objective(
                band, effort.trips, effort.seed, kept, overrides=overrides, comfort=comfort
            ) as goal:
                modes = search.best_mode(goal, lambda: progress.advance(task))
                found[BEST_MODE].append((band, modes))
                for family in families:
                    colder = [result.choices for _, result in found[family.name][-1:]]
                    result = search.tuned(
                        goal, family, [modes.choices, *colder], effort, lambda: progress.advance(task)
                    )
                    found[family.name].append((band, result))
    return found
