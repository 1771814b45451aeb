"""stable-baselines3: its checker, PPO on the default and the continuous id, DQN on the flat one."""

import gymnasium as gym
import torch
from stable_baselines3 import DQN, PPO
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.env_util import make_vec_env

torch.set_num_threads(1)
for name in ("EVHeatPump-v0", "EVHeatPumpContinuous-v0", "EVHeatPumpFlat-v0"):
    check_env(gym.make(f"hp_gym:{name}"))
for name in ("EVHeatPump-v0", "EVHeatPumpContinuous-v0"):
    envs = make_vec_env(f"hp_gym:{name}", n_envs=4, seed=0, env_kwargs={"control_interval_s": 10})
    model = PPO("MlpPolicy", envs, n_steps=256, batch_size=256, n_epochs=2, seed=0).learn(4096)
    assert model.ep_info_buffer, "no trip has ended"
model = DQN("MlpPolicy", "hp_gym:EVHeatPumpFlat-v0", learning_starts=500, buffer_size=5000, seed=0)
model.learn(4000)
print(model.num_timesteps)
