"""The compiled core of `hp_gym` (rust_core/bindings)."""

from collections.abc import Sequence
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "ConfigurationError",
    "Experiment",
    "Run",
    "__version__",
    "actuators",
    "config_text",
    "names",
    "signals",
    "totals",
]

__version__: Final[str]

class ConfigurationError(ValueError):
    """A file, name or value that the plant does not accept."""

@final
class Experiment:
    """A scenario with vehicle, drive cycle and rule-based controller, ready to run."""

    def __new__(
        cls,
        scenario: str,
        controller: str | None = None,
        overrides: Sequence[str] = ...,
        substeps: int = 1,
    ) -> Experiment:
        """Loads a scenario.

        Args:
            scenario: Name or path of a scenario.
            controller: Name or path of a controller; the scenario's own where absent.
            overrides: Changes of single values, each `part.key=value` with the value in TOML and the part one
                of `scenario`, `vehicle`, `controller`.
            substeps: Steps of the plant in each second, 1 to 1000.
        """

    @property
    def description(self) -> str:
        """What the scenario is, in a sentence."""
    @property
    def vehicle(self) -> str:
        """Name of the vehicle."""
    @property
    def cycle(self) -> str:
        """Name of the drive cycle."""
    @property
    def controller(self) -> str:
        """Name of the scenario's own controller."""
    @property
    def ambient_temperature_degc(self) -> float:
        """Ambient temperature."""
    @property
    def duration_s(self) -> int:
        """Duration of the drive cycle."""
    @property
    def distance_m(self) -> float:
        """Length of the drive cycle."""
    def actuator_ranges(self) -> list[tuple[float, float]]:
        """Lowest and highest physical value of every actuator."""
    def limits(self) -> dict[str, float]:
        """Limits that a run is judged by: comfort band, loop supplies, condensing pressure."""
    def encode(self, settings: dict[str, float | str]) -> NDArray[np.float32]:
        """Command of named actuators in physical units; the others have their defaults."""
    def simulate(self) -> tuple[NDArray[np.float64], dict[str, float], str]:
        """Runs with the rule-based controller: a row of signals a second, totals, reason of the end."""
    def totals(self) -> tuple[dict[str, float], str]:
        """Runs with the rule-based controller: totals and reason of the end only."""
    def start(self) -> Run:
        """The vehicle before the first step."""

@final
class Run:
    """A run in progress."""

    @property
    def experiment(self) -> Experiment:
        """What is run."""
    def rule_based_command(self) -> NDArray[np.float32]:
        """What the rule-based controller would do next. Its memory moves on: call it once a step."""
    def step(self, command: NDArray[np.float32]) -> str | None:
        """Does one step of a second; tells why the run is over, if it is."""
    def look(self) -> NDArray[np.float64]:
        """Present values of all signals."""
    def summary(self) -> dict[str, float]:
        """Totals so far."""

def totals(scenarios: Sequence[str], overrides: Sequence[str] = ...) -> list[tuple[dict[str, float], str]]:
    """Totals of several scenarios with the same overrides, run side by side."""

def signals() -> list[tuple[str, str, str]]:
    """Name, unit and description of every signal, in the order of a row."""

def actuators() -> list[tuple[str, str, list[str], str]]:
    """Name, unit, options (empty for levels) and description of every actuator."""

def names(kind_word: str) -> list[str]:
    """Names of the compiled-in files of a kind: `scenario`, `vehicle`, `controller`, `drive cycle`, ..."""

def config_text(kind_word: str, name: str) -> str:
    """Text of a configuration file by name or path."""
