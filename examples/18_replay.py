"""One's own car on one's own trip, and what was measured on it beside the model.

python examples/18_replay.py
"""

import csv
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import hp_gym
from hp_gym.studies.replay.replaying import Replay

CAR = Path(__file__).with_suffix(".toml")
LOG = Path(__file__).with_name("18_trip.csv")
START = {"scenario.initial.state_of_charge_pct": 60.0}
ERRORS = {
    "battery_power_w": 300.0,
    "heater_power_w": 50.0,
    "cabin_temperature_degc": 0.2,
    "battery_temperature_degc": 0.2,
}
"""Standard deviations of what the car's bus tells."""


def main() -> None:
    """Drives the log, makes measurements of that drive, and replays those."""
    trip = hp_gym.replay(CAR, LOG, overrides=START)
    run = trip.trajectory
    print(f"{run.summary['distance_km']:.1f} km, {run.end_reason}, {run.summary['energy_kwh']:.2f} kWh")
    ambient_degc = run["ambient_temperature_degc"]
    print(f"from {ambient_degc[0]:.1f} to {ambient_degc.min():.1f} degC, climbing {climbed_m():.0f} m")
    highest_bar, limit_bar = (
        run["condensing_pressure_bar"].max(),
        run.limits["condensing_pressure_highest_bar"],
    )
    print(f"propane: {highest_bar:.1f} bar at most, the table allows {limit_bar:.0f}")
    with TemporaryDirectory() as folder:
        measured = measure(trip, Path(folder) / "measured.csv")
        again = hp_gym.replay(CAR, measured, overrides=START)
    for name, pair in again.figures.items():
        print(f"{name}: measured {pair.measured:.2f}, model {pair.model:.2f}")
    for error in again.errors:
        print(f"{error.quantity.label}: {error.bias:+.2f} {error.quantity.unit} in the mean")


def climbed_m() -> float:
    """Metres uphill, of speeds and slopes once a second."""
    with LOG.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return sum(float(row["speed_km_h"]) / 3.6 * max(0.0, float(row["grade_pct"])) / 100.0 for row in rows)


def measure(trip: Replay, path: Path) -> Path:
    """Writes the log with what the car would measure, were it as the model says."""
    random = np.random.default_rng(0)
    with LOG.open(encoding="utf-8") as file:
        head, *rows = csv.reader(line for line in file if not line.startswith("#"))
    told = {name: trip.model[name] + random.normal(0.0, ERRORS[name], len(rows)) for name in ERRORS}
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*head, *(f"measured_{name}" for name in told)])
        for second, row in enumerate(rows):
            writer.writerow([*row, *(f"{values[second]:.2f}" for values in told.values())])
    return path


if __name__ == "__main__":
    main()
