"""The error of policies."""

from hp_gym.messages import OneLineError


class PolicyError(OneLineError):
    """A policy, or a file of one, that cannot be used; the message says which and why, in one line."""
