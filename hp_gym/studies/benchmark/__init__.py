"""Controllers compared over held-out trips."""
