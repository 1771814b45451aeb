"""Controllers behind one interface, found by name."""

from hp_gym.agents.controllers.controller import Act, Controller, ControllerError
from hp_gym.agents.controllers.registry import DEFAULTS, resolve

__all__ = ["DEFAULTS", "Act", "Controller", "ControllerError", "resolve"]
