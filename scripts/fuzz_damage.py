"""Damages states, policies and checkpoints that this package wrote: each is refused, or still the same.

    uv run scripts/fuzz_damage.py                      # 300 pieces, for a test
    uv run scripts/fuzz_damage.py --count 10000

Bits are flipped, bytes changed, cut off, doubled, put in and exchanged between two files. After each refusal
every environment must be in the state that it was in. Exits with 1 where something is accepted that is not
the same, or where an error is none of this package.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import torch

from hp_gym import _core
from hp_gym.agents import policies
from hp_gym.agents.policies import reference
from hp_gym.agents.policies.policy_file import metadata_text, parse, tensors_of
from hp_gym.agents.training import checkpoint, configuration, train
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.messages import LONGEST_MESSAGE, OneLineError

if TYPE_CHECKING:
    from collections.abc import Callable

TRAINING: Final = (
    "total_decisions=256",
    "checkpoint_interval_decisions=128",
    "environments={number = 4, threads = 1}",
    "network.hidden_sizes=[4]",
    "validation={interval_decisions = 1000, trips = 1}",
    "environment.control_interval_s=60",
    "hyperparameters.n_steps=32",
    "hyperparameters.batch_size=64",
    "imitation.rounds=0",
)
"""What makes a training small."""

ENVIRONMENTS: Final = 3


def a_checkpoint(folder: Path) -> bytes:
    """Returns a checkpoint as a training writes it."""
    train.start(configuration.load("ppo", list(TRAINING)), "ppo", 0, folder / "run")
    return max((folder / "run" / "checkpoints").glob("*.pt")).read_bytes()


def damaged(good: bytes, other: bytes, chance: random.Random) -> bytes:
    """Returns a piece with something wrong in it."""
    data = bytearray(good)
    place = chance.randrange(len(data))
    match chance.randrange(8):
        case 0 | 1 | 2:
            data[place] ^= 1 << chance.randrange(8)
        case 3:
            for _ in range(chance.randint(2, 30)):
                data[chance.randrange(len(data))] = chance.randrange(256)
        case 4:
            del data[place:]
        case 5:
            data[place:place] = chance.randbytes(chance.randint(1, 40))
        case 6:
            data += data[place:]
        case _:
            end = place + chance.randint(1, 400)
            data[place:end] = other[place:end]
    return bytes(data)


def equal(one: Any, other: Any) -> bool:
    """Whether two contents of checkpoints are the same."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(equal(value, other[key]) for key, value in one.items())
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(equal, one, other))
    return torch.equal(one, other) if isinstance(one, torch.Tensor) else bool(one == other)


class Tally:
    """What was seen."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.wrong: list[str] = []

    def attempt(self, name: str, read: Callable[[], Any], same: Callable[[Any], bool]) -> bool:
        """Reads a damaged piece; returns whether it was accepted."""
        try:
            result = read()
        except (_core.StateError, OneLineError) as error:
            if len(str(error)) > LONGEST_MESSAGE or "\n" in str(error):
                self.wrong.append(f"{name}: a message of {len(str(error))} characters")
            self.counts[f"{name} refused"] += 1
            return False
        except BaseException as error:  # noqa: BLE001, a panic is none of `Exception`
            self.wrong.append(f"{name}: {type(error).__name__}: {str(error)[:200]!r}")
            return False
        if not same(result):
            self.wrong.append(f"{name}: accepted, and not the same")
        self.counts[f"{name} the same"] += 1
        return True


class States:
    """A single and a vector environment, in the middle of a trip."""

    def __init__(self) -> None:
        self.env = EVHeatPumpEnv(distribution="train-v2")
        self.envs = EVHeatPumpVectorEnv(ENVIRONMENTS, threads=1)
        self.env.reset(seed=1)
        self.envs.reset(seed=1)
        self.drive(40)
        self.single, self.many = self.env.get_state(), self.envs.get_state()
        self.drive(3)
        self.later = self.env.get_state()

    def drive(self, steps: int) -> None:
        """Drives both on."""
        for _ in range(steps):
            self.env.step(self.env.action_space.sample())
            self.envs.step(self.envs.action_space.sample())

    def attempt(self, tally: Tally, chance: random.Random) -> None:
        """Restores a damaged state into one of them."""
        bad = damaged(self.single, self.later, chance)
        before = self.env.get_state()
        accepted = tally.attempt(
            "state", lambda: self.env.set_state(bad), lambda _: self.env.get_state() == self.single
        )
        if not accepted and self.env.get_state() != before:
            tally.wrong.append("state: refused, but the environment has changed")

    def attempt_many(self, tally: Tally, chance: random.Random) -> None:
        """Restores states, of which one is damaged, into the vector environment."""
        states = list(self.many)
        place = chance.randrange(ENVIRONMENTS)
        states[place] = damaged(states[place], states[place - 1], chance)
        before = self.envs.get_state()
        accepted = tally.attempt(
            "states of a vector",
            lambda: self.envs.set_state(states),
            lambda _: self.envs.get_state() == self.many,
        )
        if not accepted and self.envs.get_state() != before:
            tally.wrong.append("states of a vector: refused, but an environment has changed")


def policy_bytes(folder: Path) -> tuple[policies.SavedPolicy, bytes, bytes]:
    """Returns a policy, the same as it is saved, and another one as it is saved."""
    first, second = list(reference.policies().values())[:2]
    for name, policy in (("first", first), ("second", second)):
        policies.save(folder / f"{name}.safetensors", policy)
    saved = [(folder / f"{name}.safetensors").read_bytes() for name in ("first", "second")]
    return first, saved[0], saved[1]


def same_policy(one: policies.SavedPolicy, other: policies.SavedPolicy) -> bool:
    """Whether two policies decide the same."""
    first, second = tensors_of(one), tensors_of(other)
    return metadata_text(one) == metadata_text(other) and all(
        np.array_equal(first[name], second[name]) for name in first
    )


def run(count: int, seed: int, folder: Path) -> Tally:
    """Damages `count` pieces, in turn of each kind."""
    tally, chance, states = Tally(), random.Random(seed), States()
    policy, saved, other_policy = policy_bytes(folder)
    sealed = a_checkpoint(folder)
    path = folder / "000000000001.pt"
    path.write_bytes(sealed)
    whole = checkpoint.read(path)

    def attempt_policy() -> None:
        bad = damaged(saved, other_policy, chance)
        tally.attempt("policy", lambda: parse("damaged", bad), lambda read: same_policy(read, policy))

    def attempt_checkpoint() -> None:
        path.write_bytes(damaged(sealed, saved, chance))
        tally.attempt("checkpoint", lambda: checkpoint.read(path), lambda read: equal(read, whole))

    def attempt_state() -> None:
        states.attempt(tally, chance)

    def attempt_states() -> None:
        states.attempt_many(tally, chance)

    turns = (attempt_state, attempt_states, attempt_policy, attempt_checkpoint)
    for number in range(count):
        turns[number % len(turns)]()
        if number % 100 == 0:
            states.drive(1)
    return tally


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=300, help="number of damaged pieces")
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tally = run(chosen.count, chosen.seed, Path(folder))
    for what, number in sorted(tally.counts.items()):
        print(f"{what}: {number}")
    for what in tally.wrong:
        print(f"WRONG: {what}")
    print(f"wrong: {len(tally.wrong)}")
    sys.exit(1 if tally.wrong else 0)


if __name__ == "__main__":
    main()
