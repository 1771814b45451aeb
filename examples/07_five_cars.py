"""The five cars of `examples/cars` in one vector environment, under the rules, and a picture of each.

python examples/07_five_cars.py [FOLDER FOR PICTURES]
"""

import sys
from pathlib import Path
from typing import Any

import gymnasium as gym

import hp_gym  # noqa: F401

CARS = sorted(Path(__file__).with_name("cars").glob("*.toml"))
SCENARIO = "ours/commute-minus5"
MINUTES = 5


def main(folder: Path | None = None) -> None:
    """Drives all five side by side for some minutes."""
    envs: Any = gym.make_vec(
        "EVHeatPump-v0", num_envs=len(CARS), vehicle=CARS, scenario=SCENARIO, render_mode="rgb_array"
    )
    envs.reset(seed=0)
    for _ in range(60 * MINUTES):
        envs.step(envs.rule_based_actions())
    for index, car in enumerate(CARS):
        signals = envs.signals(index)
        residual = abs(signals["energy_residual_w"]) / signals["energy_scale_w"]
        cabin_degc = signals["cabin_temperature_degc"]
        print(f"{car.stem}: cabin at {cabin_degc:.1f} degC, energy ledger within {residual:.0e}")
    if folder is not None:
        from PIL import Image

        for car, picture in zip(CARS, envs.render(), strict=True):
            Image.fromarray(picture).save(folder / f"{car.stem}.png")
            print(f"Written: {folder / car.stem}.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
