"""Options of the commands that drive many runs."""

from pathlib import Path
from typing import Annotated

import typer

Controller = Annotated[str | None, typer.Option(help="Name or path of a controller.")]
Vehicle = Annotated[str | None, typer.Option(help="Name or path of a vehicle.")]
Changes = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a value in all runs.")
]
Overrides = Annotated[
    Path | None, typer.Option(help="A .toml file of changes for all runs, as `calibrate` writes.")
]
Threads = Annotated[int | None, typer.Option(min=1, help="Native threads; one a processor.")]
