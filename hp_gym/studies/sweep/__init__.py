"""Sweeps: many runs over a grid or a sample of values, resumable, as one labelled table."""

from hp_gym import extras

extras.require("sweep")
