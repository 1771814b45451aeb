"""Controllers for `hp_gym` environments, their training and comparison, and the command line."""
