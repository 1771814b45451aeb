"""The folder of a sweep: its definition, chunks of runs as they come, and one table at the end.

Each file is written beside its place and renamed: a process that is killed leaves whole files only, and the
next one drives what is missing.
"""

import json
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from hp_gym.files import atomic_write, read_bytes
from hp_gym.key_units import unit_of
from hp_gym.studies.planned_runs import Totals
from hp_gym.studies.sweep.sweep_plan import Plan, SweepError, difference

DEFINITION: Final = "sweep.json"
TABLE: Final = "sweep.parquet"
CHUNKS: Final = "chunks"
RUN: Final = "run"
END: Final = "end_reason"

_LARGEST_BYTES: Final = 64 * 2**20
_CHUNK_NAME: Final = re.compile(r"(\d{6,})\.parquet")
_KEPT_AS: Final = b"hp_gym.sweep"


class Folder:
    """The folder of a sweep.

    Args:
        path: Folder.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def read_definition(self) -> dict[str, Any] | None:
        """Returns the definition of the sweep in the folder; None where there is none.

        Raises:
            SweepError: There is a definition that cannot be read.
        """
        place = self.path / DEFINITION
        if not place.exists():
            return None
        try:
            found = json.loads(read_bytes(place, _LARGEST_BYTES))
        except (OSError, ValueError) as error:
            raise SweepError(f"{place}: {error}") from error
        if not isinstance(found, dict) or "axes" not in found:
            raise SweepError(f"{place}: is no definition of a sweep")
        return found

    def begin(self, definition: Mapping[str, Any]) -> None:
        """Makes the folder that of a sweep, or checks that it is.

        Raises:
            SweepError: It is that of another one, or holds something else.
            OSError: It cannot be written to.
        """
        there = self.read_definition()
        if there is not None:
            other = difference(there, definition)
            if other is not None:
                raise SweepError(f"{self.path}: holds another sweep: {other}; choose another folder")
        elif self.path.exists() and any(self.path.iterdir()):
            raise SweepError(f"{self.path}: is not empty and holds no sweep; choose another folder")
        else:
            self.path.mkdir(parents=True, exist_ok=True)
            with atomic_write(self.path / DEFINITION) as temporary:
                text = json.dumps(definition, indent=2, ensure_ascii=False)
                temporary.write_text(text, encoding="utf-8")
        if not self.complete:
            (self.path / CHUNKS).mkdir(exist_ok=True)

    @property
    def complete(self) -> bool:
        """Whether the table of all runs is there."""
        return (self.path / TABLE).exists()

    def chunks(self) -> dict[int, Path]:
        """Files of chunks that are whole, by number, in order."""
        folder = self.path / CHUNKS
        if not folder.is_dir():
            return {}
        found = {}
        for path in sorted(folder.iterdir()):
            name = _CHUNK_NAME.fullmatch(path.name)
            if name is not None and _is_whole(path):
                found[int(name[1])] = path
        return dict(sorted(found.items()))

    def write_chunk(self, number: int, table: pa.Table) -> None:
        """Writes the runs of a chunk, all or none.

        Raises:
            OSError: The file cannot be written.
        """
        with atomic_write(self.path / CHUNKS / f"{number:06d}.parquet") as temporary:
            pq.write_table(table, temporary)

    def tables(self) -> Iterator[pa.Table]:
        """Yields what there is of the runs, part by part, in order."""
        if self.complete:
            file = pq.ParquetFile(self.path / TABLE)
            for group in range(file.num_row_groups):
                yield file.read_row_group(group)
        else:
            for path in self.chunks().values():
                yield pq.read_table(path)

    def finish(self, definition: Mapping[str, Any]) -> None:
        """Puts all chunks into one table, one after the other, and removes them.

        Raises:
            OSError: The table cannot be written.
        """
        paths = self.chunks().values()
        schema = pa.unify_schemas([pq.read_schema(path).remove_metadata() for path in paths])
        schema = schema.with_metadata({_KEPT_AS: json.dumps(definition, ensure_ascii=False).encode()})
        with atomic_write(self.path / TABLE) as temporary, pq.ParquetWriter(temporary, schema) as writer:
            for path in paths:
                writer.write_table(_filled(pq.read_table(path), schema))
        shutil.rmtree(self.path / CHUNKS, ignore_errors=True)


def _is_whole(path: Path) -> bool:
    try:
        return int(pq.read_metadata(path).num_rows) > 0
    except (OSError, pa.ArrowException):
        return False


def _filled(table: pa.Table, schema: pa.Schema) -> pa.Table:
    """A table with the columns of a schema; NaN where it has none."""
    columns = []
    for field in schema:
        if field.name in table.column_names:
            columns.append(table.column(field.name))
        else:
            columns.append(pa.array(np.full(len(table), np.nan)))
    return pa.table(columns, schema=schema)


def to_table(plan: Plan, runs: Sequence[int], totals: Totals) -> pa.Table:
    """Makes the table of a chunk: number, values of the axes, why it ended, totals, each with its unit."""
    columns: dict[str, Any] = {RUN: np.asarray(runs, dtype=np.int64), **plan.labels(runs)}
    columns[END] = list(totals.ends)
    units = {axis.name: axis.unit for axis in plan.axes}
    columns |= {name: totals.values[:, place] for place, name in enumerate(totals.names)}
    arrays = [pa.array(column) for column in columns.values()]
    fields = [
        pa.field(name, array.type, metadata={"unit": units.get(name) or unit_of(name)})
        for name, array in zip(columns, arrays, strict=True)
    ]
    return pa.table(arrays, schema=pa.schema(fields))
