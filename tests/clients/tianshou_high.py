"""tianshou's high-level interface: PPO on the continuous id, DQN on the flat one."""

import tempfile

import torch
from tianshou.highlevel.config import OffPolicyTrainingConfig, OnPolicyTrainingConfig
from tianshou.highlevel.env import EnvFactoryRegistered, VectorEnvType
from tianshou.highlevel.experiment import DQNExperimentBuilder, ExperimentConfig, PPOExperimentBuilder

torch.set_num_threads(1)
SIZES = {
    "max_epochs": 1,
    "epoch_num_steps": 1500,
    "num_training_envs": 2,
    "num_test_envs": 1,
    "test_step_num_episodes": 1,
    "batch_size": 128,
}
POLICY = OnPolicyTrainingConfig(collection_step_num_env_steps=500, **SIZES)
VALUES = OffPolicyTrainingConfig(collection_step_num_env_steps=100, **SIZES)


def run(name, builder, config, complete):
    factory = EnvFactoryRegistered(
        task=f"hp_gym:{name}", venv_type=VectorEnvType.DUMMY, control_interval_s=10
    )
    with tempfile.TemporaryDirectory() as folder:
        experiment = ExperimentConfig(persistence_base_dir=folder, watch=False, device="cpu", seed=0)
        result = complete(builder(factory, experiment, config)).build().run()
    print(name, "best score", result.trainer_result.best_score)


run(
    "EVHeatPumpContinuous-v0",
    PPOExperimentBuilder,
    POLICY,
    lambda made: made.with_actor_factory_default((64,)).with_critic_factory_default((64,)),
)
run("EVHeatPumpFlat-v0", DQNExperimentBuilder, VALUES, lambda made: made.with_model_factory_default((64,)))
