"""`hp-gym reproduce`: the paper beside the model."""

from pathlib import Path
from typing import Annotated

import typer

from hp_gym.cli import many_runs
from hp_gym.cli.output import console, fail, print_json


def reproduce(
    *,
    out: Annotated[Path, typer.Option(help="Folder for the figures.")] = Path("out/reproduce"),
    substeps: Annotated[int, typer.Option(min=1, max=1000, help="Steps of the plant in a second.")] = 1,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Change a value in all scenarios; may be repeated."),
    ] = None,
    overrides: many_runs.Overrides = None,
    json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON.")] = False,
) -> None:
    """Sets the nine scenarios of Jeffs et al. 2019 beside the model and judges the text's claims."""
    from hp_gym.overrides import assignments
    from hp_gym.studies.reproduction import figures, reproduction_report

    try:
        reproduction = reproduction_report.reproduce(substeps, [*assignments(overrides), *(changes or [])])
    except (ValueError, OSError) as error:
        fail(str(error))
    try:
        paths = figures.write_all(reproduction_report.labelled(reproduction), out)
    except (ValueError, OSError) as error:
        fail(f"cannot write the figures: {error}")
    if json:
        print_json(reproduction.to_json() | {"figures": [str(path) for path in paths]})
        return
    console.print(reproduction_report.scenario_table(reproduction.rows))
    console.print(reproduction_report.claim_table(reproduction.claims))
    for line in reproduction_report.closing_lines(reproduction):
        console.print(line)
    console.print(f"Counterparts of Figures 12, 13 and 14: {out}")
