"""`hp-gym replay`: a measured trip driven by the model."""

from pathlib import Path
from typing import Annotated

import typer

from hp_gym.cli.output import console, fail, print_json


def replay(
    vehicle: Annotated[str, typer.Argument(help="Name or path of a vehicle.")],
    trace: Annotated[
        Path,
        typer.Argument(
            metavar="TRACE.csv",
            help="The trip: time_s, a speed, weather, settings, and what was measured in columns measured_*.",
        ),
    ],
    *,
    scenario: Annotated[
        str | None,
        typer.Option(help="Name or path of a scenario that gives what the trace does not say."),
    ] = None,
    controller: Annotated[
        str | None,
        typer.Option(
            help="Name or path of a controller; the scenario's own by default, hpcu-modern without one."
        ),
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Change a value, for example scenario.initial.state_of_charge_pct=55. "
            "A key begins with scenario., vehicle. or controller.; may be repeated.",
        ),
    ] = None,
    overrides: Annotated[
        Path | None, typer.Option(help="A .toml file of changes, as `calibrate` and `optimise` write.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the figures, the comparison and all signals.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw measured and model to this .png, .svg or .pdf file.")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON.")] = False,
) -> None:
    """Drives a measured trip and sets what was measured beside the model."""
    from hp_gym.files import require_suffix
    from hp_gym.overrides import assignments
    from hp_gym.studies.replay import replay_report
    from hp_gym.studies.replay.replaying import replay as drive
    from hp_gym.terminal import progress_console

    try:
        if plot is not None:
            from hp_gym.pictures import picture_file

            require_suffix(plot, picture_file.SUFFIXES)
        replayed = drive(
            vehicle,
            trace,
            scenario=scenario,
            controller=controller,
            overrides=[*assignments(overrides), *(changes or [])],
            out=out,
        )
        if plot is not None:
            replayed.plot(plot)
    except (ValueError, OSError) as error:
        fail(error)
    for warning in replayed.warnings:
        progress_console.print(warning, markup=False)
    if json:
        print_json(replayed.to_json())
        return
    console.print(replay_report.figure_table(replayed))
    if replayed.errors:
        console.print(replay_report.error_table(replayed.errors))
    for note in replayed.notes:
        console.print(note, markup=False)
    for path in (out, plot):
        if path is not None:
            console.print(f"Written: {path}", markup=False, soft_wrap=True)
