"""Minari: trips recorded with their infos, read again, and the environment made again from the data set."""

import os
import tempfile

import gymnasium as gym
import numpy as np

import hp_gym  # noqa: F401, registers the ids

with tempfile.TemporaryDirectory() as folder:
    os.environ["MINARI_DATASETS_PATH"] = folder
    import minari

    for number, name in enumerate(("EVHeatPump-v0", "EVHeatPumpContinuous-v0", "EVHeatPumpFlat-v0")):
        made = gym.make(name, control_interval_s=10, info=["cost", "action_mask", "terms"])
        env = minari.DataCollector(made, record_infos=True)
        for seed in range(3):
            env.reset(seed=seed)
            over = False
            while not over:
                _, _, terminated, truncated, _ = env.step(env.action_space.sample())
                over = terminated or truncated
        env.create_dataset(f"evheatpump/random-v{number}", algorithm_name="random", author="hp_gym")
        env.close()
        data = minari.load_dataset(f"evheatpump/random-v{number}")
        assert data.total_episodes == 3
        again = data.recover_environment()
        for episode in data.iterate_episodes():
            keys = {"reward_energy", "cost", "action_mask", "attributable_energy_kwh"} & set(episode.infos)
            assert {"reward_energy", "cost", "action_mask"} <= keys, set(episode.infos)
            # Bit for bit the same trip when it is driven again.
            (told,) = data.storage.get_episode_metadata([episode.id])
            seen, _ = again.reset(seed=told["seed"])
            assert np.array_equal(seen, episode.observations[0])
            for action, following, reward in zip(
                episode.actions, episode.observations[1:], episode.rewards, strict=True
            ):
                seen, paid, *_ = again.step(action)
                assert np.array_equal(seen, following)
                assert paid == reward
        print(name, "steps", data.total_steps)
