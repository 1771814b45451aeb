"""`hp-gym scenarios`: what can be run."""

from typing import Annotated

import typer

from hp_gym.cli.output import console, fail, print_json


def scenarios(
    *,
    json: Annotated[bool, typer.Option("--json", help="Print the list as JSON.")] = False,
) -> None:
    """Lists the scenarios that can be run."""
    from rich.table import Table

    from hp_gym import ConfigurationError, Experiment, names

    try:
        experiments = {name: Experiment(name) for name in names("scenario")}
    except ConfigurationError as error:
        fail(error)
    if json:
        rows = [
            {
                "id": name,
                "description": experiment.description,
                "vehicle": experiment.vehicle,
                "cycle": experiment.cycle,
                "controller": experiment.controller,
                "ambient_temperature_degc": experiment.ambient_temperature_degc,
                "duration_s": experiment.duration_s,
                "distance_km": experiment.distance_m / 1000.0,
            }
            for name, experiment in experiments.items()
        ]
        print_json({"scenarios": rows})
        return
    table = Table(box=None, header_style="bold", pad_edge=False)
    table.add_column("Scenario", no_wrap=True, style="cyan")
    table.add_column("Ambient", justify="right", no_wrap=True)
    table.add_column("Cycle", no_wrap=True)
    table.add_column("What it is")
    for name, experiment in experiments.items():
        ambient = f"{experiment.ambient_temperature_degc:.0f} °C"
        table.add_row(name, ambient, experiment.cycle, experiment.description)
    console.print(table)
