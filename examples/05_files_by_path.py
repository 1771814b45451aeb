"""Scenario, reward and distribution by path; a path inside a file counts from the folder of that file."""

from pathlib import Path

import gymnasium as gym

import hp_gym

FOLDER = Path(__file__).parent
SCENARIO, REWARD, DISTRIBUTION = (
    FOLDER / f"05_{kind}.toml" for kind in ("scenario", "reward", "distribution")
)


def main() -> None:
    """Drives the scenario, then trips drawn from the distribution."""
    run = hp_gym.simulate(SCENARIO)
    controller = Path(run.controller).name
    print(f"{SCENARIO.name}: {run.end_reason}, {run.summary['energy_kwh']:.2f} kWh by {controller}")
    env = gym.make("EVHeatPump-v0", distribution=DISTRIBUTION, reward=REWARD)
    for seed in range(3):
        env.reset(seed=seed)
        score, over = 0.0, False
        while not over:
            _, reward, over, _, _ = env.step(env.unwrapped.rule_based_action())
            score += float(reward)
        trip, kpis = env.unwrapped.trip(), env.unwrapped.kpis()
        print(
            f"trip {seed}: {trip['cycle']} at {trip['ambient_temperature_degc']:.0f} degC, "
            f"{kpis['discomfort_k']:.1f} K off target, {score:.0f} points"
        )


if __name__ == "__main__":
    main()
