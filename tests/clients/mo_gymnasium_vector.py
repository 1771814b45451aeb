"""MO-Gymnasium: its wrappers over the environment whose reward is a vector."""

import gymnasium as gym
import mo_gymnasium as mo
import numpy as np
from mo_gymnasium.wrappers import LinearReward, MONormalizeReward, MORecordEpisodeStatistics
from mo_gymnasium.wrappers.vector import MOSyncVectorEnv

NAME = "hp_gym:EVHeatPumpMO-v0"


def drive(env):
    env.reset(seed=0)
    env.action_space.seed(0)
    total, over = 0.0, False
    while not over:
        _, reward, terminated, truncated, info = env.step(env.action_space.sample())
        total, over = total + reward, terminated or truncated
    return total, info


env = mo.make(NAME, control_interval_s=10)
assert env.unwrapped.reward_space.shape == (4,)
vector, _ = drive(env)
weights = np.array([1.0, 1.0, 0.5, 1.0])
scalar, _ = drive(LinearReward(mo.make(NAME, control_interval_s=10), weight=weights))
assert np.isclose(scalar, vector @ weights)
default, _ = drive(gym.make("EVHeatPump-v0", control_interval_s=10))
assert np.isclose(vector.sum(), default)

kept, info = drive(MORecordEpisodeStatistics(mo.make(NAME, control_interval_s=10), gamma=0.99))
assert np.allclose(info["episode"]["r"], kept)
drive(MONormalizeReward(mo.make(NAME, control_interval_s=10), idx=1))

envs = MOSyncVectorEnv([lambda: mo.make(NAME, control_interval_s=10) for _ in range(3)])
envs.reset(seed=0)
ended = 0
for _ in range(600):
    _, rewards, terminated, truncated, _ = envs.step(envs.action_space.sample())
    assert rewards.shape == (3, 4)
    ended += int((terminated | truncated).sum())
envs.close()
assert ended, "no trip has ended"
print("return of a trip by part", vector.round(2), "trips", ended)
