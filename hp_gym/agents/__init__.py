"""Controllers for environments, policy files, and the training of policies."""
