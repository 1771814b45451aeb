"""Controllers that are a Python class of the user's: `module:Class`."""

from __future__ import annotations

import importlib
import sys
import traceback
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
    with _told(f"controller `{reference}` cannot be used"):
        predict: Callable[..., Any] | None = getattr(instance, "predict", None)
        environment = getattr(instance, "environment", {})
        starter: Callable[..., Any] | None = getattr(instance, "begin", None)
    if not callable(predict):
        raise ControllerError(f"controller `{reference}` has no method `predict(observations)`")
    if not isinstance(environment, dict):
        message = f"controller `{reference}`: `environment` is {environment!r}, but must be a dict"
        raise ControllerError(message)

    def begin(env: EVHeatPumpVectorEnv) -> Act:
        if starter is not None:
            with _told("begin failed"):
                starter(env)

        def act(observations: object) -> Action:
            with _told("predict failed"):
                answer = predict(observations)
                actions: Action = np.asarray(answer[0] if isinstance(answer, tuple) else answer)
            return actions

        return act

    return Controller(reference, begin, environment, learned=True)


def _instance(reference: str) -> object:
    module_name, _, class_name = reference.partition(":")
    if not module_name or not class_name:
        raise ControllerError(f"controller `{reference}` must read module:Class")
    with _told(f"controller `{reference}`: cannot import `{module_name}`"), _working_folder_first():
        module = importlib.import_module(module_name)
    if not hasattr(module, class_name):
        raise ControllerError(f"controller `{reference}`: module `{module_name}` has no `{class_name}`")
    with _told(f"controller `{reference}` cannot be made"):
        made: object = getattr(module, class_name)()
    return made


@contextmanager
def _told(what: str) -> Generator[None]:
    """Turns whatever a stranger's class raises into one line with the place where it did.

    Raises:
        ControllerError: Something was raised.
    """
    try:
        yield
    except ControllerError:
        raise
    # `sys.exit` in somebody's module must not end a benchmark without a word.
    except (Exception, SystemExit) as error:
        kind = type(error).__name__
        raise ControllerError(f"{what}: {kind}: {error}{_place(error)}") from error


def _place(error: BaseException) -> str:
    """File and line of the last frame that is not this module's or the import machinery's."""
    if isinstance(error, SyntaxError) and error.filename is not None:
        return f" ({error.filename}, line {error.lineno})"
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename not in {__file__, importlib.__file__} and not frame.filename.startswith("<frozen ")
    ]
    return f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""


@contextmanager
def _working_folder_first() -> Generator[None]:
    """A console script does not look into the working folder by itself."""
    folder = str(Path.cwd())
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)
