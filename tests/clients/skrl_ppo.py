"""skrl: PPO of its runner on the native vector environment, both kinds of action, and DQN on the flat id."""

import tempfile

import gymnasium as gym
import torch
from skrl.agents.torch.ppo import PPO, PPO_CFG
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.trainers.torch import SequentialTrainer
from skrl.utils import set_seed
from skrl.utils.model_instantiators.torch import (
    categorical_model,
    deterministic_model,
    gaussian_model,
    multicategorical_model,
)

import hp_gym  # noqa: F401, registers the ids

NETWORK = [{"name": "net", "input": "OBSERVATIONS", "layers": [64, 64], "activations": "tanh"}]
POLICIES = {
    "EVHeatPump-v0": multicategorical_model,
    "EVHeatPumpContinuous-v0": gaussian_model,
    "EVHeatPumpFlat-v0": categorical_model,
}


def train(name, folder, vector):
    set_seed(0)
    if vector:
        made = gym.make_vec(name, num_envs=4, control_interval_s=10)
    else:
        made = gym.make(name, control_interval_s=10)
    env = wrap_env(made, wrapper="gymnasium")
    spaces = {
        "observation_space": env.observation_space,
        "action_space": env.action_space,
        "device": env.device,
    }
    models = {
        "policy": POLICIES[name](**spaces, network=NETWORK, output="ACTIONS"),
        "value": deterministic_model(**spaces, network=NETWORK, output="ONE"),
    }
    cfg = PPO_CFG(rollouts=128, learning_epochs=4, mini_batches=4)
    cfg.experiment.directory, cfg.experiment.write_interval = folder, 200
    cfg.experiment.checkpoint_interval = 0
    memory = RandomMemory(memory_size=128, num_envs=env.num_envs, device=env.device)
    agent = PPO(models=models, memory=memory, cfg=cfg, **spaces)
    steps = {"timesteps": 1000, "headless": True, "disable_progressbar": True}
    SequentialTrainer(env=env, agents=agent, cfg=steps).train()


torch.set_num_threads(1)
with tempfile.TemporaryDirectory() as folder:
    for name in POLICIES:
        for vector in (True, False):
            train(name, folder, vector)
            print(name, "vector" if vector else "single")
