"""What notebooks show of results: a small table and a picture, as HTML that needs nothing beside it."""

from __future__ import annotations

import base64
import html
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


def table(title: str, rows: Iterable[tuple[str, str, str]]) -> str:
    """Returns a table of names, values and units."""
    cells = "".join(
        f"<tr><td>{html.escape(name)}</td><td style='text-align: right'>{html.escape(value)}</td>"
        f"<td>{html.escape(unit)}</td></tr>"
        for name, value, unit in rows
    )
    return f"<table><caption>{html.escape(title)}</caption>{cells}</table>"


def picture(draw: Callable[[Path], object]) -> str:
    """Returns an image.

    Args:
        draw: Writes it to the .png file that it is given.
    """
    with TemporaryDirectory() as folder:
        path = Path(folder) / "picture.png"
        draw(path)
        data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f"<img style='max-width: 100%' src='data:image/png;base64,{data}'>"
