"""RLlib: PPO on the default and the continuous id, two local environments a runner."""

import gymnasium as gym
import ray
from ray.rllib.algorithms.ppo import PPOConfig
from ray.tune.registry import register_env

import hp_gym  # noqa: F401, registers the ids

ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, configure_logging=False)
for name in ("EVHeatPump-v0", "EVHeatPumpContinuous-v0", "EVHeatPumpFlat-v0"):
    register_env(name, lambda config, name=name: gym.make(name, **config))
    config = (
        PPOConfig()
        .environment(name, env_config={"control_interval_s": 10})
        .env_runners(num_env_runners=0, num_envs_per_env_runner=2)
        .training(train_batch_size=1500, minibatch_size=500, num_epochs=1)
    )
    algorithm = config.build_algo()
    for _ in range(2):
        result = algorithm.train()
    assert result["num_env_steps_sampled_lifetime"] >= 3000
    assert result["env_runners"]["num_episodes_lifetime"] > 0
    print(name, result["env_runners"]["episode_return_mean"])
    algorithm.stop()
ray.shutdown()
