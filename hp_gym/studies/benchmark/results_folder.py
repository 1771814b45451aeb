"""The files of a benchmark's results."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from hp_gym.json_text import dumps

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import pandas as pd

    from hp_gym.studies.benchmark.results import Benchmark

RUNS: Final = "results.parquet"
FRONTS: Final = "fronts.parquet"
FRONT_RUNS: Final = "front-runs.parquet"
SUMMARY: Final = "summary.json"
REPORT: Final = "report.html"
RUN: Final = "run.json"


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
    path.write_text(f"{dumps(data)}\n", encoding="utf-8")
