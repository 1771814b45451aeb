"""Controllers that are a Python class of the user's: `module:Class`."""

from __future__ import annotations

import importlib
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hp_gym.agents.controllers.controller import Act, Controller, ControllerError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from hp_gym.envs.settings import Action
    from hp_gym.envs.vector_env import EVHeatPumpVectorEnv


def load(reference: str) -> Controller:
    """Makes a controller of a class, looked for in the working folder too.

    The class takes no arguments and has `predict(observations)`, which returns the actions of all
    environments, one row each (or a pair that begins with them, as models of stable-baselines3 do). It may
    have `environment`, a dict with arguments of `EVHeatPumpVectorEnv`, and `begin(env)`, called with the
    vector environment before each set of trips. One instance drives all sets.

    Args:
        reference: `module:Class`.

    Raises:
        ControllerError: There is no such module or class, it cannot be made, or it has no `predict`.
    """
    instance = _instance(reference)
    predict: Callable[..., Any] | None = getattr(instance, "predict", None)
    if not callable(predict):
        raise ControllerError(f"controller `{reference}` has no method `predict(observations)`")
    environment = getattr(instance, "environment", {})
    if not isinstance(environment, dict):
        message = f"controller `{reference}`: `environment` is {environment!r}, but must be a dict"
        raise ControllerError(message)

    def begin(env: EVHeatPumpVectorEnv) -> Act:
        starter = getattr(instance, "begin", None)
        if starter is not None:
            starter(env)

        def act(observations: object) -> Action:
            try:
                answer = predict(observations)
            except Exception as error:  # whatever a stranger's class raises
                raise ControllerError(f"predict failed: {type(error).__name__}: {error}") from error
            actions: Action = np.asarray(answer[0] if isinstance(answer, tuple) else answer)
            return actions

        return act

    return Controller(reference, begin, environment, learned=True)


def _instance(reference: str) -> object:
    module_name, _, class_name = reference.partition(":")
    if not module_name or not class_name:
        raise ControllerError(f"controller `{reference}` must read module:Class")
    try:
        with _working_folder_first():
            module = importlib.import_module(module_name)
        found = getattr(module, class_name)
    except ImportError as error:
        raise ControllerError(f"controller `{reference}`: cannot import `{module_name}`: {error}") from error
    except AttributeError as error:
        raise ControllerError(
            f"controller `{reference}`: module `{module_name}` has no `{class_name}`"
        ) from error
    try:
        return found()
    except Exception as error:  # whatever a stranger's class raises
        message = f"controller `{reference}` cannot be made: {type(error).__name__}: {error}"
        raise ControllerError(message) from error


@contextmanager
def _working_folder_first() -> Generator[None]:
    """A console script does not look into the working folder by itself."""
    folder = str(Path.cwd())
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)
