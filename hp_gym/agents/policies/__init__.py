"""Trained policies as files that cannot run code, and what they decide, in plain numpy."""

from hp_gym import extras

with extras.needed("benchmark"):
    from hp_gym.agents.policies.errors import PolicyError
    from hp_gym.agents.policies.loading import load
    from hp_gym.agents.policies.policy_file import save
    from hp_gym.agents.policies.saved_policy import Metadata, Normalisation, PolicyEnvironment, SavedPolicy

__all__ = ["Metadata", "Normalisation", "PolicyEnvironment", "PolicyError", "SavedPolicy", "load", "save"]
