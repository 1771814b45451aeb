"""`hp-gym tune`: the rules at their best."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hp_gym.cli.output import console, fail, print_json
from hp_gym.terminal import progress_console

if TYPE_CHECKING:
    from hp_gym.studies.tuning.ambient_bands import Band
    from hp_gym.studies.tuning.search import Result


def tune(
    *,
    out: Annotated[Path, typer.Option(help="Folder for the two controller files.")] = Path("out/tune"),
    trials: Annotated[int, typer.Option(min=10, help="Trials of the search in each ambient band.")] = 160,
    trips: Annotated[int, typer.Option(min=1, help="Training trips in each ambient band.")] = 128,
    seed: Annotated[int, typer.Option(min=0, help="Seed of trips and search.")] = 0,
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Chooses modes, and modes with set points, for each ambient band on training trips."""
    from rich.progress import Progress

    from hp_gym.studies.tuning import rule_choices, search
    from hp_gym.studies.tuning.ambient_bands import BANDS
    from hp_gym.studies.tuning.objective import objective

    best: list[tuple[Band, Result]] = []
    tuned: list[tuple[Band, Result]] = []
    how = f"hp-gym tune --trials {trials} --trips {trips} --seed {seed}"
    try:
        out.mkdir(parents=True, exist_ok=True)
        with Progress(console=progress_console) as progress:
            task = progress.add_task("", total=len(BANDS) * (trials + len(search.modes())))
            for band in BANDS:
                progress.update(task, description=band.title)
                with objective(band, trips, seed) as goal:
                    best.append((band, search.best_mode(goal, lambda: progress.advance(task))))
                    start = best[-1][1].choices
                    result = search.tuned(goal, start, trials, seed, lambda: progress.advance(task))
                    tuned.append((band, result))
        for name, what, results in (
            (
                "hpcu-best-mode",
                "Best fixed modes of the HPCU in each ambient band, the paper's set points",
                best,
            ),
            ("hpcu-tuned", "HPCU with modes, set points and thresholds tuned in each ambient band", tuned),
        ):
            description = f"{what}; chosen on training trips:\n{how}"
            rule_choices.write(
                out / f"{name}.toml", description, [(band, result.choices) for band, result in results]
            )
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json({"best_mode": _rows(best), "tuned": _rows(tuned)})
        return
    from rich.table import Table

    table = Table(
        box=None,
        header_style="bold",
        pad_edge=False,
        title="Points a training trip, less what a lack of comfort costs",
        title_justify="left",
    )
    for heading in ("Ambient", "paper's rules", "best mode", "tuned"):
        table.add_column(heading, justify="right", no_wrap=True)
    for (band, mode), (_, result) in zip(best, tuned, strict=True):
        table.add_row(band.title, f"{mode.paper_score:.2f}", f"{mode.score:.2f}", f"{result.score:.2f}")
    console.print(table)
    console.print(f"Written: {out / 'hpcu-best-mode.toml'}, {out / 'hpcu-tuned.toml'}", soft_wrap=True)


def _rows(results: list[tuple["Band", "Result"]]) -> list[dict[str, object]]:
    return [
        {
            "low_degc": band.low_degc,
            "high_degc": band.high_degc,
            "score": result.score,
            "paper_score": result.paper_score,
            "trials": result.trials,
            "choices": dict(result.choices),
        }
        for band, result in results
    ]
