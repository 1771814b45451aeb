"""tianshou's procedural interface: DQN's collector, buffer and trainer on the flat id."""

import gymnasium as gym
import torch
from tianshou.algorithm import DQN
from tianshou.algorithm.modelfree.dqn import DiscreteQLearningPolicy
from tianshou.algorithm.optim import AdamOptimizerFactory
from tianshou.data import Collector, CollectStats, VectorReplayBuffer
from tianshou.env import DummyVectorEnv
from tianshou.trainer import OffPolicyTrainerParams
from tianshou.utils.net.common import Net

torch.set_num_threads(1)


def make():
    return gym.make("hp_gym:EVHeatPumpFlat-v0", control_interval_s=10)


env, training, test = make(), DummyVectorEnv([make for _ in range(4)]), DummyVectorEnv([make])
training.seed(0)
test.seed(1)
net = Net(state_shape=env.observation_space.shape, action_shape=env.action_space.n, hidden_sizes=[64, 64])
policy = DiscreteQLearningPolicy(model=net, action_space=env.action_space, eps_training=0.1)
algorithm = DQN(policy=policy, optim=AdamOptimizerFactory(lr=1e-3), gamma=0.99, target_update_freq=100)
collector = Collector[CollectStats](algorithm, training, VectorReplayBuffer(8000, 4), exploration_noise=True)
test_collector = Collector[CollectStats](algorithm, test)
result = algorithm.run_training(
    OffPolicyTrainerParams(
        training_collector=collector,
        test_collector=test_collector,
        max_epochs=1,
        epoch_num_steps=2000,
        collection_step_num_env_steps=100,
        test_step_num_episodes=1,
        batch_size=64,
        update_step_num_gradient_steps_per_sample=0.1,
        show_progress=False,
    )
)
info = collector.buffer.info
print("best score", result.best_score, "infos", sorted(info.keys()))
