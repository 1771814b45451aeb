"""What every command shares: results on standard output, and how a command fails."""

from typing import Final, NoReturn

import typer
from rich.console import Console

from hp_gym.messages import in_one_line

console: Final = Console(highlight=False)
"""For results that people read."""

USAGE_ERROR: Final = 2


def print_json(data: object) -> None:
    """Prints data as JSON; a number that JSON does not have becomes null."""
    # NumPy is slow to load: only commands that have loaded it anyway come here.
    from hp_gym.json_text import dumps

    typer.echo(dumps(data))


def fail(reason: str | Exception) -> NoReturn:
    """Ends the command with one line on standard error.

    Raises:
        typer.Exit: Always, with exit code 2.
    """
    message = str(reason)
    if isinstance(reason, OSError) and reason.strerror and reason.filename:
        message = f"{reason.filename}: {reason.strerror}"
    typer.echo(f"hp-gym: {in_one_line(message)}", err=True)
    raise typer.Exit(USAGE_ERROR)
