"""sbx (stable-baselines3 in JAX): PPO on both kinds of action, SAC on values, DQN on the flat id."""

from sbx import DQN, PPO, SAC
from stable_baselines3.common.env_util import make_vec_env

arguments = {"env_kwargs": {"control_interval_s": 10}, "seed": 0}
for name in ("EVHeatPump-v0", "EVHeatPumpContinuous-v0"):
    envs = make_vec_env(f"hp_gym:{name}", n_envs=4, **arguments)
    model = PPO("MlpPolicy", envs, n_steps=128, batch_size=256, n_epochs=2, seed=0).learn(2048)
    assert model.ep_info_buffer, "no trip has ended"
envs = make_vec_env("hp_gym:EVHeatPumpContinuous-v0", n_envs=1, **arguments)
SAC("MlpPolicy", envs, learning_starts=200, buffer_size=5000, seed=0).learn(1000)
envs = make_vec_env("hp_gym:EVHeatPumpFlat-v0", n_envs=1, **arguments)
model = DQN("MlpPolicy", envs, learning_starts=200, buffer_size=5000, seed=0).learn(1000)
print(model.num_timesteps)
