"""The folder of results: all of them are replaced, or none."""

from __future__ import annotations

import json
import math
import os
import secrets
import shutil
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path

    import pandas as pd

    from hp_gym.studies.benchmark.results import Benchmark

RUNS: Final = "results.parquet"
FRONTS: Final = "fronts.parquet"
FRONT_RUNS: Final = "front-runs.parquet"
SUMMARY: Final = "summary.json"
REPORT: Final = "report.html"
RUN: Final = "run.json"


@contextmanager
def new_contents(folder: Path) -> Generator[Path]:
    """Gives an empty folder whose contents take their places in `folder` if the block succeeds.

    If it does not, everything in `folder` stays as it was. What has no successor stays in either case.

    Raises:
        OSError: The folder cannot be made or written to; the message names it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    temporary = folder / f".new.{secrets.token_hex(4)}"
    try:
        temporary.mkdir()
    except OSError as error:
        raise OSError(error.errno, os.strerror(error.errno or 0), str(folder)) from error
    try:
        yield temporary
        for entry in sorted(temporary.iterdir()):
            _replace(entry, folder / entry.name)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _replace(new: Path, old: Path) -> None:
    if old.is_dir():
        # A folder cannot be replaced in one go: what was there goes first, under a name that is deleted.
        old.rename(new.with_name(f"{old.name}.old"))
    new.replace(old)


def write(benchmark: Benchmark, front_runs: pd.DataFrame, folder: Path) -> None:
    """Writes tables and summary.

    Raises:
        OSError: A file cannot be written.
    """
    benchmark.runs.to_parquet(folder / RUNS, index=False)
    benchmark.fronts.to_parquet(folder / FRONTS, index=False)
    front_runs.to_parquet(folder / FRONT_RUNS, index=False)
    write_json(benchmark.summary, folder / SUMMARY)


def write_json(data: Mapping[str, Any], path: Path) -> None:
    """Writes data as JSON; a number that JSON does not have becomes null.

    Raises:
        OSError: The file cannot be written.
    """
    text = json.dumps(plain(data), indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(f"{text}\n", encoding="utf-8")


def plain(data: Any) -> Any:
    """Returns data as JSON can hold it."""
    if isinstance(data, float) and not math.isfinite(data):
        return None
    if isinstance(data, Mapping):
        return {str(key): plain(value) for key, value in data.items()}
    if isinstance(data, Sequence) and not isinstance(data, str):
        return [plain(value) for value in data]
    return data
