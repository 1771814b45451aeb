"""Ctrl-C while the libraries of the command `hp-gym` are loaded: one line, no traceback."""

import os
import sys
from pathlib import Path
from types import TracebackType
from typing import Final

INTERRUPTED: Final = 130
"""Exit code of a command that Ctrl-C has ended."""


def hook() -> None:
    """Lets Ctrl-C outside of commands end the process with one line and `INTERRUPTED`."""
    before = sys.excepthook

    def tell(kind: type[BaseException], error: BaseException, traceback: TracebackType | None) -> None:
        if not issubclass(kind, KeyboardInterrupt):
            before(kind, error, traceback)
            return
        os.write(2, b"hp-gym: stopped\n")
        # Python itself would end by the signal, without an exit code.
        os._exit(INTERRUPTED)

    sys.excepthook = tell


# In other processes it is not for this package to say what Ctrl-C does.
if sys.argv and Path(sys.argv[0]).stem == "hp-gym":
    hook()
