"""TorchRL over the native vector environment, across ends of trips, and its own `ParallelEnv`."""

import gymnasium as gym
import torch
from torchrl.envs import GymEnv, GymWrapper, ParallelEnv
from torchrl.envs.utils import check_env_specs

import hp_gym  # noqa: F401, registers the ids


def make():
    return GymEnv("EVHeatPump-v0", control_interval_s=10)


def refusal(env):
    try:
        GymWrapper(env)
    except RuntimeError as error:
        return str(error)
    return None


def roll(name, mode):
    native = gym.make_vec(name, num_envs=4, autoreset_mode=mode, control_interval_s=10)
    env = GymWrapper(native, categorical_action_encoding=True)
    env.set_seed(0)
    check_env_specs(env)
    seen = env.rollout(400, break_when_any_done=False)
    assert seen.batch_size == (4, 400)
    done = seen["next", "done"].squeeze(-1)
    assert done.any(), "no trip has ended"
    # What follows an end is the start of another trip, at time 0; what the trip ended with is not.
    row, step = torch.nonzero(done[:, :-1])[0].tolist()
    assert seen["observation"][row, step + 1, 0] == -1.0
    assert seen["next", "observation"][row, step, 0] > -1.0
    print(mode.value, name, "trips", int(done.sum()))


if __name__ == "__main__":
    torch.set_num_threads(1)
    torch.manual_seed(0)
    # TorchRL takes nobody's vector environment that resets in the next step, Gymnasium's default.
    ours = refusal(gym.make_vec("EVHeatPump-v0", num_envs=2))
    assert ours == refusal(gym.make_vec("CartPole-v1", num_envs=2, vectorization_mode="sync")), ours
    print("NEXT_STEP:", ours)
    for kind in (gym.vector.AutoresetMode.SAME_STEP, gym.vector.AutoresetMode.DISABLED):
        for env_id in ("EVHeatPump-v0", "EVHeatPumpContinuous-v0"):
            roll(env_id, kind)
    workers = ParallelEnv(2, make)
    ends = workers.rollout(400, break_when_any_done=False)["next", "done"]
    workers.close()
    assert ends.any(), "no trip has ended"
    print("ParallelEnv trips", int(ends.sum()))
