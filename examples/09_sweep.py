"""A sweep: battery size x ambient x set point of the HTC, as a labelled table and a picture; what matters.

python examples/09_sweep.py [FOLDER FOR THE PICTURE]
"""

import sys
from pathlib import Path

import hp_gym
from hp_gym.studies.axes import Between


def main(folder: Path | None = None) -> None:
    """Drives a grid, then a sample."""
    axes = {
        "cell_capacity_ah": [40, 60],
        "ambient_temperature_degc": [-10, 0, 10],
        "htc_set_point_degc": [50, 85],
    }
    swept = hp_gym.sweep(axes, "jeffs2019/case1-1")
    data = swept.to_xarray()
    best = data["energy_kwh"].idxmin("htc_set_point_degc")
    print(f"{data['energy_kwh'].size} runs, energy in {data['energy_kwh'].attrs['units']}")
    for ambient_degc in data["ambient_temperature_degc"].values:
        chosen = float(best.sel(cell_capacity_ah=60, ambient_temperature_degc=ambient_degc))
        print(f"at {ambient_degc:g} degC the least energy with the HTC at {chosen:g} degC")
    if folder is not None:
        swept.plot(folder / "sweep.png")
        print(f"Written: {folder / 'sweep.png'}")
    ranges = {"vehicle.body.mass_kg": Between(1500, 2500), "ambient_temperature_degc": Between(-10, 20)}
    table = hp_gym.sweep(ranges, "jeffs2019/case1-1", sample="saltelli", count=32).sensitivities("energy_kwh")
    for name, row in table.iterrows():
        print(f"{name} explains {100.0 * row['ST']:.0f} % of the variance, alone or with others")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
