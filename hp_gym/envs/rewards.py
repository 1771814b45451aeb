"""Rewards that are Python functions of named parts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

Reward: TypeAlias = Callable[[Mapping[str, Any]], Any]
"""A reward as a function of named parts.

They are those of the built-in reward in points (`reward_energy`, ...) and the terms that these are counted
from in physical units (`chemical_energy_kwh`, `discomfort_k_h`, ...), each of one control interval. For a
single environment they are numbers, for a vector of n arrays (n,), and so is what it returns.
"""


def one(reward: Reward, parts: Mapping[str, Any]) -> float:
    """Returns the reward of one environment.

    Raises:
        ValueError: It is not one finite number.
    """
    return float(_checked(reward, parts, ()))


def many(reward: Reward, parts: Mapping[str, Any], number: int) -> NDArray[np.float64]:
    """Returns the rewards of many environments.

    Raises:
        ValueError: They are not as many finite numbers.
    """
    return _checked(reward, parts, (number,))


def _checked(reward: Reward, parts: Mapping[str, Any], shape: tuple[int, ...]) -> NDArray[np.float64]:
    given = reward(parts)
    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        message = f"reward {_name(reward)} returned {given!r}, but must return numbers"
        raise ValueError(message) from None
    if values.shape != shape:
        wanted = f"an array of the shape {shape}" if shape else "one number"
        message = f"reward {_name(reward)} returned the shape {values.shape}, but must return {wanted}"
        raise ValueError(message)
    finite = np.isfinite(values)
    if not finite.all():
        where = f" for environment {int(np.argmin(finite))}" if shape else ""
        value = values.flat[int(np.argmin(finite))]
        message = f"reward {_name(reward)} returned {value}{where}, but must return finite numbers"
        raise ValueError(message)
    return values


def _name(reward: Reward) -> str:
    return f"`{getattr(reward, '__qualname__', type(reward).__qualname__)}`"
