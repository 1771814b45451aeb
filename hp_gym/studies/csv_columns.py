"""Columns of .csv files, by the names in their first line."""

import csv
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from hp_gym.files import read_bytes
from hp_gym.messages import OneLineError
from hp_gym.near_names import unknown

LARGEST_BYTES: Final = 64 * 2**20
"""Bytes of a file."""


class ColumnError(OneLineError):
    """A file of columns that cannot be used; the message names file, line or column, and what was allowed."""


@dataclass(frozen=True, eq=False)
class Columns:
    """Cells of a .csv file; blank lines, lines that begin with `#` and a byte-order mark do not count.

    Attributes:
        path: The file.
        names: Names of the columns.
        lines: Number of each row's line in the file, from 1.
        rows: Cells of each row, as many as there are names.
    """

    path: Path
    names: tuple[str, ...]
    lines: tuple[int, ...] = field(repr=False)
    rows: tuple[tuple[str, ...], ...] = field(repr=False)

    def numbers(self, name: str, *, gaps: bool = False) -> NDArray[np.float64]:
        """Returns a column.

        Args:
            name: Its name.
            gaps: Whether a cell may be empty or `nan`; it is NaN then.

        Raises:
            ColumnError: There is no such column, or a cell is no finite number.
        """
        if name not in self.names:
            raise ColumnError(f"{self.path}: {unknown('column', name, self.names)}")
        place = self.names.index(name)
        return np.array([
            self._number(name, line, row[place], gaps=gaps)
            for line, row in zip(self.lines, self.rows, strict=True)
        ])  # fmt: skip

    def _number(self, name: str, line: int, cell: str, *, gaps: bool) -> float:
        try:
            value = float(cell) if cell else math.nan
        except ValueError:
            value = math.inf
        if math.isfinite(value) or (gaps and math.isnan(value)):
            return value
        shown = f"`{cell}`" if cell else "empty"
        raise ColumnError(
            f"{self.path}: line {line}, column `{name}` is {shown}, but must be a finite number"
        )


def read(path: Path) -> Columns:
    """Reads a .csv file with a line of names.

    Raises:
        ColumnError: It is empty, a name stands there twice, or a row has more or fewer cells than names.
        FileError: It is no regular file, or larger than `LARGEST_BYTES`.
        OSError: It cannot be read.
    """
    text = read_bytes(path, LARGEST_BYTES).decode("utf-8-sig", errors="replace")
    told = [
        (number, [cell.strip() for cell in next(csv.reader([line]))])
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not told:
        raise ColumnError(f"{path}: is empty, but must have a line with names of columns")
    (_, names), *rows = told
    for place, name in enumerate(names):
        if name in names[:place]:
            raise ColumnError(f"{path}: column `{name}` is there twice")
    for line, cells in rows:
        if len(cells) < len(names):
            raise ColumnError(f"{path}: line {line} has no cell for column `{names[len(cells)]}`")
        if len(cells) > len(names):
            raise ColumnError(
                f"{path}: line {line} has {len(cells)} cells, but must have {len(names)}, one a column"
            )
    return Columns(
        path,
        tuple(names),
        tuple(line for line, _ in rows),
        tuple(tuple(cells) for _, cells in rows),
    )
