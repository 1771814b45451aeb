"""Controllers compared over held-out trips."""

from hp_gym import extras

extras.require("benchmark")
