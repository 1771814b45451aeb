"""Searches for the best values of any keys, for any totals as goals and constraints (Optuna)."""

from hp_gym import extras

extras.require("studies")
