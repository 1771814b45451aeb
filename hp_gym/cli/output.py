"""What every command shares: results on standard output, and how a command fails."""

import functools
from collections.abc import Callable
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


def _by_ctrl_c(error: BaseException | None) -> bool:
    """Whether an error came of a Ctrl-C."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            return True
        error = error.__cause__ or error.__context__
    return False


def one_line_for_missing_packages(command: Callable[..., None]) -> Callable[..., None]:
    """Wraps a command so that a package or system library that cannot be loaded ends it with one line."""

    @functools.wraps(command)
    def wrapped(*arguments: object, **options: object) -> None:
        try:
            command(*arguments, **options)
        except ImportError as error:
            # Extensions written with pybind11 turn a Ctrl-C while they are loaded into this error.
            if _by_ctrl_c(error):
                raise KeyboardInterrupt from None
            # A module of our own that is not there is a bug, and its traceback tells where.
            if (error.name or "").partition(".")[0] == "hp_gym":
                raise
            fail(error)

    return wrapped
