"""The command line `hp-gym`."""

from typing import Annotated

import typer

from hp_gym.cli import interrupts
from hp_gym.cli.benchmark_command import benchmark
from hp_gym.cli.calibrate_command import calibrate
from hp_gym.cli.export_command import export
from hp_gym.cli.modes_command import modes
from hp_gym.cli.optimise_command import optimise
from hp_gym.cli.output import one_line_for_missing_packages
from hp_gym.cli.record_command import record
from hp_gym.cli.replay_command import replay
from hp_gym.cli.reproduce_command import reproduce
from hp_gym.cli.run_command import run
from hp_gym.cli.scenarios_command import scenarios
from hp_gym.cli.speed_command import speed
from hp_gym.cli.sweep_command import sweep
from hp_gym.cli.train_command import train
from hp_gym.cli.tune_command import tune
from hp_gym.cli.validate_command import validate
from hp_gym.cli.vehicle_command import vehicle
from hp_gym.ctrl_c import hook

app = typer.Typer(
    name="hp-gym",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
_AS_BEFORE = "nothing was written, and earlier results are as they were"
for command, kept in (
    (benchmark, _AS_BEFORE),
    (run, ""),
    (scenarios, ""),
    (vehicle, ""),
    (replay, _AS_BEFORE),
    (reproduce, _AS_BEFORE),
    (validate, _AS_BEFORE),
    (calibrate, _AS_BEFORE),
    (sweep, "runs so far are kept, and the same command goes on with them"),
    (optimise, "trials so far are kept, and the same command goes on with them"),
    (tune, "trials so far are kept, and the same command goes on with them"),
    (train, "nothing was written"),
    (export, _AS_BEFORE),
    (record, _AS_BEFORE),
    (modes, _AS_BEFORE),
    (speed, ""),
):
    app.command()(interrupts.stoppable(one_line_for_missing_packages(command), kept))


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
    hook()
    interrupts.run(app)
