"""The error of policies."""


class PolicyError(ValueError):
    """A policy, or a file of one, that cannot be used; the message says which and why, in one line."""
