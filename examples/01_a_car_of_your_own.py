"""A car of one's own: one TOML file that says what differs from a car that is there, given by its path."""

from pathlib import Path

import gymnasium as gym

import hp_gym

CAR = Path(__file__).with_suffix(".toml")
SCENARIO = "ours/commute-minus5"


def main() -> None:
    """Drives the car by the rules, then makes an environment of it."""
    for name, car in {"jeffs2019": None, CAR.stem: CAR}.items():
        run = hp_gym.simulate(SCENARIO, vehicle=car)
        print(f"{name}: {run.summary['energy_kwh_per_100_km']:.1f} kWh/100 km, {run.end_reason}")
    env = gym.make("EVHeatPump-v0", vehicle=CAR, scenario=SCENARIO)
    env.reset(seed=0)
    print(f"environment of {Path(env.unwrapped.trip()['vehicle']).name}: {env.action_space}")


if __name__ == "__main__":
    main()
