"""What a benchmark found, as one value: tables, summary, trajectories."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import pandas as pd

IDENTITY: Final = (
    "controller",
    "seed",
    "scenario",
    "variant",
    "cycle",
    "ambient_temperature_degc",
    "band",
    "end_reason",
)
"""Columns of a run that say what it is; all others are KPIs.

`seed` is -1 for controllers that have none. `end_reason` is `arrived`, `battery_empty`, `immobile` or `late`.
"""

KPIS: Final = (
    "attributable_energy_kwh",
    "attributable_energy_kwh_per_100_km",
    "discomfort_k",
    "heat_left_kwh",
    "duration_s",
    "delay_s",
    "distance_km",
    "energy_kwh",
    "chemical_energy_kwh",
    "reference_energy_kwh",
    "compressor_energy_kwh",
    "ptc_energy_kwh",
    "pump_energy_kwh",
    "blower_energy_kwh",
    "fan_energy_kwh",
    "range_km",
    "final_soc_pct",
    "time_to_comfort_s",
    "comfortable_share_pct",
    "time_to_near_comfort_s",
    "outside_near_comfort_k_s",
    "discomfort_afterwards_k",
    "equivalent_time_to_near_comfort_s",
    "equivalent_outside_near_comfort_k_s",
    "equivalent_discomfort_afterwards_k",
    "fog_s",
    "co2_above_1500_ppm_s",
    "battery_window_k_h",
    "protection_trips",
    "compressor_starts",
    "limit_breaches",
    "stranded",
)
"""KPIs of a run in the order of the table; docs/benchmark.md defines each."""

VERDICTS: Final = ("in_time", "comfortable", "in_good_air", "passes", "passes_equivalent")
"""Columns of a run that say whether its comfort is accepted (`hp_gym.comfort_standard`)."""

FRONT_COLUMNS: Final = (
    "family",
    "cabin_offset_k",
    "htc_offset_k",
    "ptc_offset_k",
    "attributable_energy_kwh",
    "discomfort_k",
    "heat_left_kwh",
    "stranded_trips",
)
"""Columns of the fronts: a row for each family of rules and combination of set points.

Energy and heat are means per trip over the bands of the headline, discomfort is the mean over occupied time.
Offsets are against the family's own set points, in all its ambient bands alike.
"""


@dataclass(frozen=True, eq=False)
class Benchmark:
    """Everything that a benchmark found.

    Attributes:
        runs: One row for each controller, seed and scenario, with the columns `IDENTITY`, `KPIS`
            and `VERDICTS`.
        fronts: What the rules reach with other set points, with the columns `FRONT_COLUMNS`.
        summary: What `summary.json` holds; docs/benchmark.md lists its keys.
        trajectories: Signals second by second of a few scenarios, by scenario, then by controller (learned
            ones with their lowest seed); columns as of `hp_gym.Trajectory`.
        ablations: Figures of the ablation policies by name, as `summary["gains"]` has them; None without any.
    """

    runs: pd.DataFrame
    fronts: pd.DataFrame
    summary: dict[str, Any]
    trajectories: dict[str, dict[str, pd.DataFrame]]
    ablations: dict[str, Any] | None = None
