"""Rows of an environment by name: what an agent moves, sees and is paid for, and the settings."""

import gymnasium as gym

import hp_gym  # noqa: F401

SCENARIO = "ours/commute-minus5"


def main() -> None:
    """Makes an environment of chosen rows and drives for a minute at random."""
    env = gym.make(
        "EVHeatPump-v0",
        scenario=SCENARIO,
        continuous=True,
        actions=["compressor_power", "blower_level", "cabin"],
        observations=["cabin_temperature_degc", "time_left_s", "cop", "preview"],
        reward={"base": "balanced", "battery_window_per_k_h": 1.0},
        control_interval_s=10,
        sensor_noise=0.01,
    )
    env.reset(seed=0)
    env.action_space.seed(0)
    print("actions:", *env.unwrapped.action_names)
    print("observations:", *[row[0] for row in env.unwrapped._episode.observation_rows()])
    for _ in range(6):
        _, _, _, _, info = env.step(env.action_space.sample())
    print(
        "parts of the reward:",
        *[f"{name} {value:.4f}" for name, value in info.items() if name[:6] == "reward"],
    )


if __name__ == "__main__":
    main()
