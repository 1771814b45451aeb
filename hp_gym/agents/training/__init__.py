"""Training of policies by reinforcement learning."""

from hp_gym import extras

# Trips and configurations are read without torch; the modules that learn ask for the rest.
extras.require("train", "pydantic", "tomlkit")
