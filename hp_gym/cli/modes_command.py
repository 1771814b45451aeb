"""`hp-gym modes`: every combination of sources, sinks, PTC and battery treatment."""

from pathlib import Path
from time import perf_counter
from typing import Annotated

import typer

from hp_gym.cli import many_runs
from hp_gym.cli.output import console, fail, print_json


def modes(
    vehicle: Annotated[str, typer.Argument(help="Name or path of a vehicle.")] = "jeffs2019",
    *,
    cycle: Annotated[str, typer.Option(help="Name or path of a drive cycle.")] = "wltc-class3b",
    controller: Annotated[
        str, typer.Option(help="Name or path of the rules that set all levels.")
    ] = "hpcu-modern",
    ambient: Annotated[
        str, typer.Option(metavar="LOW:HIGH/COUNT", help="Ambient temperatures [degC].")
    ] = "-20:40/15",
    store_degc: Annotated[
        float | None, typer.Option(help="Heat stores at the start [degC]; soaked at ambient by default.")
    ] = None,
    changes: many_runs.Changes = None,
    overrides: many_runs.Overrides = None,
    most: Annotated[int, typer.Option(min=1, help="Modes that the table of all temperatures shows.")] = 15,
    plot: Annotated[Path | None, typer.Option(help="Draw a heat map to a .png, .svg or .pdf file.")] = None,
    threads: many_runs.Threads = None,
    json: Annotated[bool, typer.Option("--json", help="Print all modes as JSON.")] = False,
) -> None:
    """Drives all feasible modes of a vehicle over ambient temperatures, ranked by energy at comfort."""
    from hp_gym.files import require_suffix
    from hp_gym.overrides import assignments
    from hp_gym.studies.heat_modes import comparing, modes_report

    began_s = perf_counter()
    try:
        if plot is not None:
            from hp_gym.pictures import picture_file
            from hp_gym.studies.heat_modes import modes_plot

            require_suffix(plot, picture_file.SUFFIXES)
        compared = comparing.compare(
            vehicle,
            cycle=cycle,
            controller=controller,
            ambients_degc=comparing.ambients(ambient),
            store_degc=store_degc,
            overrides=[*assignments(overrides), *(changes or [])],
            threads=threads,
        )
        if plot is not None:
            modes_plot.plot(compared, plot)
    except (ValueError, OSError) as error:
        fail(error)
    if json:
        print_json(compared.to_json())
        return
    console.print(modes_report.best_table(compared))
    console.print()
    console.print(modes_report.overall_table(compared, most))
    console.print(modes_report.closing_line(compared, perf_counter() - began_s))
    if plot is not None:
        console.print(f"Written: {plot}", markup=False, soft_wrap=True)
