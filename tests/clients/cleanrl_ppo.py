"""The shape of CleanRL's single-file PPO, discrete and continuous, in lines of our own.

The distribution `cleanrl` is for Python below 3.11. What is kept is what touches an environment: a
`SyncVectorEnv` of wrapped environments, the order of wrappers, seeds, storage of `done`, `infos["episode"]`.
"""

import sys

import gymnasium as gym
import numpy as np
import torch
from torch import nn
from torch.distributions import Categorical, Normal

STEPS, ENVS, UPDATES = 128, 4, 12


def make(name, continuous):
    def thunk():
        env = gym.make(name, control_interval_s=10)
        if not continuous:
            return gym.wrappers.RecordEpisodeStatistics(env)
        env = gym.wrappers.FlattenObservation(env)
        env = gym.wrappers.RecordEpisodeStatistics(env)
        env = gym.wrappers.ClipAction(env)
        env = gym.wrappers.NormalizeObservation(env)
        env = gym.wrappers.TransformObservation(
            env, lambda seen: np.clip(seen, -10, 10), env.observation_space
        )
        env = gym.wrappers.NormalizeReward(env, gamma=0.99)
        return gym.wrappers.TransformReward(env, lambda reward: np.clip(reward, -10, 10))

    return thunk


class Agent(nn.Module):
    def __init__(self, envs):
        super().__init__()
        space, inputs = envs.single_action_space, int(np.prod(envs.single_observation_space.shape))
        self.flat = isinstance(space, gym.spaces.Discrete)
        self.counts = np.array([space.n]) if self.flat else getattr(space, "nvec", None)
        outputs = space.shape[0] if self.counts is None else int(self.counts.sum())
        self.actor = nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, outputs))
        self.critic = nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 1))
        self.logstd = nn.Parameter(torch.zeros(1, outputs))

    def act(self, seen, action=None):
        out = self.actor(seen)
        if self.counts is None:
            law = Normal(out, self.logstd.exp().expand_as(out))
            action = law.sample() if action is None else action
            return action, law.log_prob(action).sum(1), law.entropy().sum(1)
        laws = [Categorical(logits=part) for part in out.split(self.counts.tolist(), dim=1)]
        if action is None:
            action = torch.stack([law.sample() for law in laws], dim=1)
        logprob = sum(law.log_prob(action[:, i]) for i, law in enumerate(laws))
        return action, logprob, sum(law.entropy() for law in laws)


def train(name, continuous):
    envs = gym.vector.SyncVectorEnv([make(name, continuous) for _ in range(ENVS)])
    agent = Agent(envs)
    optimizer = torch.optim.Adam(agent.parameters(), lr=2.5e-4, eps=1e-5)
    seen, _ = envs.reset(seed=1)
    seen, done = torch.tensor(seen, dtype=torch.float32), torch.zeros(ENVS)
    returns = []
    for _ in range(UPDATES):
        rows = []
        for _ in range(STEPS):
            with torch.no_grad():
                action, logprob, _ = agent.act(seen)
                value = agent.critic(seen).flatten()
            asked = action.flatten() if agent.flat else action
            after, reward, terminated, truncated, infos = envs.step(asked.numpy())
            rows.append((seen, action, logprob, torch.tensor(reward, dtype=torch.float32), done, value))
            seen = torch.tensor(after, dtype=torch.float32)
            done = torch.tensor(np.logical_or(terminated, truncated), dtype=torch.float32)
            if "episode" in infos:
                returns += infos["episode"]["r"][infos["_episode"]].tolist()
        learn(agent, optimizer, rows, seen, done)
    envs.close()
    assert returns, "no trip has ended"
    assert np.isfinite(returns).all()
    return returns


def learn(agent, optimizer, rows, seen, done):
    seens, actions, logprobs, rewards, dones, values = (
        torch.stack(column) for column in zip(*rows, strict=True)
    )
    with torch.no_grad():
        following, last, advantages = (
            agent.critic(seen).flatten(),
            torch.zeros(ENVS),
            torch.zeros_like(rewards),
        )
        for t in reversed(range(STEPS)):
            alive = 1.0 - (done if t == STEPS - 1 else dones[t + 1])
            after = following if t == STEPS - 1 else values[t + 1]
            last = rewards[t] + 0.99 * after * alive - values[t] + 0.99 * 0.95 * alive * last
            advantages[t] = last
    flat = [x.flatten(0, 1) for x in (seens, actions, logprobs, advantages, advantages + values)]
    for _ in range(4):
        for part in torch.randperm(STEPS * ENVS).split(STEPS):
            seen_, action, before, advantage, goal = (x[part] for x in flat)
            _, now, entropy = agent.act(seen_, action)
            ratio = (now - before).exp()
            advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
            gain = torch.min(advantage * ratio, advantage * ratio.clamp(0.8, 1.2)).mean()
            loss = (
                -gain - 0.01 * entropy.mean() + 0.5 * (agent.critic(seen_).flatten() - goal).square().mean()
            )
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
            optimizer.step()


if __name__ == "__main__":
    torch.set_num_threads(1)
    torch.manual_seed(1)
    continuous = sys.argv[1] == "continuous"
    for env_id in ["EVHeatPumpContinuous-v0"] if continuous else ["EVHeatPump-v0", "EVHeatPumpFlat-v0"]:
        ended = train(f"hp_gym:{env_id}", continuous)
        print(env_id, "trips", len(ended), "mean return", sum(ended) / len(ended))
