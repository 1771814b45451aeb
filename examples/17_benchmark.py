"""A controller of one's own over held-out trips: what it gains over rules at equal comfort, with intervals.

python examples/17_benchmark.py [FOLDER]
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import ClassVar

import numpy as np
import pandas as pd
from rich.console import Console

from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.studies.benchmark.request import Request, carry_out

GRID = Path(__file__).with_suffix(".toml")
OWN = f"{Path(__file__).stem}:EarlyOff"


class EarlyOff:
    """The rules, but the PTC heater is off once the cabin has 15 degC."""

    environment: ClassVar = {"actions": "hpcu", "continuous": True}

    def begin(self, env: EVHeatPumpVectorEnv) -> None:
        """Called before each set of trips, all of them at their start."""
        self.env, self.ptc = env, env.action_names.index("ptc")

    def predict(self, observations: np.ndarray) -> np.ndarray:
        """Actions of all trips, one row each."""
        actions = self.env.rule_based_actions()
        trips = range(len(observations))
        cabin_degc = np.array([self.env.signals(trip)["cabin_temperature_degc"] for trip in trips])
        actions[cabin_degc > 15.0, self.ptc] = -1.0
        return actions


def main(folder: Path) -> None:
    """Drives it beside the rules and tells what it gains."""
    done = carry_out(Request([OWN, "hpcu"], str(GRID), None, 0, folder / "result"), Console(stderr=True))
    print(f"{done.trips} trips, {len(done.benchmark.runs)} of them by the controllers that are compared")
    runs = pd.read_parquet(folder / "result" / "results.parquet")
    means = runs.groupby("controller")[["attributable_energy_kwh", "discomfort_k"]].mean()
    for name, row in means.iterrows():
        energy_kwh, discomfort_k = row
        print(f"{name.rpartition(':')[2]}: {energy_kwh:.2f} kWh, {discomfort_k:.1f} K off target")
    for name, gain in done.benchmark.summary["gains"].items():
        (low, high), energy_pct = gain["ci95"], gain["attributable_energy_pct"]
        # No gain is told where a trip strands or no setting of the rules is as comfortable.
        told = (
            gain["matched"]
            if energy_pct is None
            else f"{energy_pct:+.1f} % energy ({low:+.1f} .. {high:+.1f})"
        )
        print(f"{name.partition(':')[2]}: {told}")
    print(f"report: {(folder / 'result' / 'report.html').stat().st_size} bytes")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        with TemporaryDirectory() as temporary:
            main(Path(temporary))
