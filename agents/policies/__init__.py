"""Trained policies as files that cannot run code, and what they decide, in plain numpy."""

from agents.policies.errors import PolicyError
from agents.policies.loading import load
from agents.policies.policy_file import save
from agents.policies.saved_policy import Metadata, Normalisation, PolicyEnvironment, SavedPolicy

__all__ = ["Metadata", "Normalisation", "PolicyEnvironment", "PolicyError", "SavedPolicy", "load", "save"]
