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
    rules: Annotated[
        list[str] | None, typer.Argument(help="hpcu-tuned, thermostat-tuned; all where none is named.")
    ] = None,
    *,
    out: Annotated[Path, typer.Option(help="Folder for the controller files.")] = Path("out/tune"),
    trials: Annotated[int, typer.Option(min=10, help="Trials of each search in each ambient band.")] = 160,
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
    """Chooses modes, and modes with numbers, of rules for each ambient band on training trips."""
    from hp_gym.overrides import assignments
    from hp_gym.studies.tuning import rule_families, search, tuned_rules

    words = ["hp-gym tune", *(rules or []), f"--trials {trials} --trips {trips} --seed {seed}"]
    words += [f"--overrides {overrides}"] if overrides else []
    words += [f"--comfort {comfort}"] if comfort != "pooled" else []
    try:
        families = [rule_families.family(name) for name in dict.fromkeys(rules or rule_families.FAMILIES)]
        found = tuned_rules.tune(
            out,
            families,
            search.Effort(trials, trips, seed),
            " ".join(words),
            overrides=assignments(overrides),
            comfort=comfort,
        )
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json({name.replace("-", "_"): _rows(results) for name, results in found.items()})
        return
    from rich.table import Table

    table = Table(
        box=None,
        header_style="bold",
        pad_edge=False,
        title="Points a training trip, less what a lack of comfort costs",
        title_justify="left",
    )
    for heading in ("Ambient", "paper's rules", *found):
        table.add_column(heading, justify="right", no_wrap=True)
    for in_band in zip(*found.values(), strict=True):
        band, first = in_band[0]
        scores = (f"{result.score:.2f}" for _, result in in_band)
        table.add_row(band.title, f"{first.paper_score:.2f}", *scores)
    console.print(table)
    console.print(f"Written: {', '.join(str(out / f'{name}.toml') for name in found)}", soft_wrap=True)


def _rows(results: list[tuple["Band", "Result"]]) -> list[dict[str, object]]:
    return [
        {
            "low_degc": band.low_degc,
            "high_degc": band.high_degc,
            "score": result.score,
            "paper_score": result.paper_score,
            "trials": result.trials,
            "base": result.choices.base,
            "choices": dict(result.choices.values),
        }
        for band, result in results
    ]
