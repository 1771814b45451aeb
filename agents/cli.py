"""The command line `hp-gym`."""

from typing import Annotated

import typer

from agents.commands.benchmark import benchmark
from agents.commands.calibrate import calibrate
from agents.commands.export import export
from agents.commands.reproduce import reproduce
from agents.commands.run import run
from agents.commands.scenarios import scenarios
from agents.commands.speed import speed
from agents.commands.train import train
from agents.commands.tune import tune

app = typer.Typer(
    name="hp-gym",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
for command in (
    benchmark,
    run,
    scenarios,
    reproduce,
    calibrate,
    tune,
    train,
    export,
    speed,
):
    app.command()(command)


def _print_version(wanted: bool) -> None:
    if wanted:
        from hp_gym import __version__

        typer.echo(f"hp-gym {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    *,
    version: Annotated[
        bool,
        typer.Option("--version", help="Show the version and stop.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """An electric vehicle's heat pump and thermal system, simulated."""
    del version


def main() -> None:
    """Runs the command line."""
    app()
