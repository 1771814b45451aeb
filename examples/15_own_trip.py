"""A trip of one's own: its speeds a CSV file, its weather and start a TOML file.

python examples/15_own_trip.py
"""

from pathlib import Path

import gymnasium as gym

import hp_gym

SCENARIO = Path(__file__).with_suffix(".toml")
PREHEATED_TO = "scenario.initial.cabin_temperature_degc"
OUTSIDE = "scenario.climate.ambient_temperature_degc"


def main() -> None:
    """Drives the trip as it is, cold, in other weather, and as an environment."""
    run = hp_gym.simulate(SCENARIO)
    total = run.summary
    print(f"{total['distance_km']:.1f} km in {total['duration_s']:.0f} s, {run.end_reason}")
    print(f"fastest {3.6 * run['speed_m_s'].max():.0f} km/h")
    cold = hp_gym.simulate(SCENARIO, overrides={PREHEATED_TO: -8.0}).summary
    for name, one in (("preheated", total), ("cold", cold)):
        print(f"{name}: {one['energy_kwh']:.2f} kWh, {one['discomfort_k']:.1f} K off target on average")
    swept = hp_gym.sweep({OUTSIDE: [-15.0, -8.0, 0.0, 8.0]}, SCENARIO).to_xarray()
    for degc, kwh in zip(swept["ambient_temperature_degc"].values, swept["energy_kwh"].values, strict=True):
        print(f"at {degc:g} degC {kwh:.2f} kWh")
    env = gym.make("EVHeatPump-v0", scenario=SCENARIO)
    env.reset(seed=0)
    print(f"environment: {Path(env.unwrapped.trip()['cycle']).name}")


if __name__ == "__main__":
    main()
