"""`hp-gym tune`: the rules at their best."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from hp_gym.cli import many_runs
from hp_gym.cli.output import console, fail, print_json

if TYPE_CHECKING:
    from hp_gym.studies.tuning.ambient_bands import Band
    from hp_gym.studies.tuning.search import Result


def tune(
    *,
    out: Annotated[Path, typer.Option(help="Folder for the two controller files.")] = Path("out/tune"),
    trials: Annotated[int, typer.Option(min=10, help="Trials of the search in each ambient band.")] = 160,
    trips: Annotated[int, typer.Option(min=1, help="Training trips in each ambient band.")] = 128,
    seed: Annotated[int, typer.Option(min=0, help="Seed of trips and search.")] = 0,
    overrides: many_runs.Overrides = None,
    comfort: Annotated[
        Literal["pooled", "standard"],
        typer.Option(
            help="What rules are held to: mean discomfort over all trips, or the standard of "
            "docs/benchmark.md trip by trip."
        ),
    ] = "pooled",
    json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Chooses modes, and modes with set points, for each ambient band on training trips."""
    from hp_gym.overrides import assignments
    from hp_gym.studies.tuning import tuned_rules

    how = f"hp-gym tune --trials {trials} --trips {trips} --seed {seed}"
    how += f" --overrides {overrides}" if overrides else ""
    how += f" --comfort {comfort}" if comfort != "pooled" else ""
    try:
        best, tuned = tuned_rules.tune(
            out, trials, trips, seed, how, overrides=assignments(overrides), comfort=comfort
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
