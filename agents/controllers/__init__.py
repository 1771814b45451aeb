"""Controllers behind one interface, found by name."""

from agents.controllers.controller import Act, Controller, ControllerError
from agents.controllers.registry import DEFAULTS, resolve

__all__ = ["DEFAULTS", "Act", "Controller", "ControllerError", "resolve"]
