"""The plant's refrigeration loop at 20 points and its compressor's efficiencies, for what checks them."""

import csv
import math
import subprocess
import tomllib
from pathlib import Path
from typing import Any

Point = dict[str, Any]
"""A row of the example `refrigeration_points`."""


def rust_points(*arguments: str) -> tuple[dict[str, Any], list[Point]]:
    """Parameters and operating points as the Rust example prints them.

    Args:
        arguments: The example's own: refrigerant, kind of injection, share of the loss in the gas.
    """
    command = ["cargo", "run", "--quiet", "--release", "--example", "refrigeration_points", "--", *arguments]
    root = Path(__file__).parents[1]
    text = subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout
    lines = text.splitlines()
    parameters = tomllib.loads("\n".join(line[2:] for line in lines if line.startswith("# ")))
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    points = [{key: value if key == "status" else float(value) for key, value in row.items()} for row in rows]
    return parameters, points


def efficiencies(compressor: dict[str, float], ratio: float, speed: float) -> tuple[float, float]:
    """Volumetric and isentropic efficiency of the whole machine."""
    leakage = (
        compressor["leakage_share"]
        * (compressor["minimum_speed_rev_s"] / speed)
        * (ratio - 1.0)
        / math.sqrt(ratio / 2.0)
    )
    filling = compressor["volumetric_efficiency_at_unity"] * math.exp(
        -compressor["volumetric_efficiency_slope"] * (ratio - 1.0)
    )
    extra_work = (
        compressor["isentropic_pressure_ratio_loss"]
        * math.log(ratio / compressor["isentropic_peak_pressure_ratio"]) ** 2
        + compressor["isentropic_speed_loss"] * (speed / compressor["maximum_speed_rev_s"] - 0.5) ** 2
    )
    isentropic = compressor["isentropic_efficiency_peak"] / (1.0 + extra_work) / (1.0 + leakage)
    return filling / (1.0 + leakage), isentropic
