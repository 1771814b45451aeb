"""Set points of the HPCU at -7 degC: the front of energy and discomfort, and a controller of its best trial.

python examples/10_optimise.py [FOLDER [TRIALS]]
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import hp_gym

COLD = {
    "scenario.climate.ambient_temperature_degc": -7.0,
    "scenario.initial.soak_temperature_degc": -7.0,
}
AXES = {
    "htc_set_point_degc": (40.0, 90.0),
    "controller.cabin_set_point_degc": (18.0, 24.0),
    "heat_up_to_degc": (0.0, 20.0),
}


def main(folder: Path, trials: int = 64) -> None:
    """Searches, and drives the most comfortable trial of the front by its file."""
    found = hp_gym.optimise(
        AXES, ["energy_kwh", "discomfort_k"], overrides=COLD, trials=trials, out=folder / "search"
    )
    found.plot(folder / "front.png")
    found.write()
    print(f"{len(found.trials)} trials, {len(found.front)} on the front")
    for trial in (found.front[0], found.front[-1]):
        energy_kwh, discomfort_k = trial.values
        print(f"trial {trial.number}: {energy_kwh:.2f} kWh, {discomfort_k:.1f} K off target")
    file = folder / "search" / "front" / f"trial-{found.front[-1].number}.toml"
    run = hp_gym.simulate("jeffs2019/case1-1", overrides=file)
    print(f"driven again by its file: {run.summary['energy_kwh']:.2f} kWh")


if __name__ == "__main__":
    chosen = int(sys.argv[2]) if len(sys.argv) > 2 else 64
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]), chosen)
    else:
        with TemporaryDirectory() as temporary:
            main(Path(temporary), chosen)
