"""What Ctrl-C does, and memory that does not suffice: one line on standard error."""

import functools
import os
import signal
import sys
import warnings
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import typer

from hp_gym.cli.output import fail
from hp_gym.ctrl_c import INTERRUPTED
from hp_gym.messages import UncheckedFileWarning, in_one_line

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


_told = False


def stopped(kept: str = "") -> None:
    """Tells that a command was stopped, and what of its work is kept."""
    global _told  # noqa: PLW0603, a process is stopped once
    _told = True
    typer.echo(f"hp-gym: stopped{'; ' if kept else ''}{kept}", err=True)


def run(app: typer.Typer) -> None:
    """Runs a command line; where Ctrl-C comes outside of a command, it is told all the same.

    Raises:
        SystemExit: Always, with the exit code.
    """
    warnings.showwarning = _note(warnings.showwarning)
    try:
        app()
    except SystemExit as end:
        # Typer ends without a word.
        if end.code == INTERRUPTED:
            if not _told:
                stopped()
            sys.stdout.flush()
            sys.stderr.flush()
            # What was to be kept is written; taking large libraries down in order would take seconds.
            os._exit(INTERRUPTED)
        raise
    finally:
        # The work is done: nothing is left to stop, and the exit code is decided.
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _note(before: Callable[..., None]) -> Callable[..., None]:
    """Shows notes of this package in one line, without the line of code that they come from."""

    def show(message: Warning | str, category: type[Warning], *others: Any) -> None:
        if issubclass(category, UncheckedFileWarning):
            typer.echo(f"hp-gym: note: {in_one_line(str(message))}", err=True)
        else:
            before(message, category, *others)

    return show


def stoppable(command: Callable[_Parameters, _Result], kept: str = "") -> Callable[_Parameters, _Result]:
    """Lets a command end with one line where the user stops it or memory does not suffice.

    Args:
        command: The command.
        kept: What is kept of its work.
    """

    @functools.wraps(command)
    def call(*args: _Parameters.args, **kwargs: _Parameters.kwargs) -> _Result:
        try:
            return command(*args, **kwargs)
        except KeyboardInterrupt:
            stopped(kept)
            raise typer.Exit(INTERRUPTED) from None
        except MemoryError:
            fail("memory does not suffice for what was asked for")

    return call
