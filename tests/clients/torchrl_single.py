"""TorchRL: a single `GymEnv`, its checker, infos registered by themselves, PPO's collector and loss."""

import torch
from tensordict.nn import TensorDictModule
from torch import nn
from torchrl.collectors import Collector
from torchrl.envs import GymEnv, RewardSum, StepCounter, TransformedEnv
from torchrl.envs.utils import check_env_specs
from torchrl.modules import NormalParamExtractor, ProbabilisticActor, TanhNormal, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

import hp_gym  # noqa: F401, registers the ids

torch.set_num_threads(1)
torch.manual_seed(0)
for name in ("EVHeatPump-v0", "EVHeatPumpContinuous-v0", "EVHeatPumpFlat-v0", "EVHeatPump/test-v0"):
    check_env_specs(GymEnv(name))
    check_env_specs(GymEnv(name, categorical_action_encoding=True))

told = GymEnv("EVHeatPump-v0", control_interval_s=10, info=["cost"]).auto_register_info_dict()
check_env_specs(told)
trip = told.rollout(2000)
assert trip["next", "done"][-1].item(), "the trip has not ended"
parts = [f"reward_{part}" for part in ("energy", "discomfort", "heat_left", "penalties")]
difference = sum(trip["next", part].flatten() for part in parts) - trip["next", "reward"].flatten()
assert difference.abs().max() < 1e-4
assert trip["next", "cost"].max() > 0

env = TransformedEnv(GymEnv("EVHeatPumpContinuous-v0", control_interval_s=10))
env.append_transform(StepCounter())
env.append_transform(RewardSum())
inputs, outputs = env.observation_spec["observation"].shape[-1], env.action_spec.shape[-1]
net = nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 2 * outputs), NormalParamExtractor())
actor = ProbabilisticActor(
    TensorDictModule(net, in_keys=["observation"], out_keys=["loc", "scale"]),
    in_keys=["loc", "scale"],
    distribution_class=TanhNormal,
    distribution_kwargs={"low": -1.0, "high": 1.0},
    return_log_prob=True,
)
values = nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 1))
critic = ValueOperator(values, in_keys=["observation"])
collector = Collector(env, actor, frames_per_batch=500, total_frames=2000)
advantage, loss = GAE(gamma=0.99, lmbda=0.95, value_network=critic), ClipPPOLoss(actor, critic)
optimizer = torch.optim.Adam(loss.parameters(), 3e-4)
ended = 0
for batch in collector:
    ended += int(batch["next", "done"].sum())
    advantage(batch)
    losses = loss(batch)
    total = losses["loss_objective"] + losses["loss_critic"] + losses["loss_entropy"]
    optimizer.zero_grad()
    total.backward()
    optimizer.step()
    assert torch.isfinite(total)
collector.shutdown()
assert ended, "no trip has ended"
print("trips", ended)
