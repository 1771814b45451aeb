"""A policy trained, kept as a file that cannot run code, and driven beside the rules.

python examples/16_train.py [FOLDER]
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from hp_gym.agents import policies
from hp_gym.agents.training import configuration, train
from hp_gym.agents.training.trips import drive
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

FILE = Path(__file__).with_suffix(".toml")
TRIPS = {"distribution": str(FILE.with_name("05_distribution.toml")), "reward": "reference"}
SEEDS = range(900, 916)


def main(folder: Path) -> None:
    """Trains, and drives trips that the training has not seen."""
    # As `hp-gym train examples/16_train.toml --set environment.distribution=...`.
    training = configuration.load(str(FILE), [f"environment.distribution={TRIPS['distribution']}"])
    outcome = train.start(training, FILE.stem, 0, folder / "run")
    print(f"{outcome.decisions} decisions, best score on validation trips {outcome.best['score']:.1f}")
    policy = policies.load(outcome.folder / "final.safetensors")
    envs = EVHeatPumpVectorEnv(len(SEEDS), **TRIPS, **policy.environment)
    learned = drive(envs, SEEDS, policy.predict, masked=policy.needs_masks)
    envs = EVHeatPumpVectorEnv(len(SEEDS), **TRIPS, continuous=True, actions=HpcuPolicy.ACTIONS)
    rules = drive(envs, SEEDS, lambda *_: envs.rule_based_actions())
    for name, driven in (("policy", learned), ("rules", rules)):
        energy_kwh, discomfort_k = driven.attributable_energy_kwh.mean(), driven.discomfort_k.mean()
        print(
            f"{name}: {energy_kwh:.2f} kWh, {discomfort_k:.1f} K off target, {driven.score.mean():.1f} points"
        )


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        with TemporaryDirectory() as temporary:
            main(Path(temporary))
