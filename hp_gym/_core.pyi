"""The compiled core of `hp_gym` (rust_core/bindings)."""

from collections.abc import Callable, Sequence
from typing import Any, Final, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "LEVELS",
    "ConfigurationError",
    "Episode",
    "Experiment",
    "FinishedTrip",
    "InternalError",
    "Outcomes",
    "Run",
    "StateError",
    "Vector",
    "__built_for__",
    "__version__",
    "action_groups",
    "actuators",
    "architecture_layout",
    "config_text",
    "default_settings",
    "looks_deep",
    "names",
    "observation_table",
    "plant_step_seconds",
    "reference_policy",
    "reference_policy_names",
    "reward_parts",
    "reward_terms",
    "signals",
    "summaries",
    "totals",
    "trace",
    "trace_columns",
    "vehicle_layout",
]

__built_for__: Final[str]
__version__: Final[str]
LEVELS: Final[int]

_Actuators: TypeAlias = list[tuple[str, str, list[str], str]]
_Signals: TypeAlias = list[tuple[str, str, str]]
_Observed: TypeAlias = list[tuple[str, str, float, float, str]]

class ConfigurationError(ValueError):
    """A file, name or value that the plant does not accept."""

class StateError(ConfigurationError):
    """A saved state that is damaged, or of something else."""

class InternalError(RuntimeError):
    """A mistake of this package; what was worked on is refused until it is reset or restored."""

@final
class Experiment:
    """A scenario with vehicle, drive cycle and rule-based controller, ready to run."""

    def __new__(
        cls,
        scenario: str,
        controller: str | None = None,
        overrides: Sequence[str] = ...,
        substeps: int = 1,
        vehicle: str | None = None,
    ) -> Experiment:
        """Loads a scenario.

        Args:
            scenario: Name or path of a scenario.
            controller: Name or path of a controller; the scenario's own where absent.
            overrides: Changes of single values, each `part.key=value` with the value in TOML and the part one
                of `scenario`, `vehicle`, `controller`.
            substeps: Steps of the plant in each second, 1 to 1000.
            vehicle: Name or path of a vehicle; that of the scenario where absent.
        """

    @property
    def description(self) -> str:
        """What the scenario is, in a sentence."""
    @property
    def vehicle(self) -> str:
        """Name of the vehicle."""
    @property
    def architecture(self) -> str:
        """Name or path of the vehicle's architecture."""
    @property
    def signal_names(self) -> tuple[str, ...]:
        """Names of all signals."""
    @property
    def actuator_names(self) -> tuple[str, ...]:
        """Names of all actuators, in the order of a command."""
    def actuators(self) -> _Actuators:
        """Name, unit, options (empty for levels) and description of every actuator."""
    def signals(self) -> _Signals:
        """Name, unit and description of every signal."""
    def layout(self) -> dict[str, Any]:
        """What the vehicle is made of, by the names of columns and actuators."""
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
    def simulate(
        self, check: Callable[[], object] | None = None
    ) -> tuple[NDArray[np.float64], dict[str, float], str]:
        """Runs with the rule-based controller: a row of signals a second, totals, reason of the end.

        Signals are seen on the way; `check` is called every now and then, and what it raises ends the run.
        """
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

_Info: TypeAlias = dict[str, Any]
_Floats: TypeAlias = NDArray[np.float32]
_Bools: TypeAlias = NDArray[np.bool_]

@final
class Episode:
    """One environment."""

    def __new__(cls, settings: str, scenario: str | None = None, distribution: str | None = None) -> Episode:
        """Makes an environment of settings in JSON; trips come from a scenario or else a distribution."""
    @property
    def closed(self) -> bool:
        """Whether it was closed."""
    def option_counts(self) -> list[int]:
        """Number of options of each action; empty in continuous mode."""
    def action_rows(self) -> _Actuators:
        """Name, unit, options (empty for levels) and description of each action."""
    def observation_rows(self) -> _Observed:
        """Name, unit, low, high and meaning of every row of an observation."""
    def narrow_rows(self) -> list[tuple[str, str, float, float]]:
        """Rows whose bounds a vehicle can leave: vehicle, row, upper bound, what the vehicle can reach."""
    def signal_names(self) -> tuple[str, ...]:
        """Names of all signals of the vehicle of the trip."""
    def layout(self) -> dict[str, Any]:
        """What the vehicle of the trip is made of."""
    def reset(
        self, scenario: str | None = None, distribution: str | None = None, seed: int | None = None
    ) -> tuple[_Floats, _Info]:
        """Begins a trip; a scenario or distribution holds for it only, a seed starts random numbers anew."""
    def step(self, action: NDArray[Any]) -> tuple[_Floats, float, bool, bool, _Info]:
        """Drives on for one control interval."""
    def action_masks(self) -> _Bools:
        """Options that would be granted in the coming second."""
    def rule_based_action(self) -> NDArray[Any]:
        """What the rule-based controller would do next."""
    def look(self) -> NDArray[np.float64]:
        """Present values of all signals."""
    def asked(self) -> _Floats:
        """The command that was driven last, all actuators."""
    def speeds_m_s(self) -> NDArray[np.float64]:
        """Speed at every full second of the trip."""
    def kpis(self) -> dict[str, float]:
        """KPIs of the trip so far."""
    def summary(self) -> dict[str, float]:
        """Totals of the trip so far, as `simulate` gives them."""
    def trip(self) -> dict[str, Any]:
        """What the trip is: scenario, vehicle, cycle, part of it, duration, ambient temperature."""
    def end_reason(self) -> str | None:
        """Why the trip is over; None while it is not."""
    def clipped_shares(self) -> dict[str, float]:
        """Share of the observations of the trip in which each row was beyond its bounds."""
    def get_state(self) -> bytes:
        """Everything that the future depends on."""
    def set_state(self, state: bytes) -> None:
        """Goes on from a state."""
    def close(self) -> None:
        """Ends it."""

@final
class FinishedTrip:
    """A trip that is over."""

    @property
    def index(self) -> int:
        """Environment."""
    @property
    def end_reason(self) -> str | None:
        """Why it ended; None where the limit of steps cut it off."""
    @property
    def trip(self) -> dict[str, Any]:
        """What it was: scenario, vehicle, cycle, part of it, duration, ambient temperature."""
    @property
    def kpis(self) -> dict[str, float]:
        """Its KPIs."""
    @property
    def summary(self) -> dict[str, float]:
        """Its totals, as `simulate` gives them."""
    @property
    def info(self) -> _Info:
        """Info of its last step."""
    @property
    def last_observation(self) -> _Floats | None:
        """Its last observation, where the environment was reset at once."""

@final
class Outcomes:
    """What a step of many environments gives: columns with one entry for each, then what happened to some."""

    @property
    def observations(self) -> _Floats:
        """Observations, one row an environment."""
    @property
    def rewards(self) -> NDArray[np.float64]:
        """Rewards."""
    @property
    def terminated(self) -> _Bools:
        """Whose trip ended."""
    @property
    def truncated(self) -> _Bools:
        """Whose trip was cut off."""
    @property
    def parts(self) -> NDArray[np.float64]:
        """Parts of the rewards, one row a part."""
    @property
    def costs(self) -> NDArray[np.float64] | None:
        """Costs, if wanted."""
    @property
    def terms(self) -> NDArray[np.float64] | None:
        """Terms of the step, one row a term, if wanted."""
    @property
    def masks(self) -> _Bools | None:
        """Options that would be granted next, one row an environment, if wanted."""
    @property
    def finished(self) -> list[FinishedTrip]:
        """Trips that are over."""
    @property
    def reset(self) -> list[int]:
        """Environments that were reset."""

@final
class Vector:
    """Many environments."""

    def __new__(
        cls,
        settings: str,
        scenarios: Sequence[str | None],
        distributions: Sequence[str | None],
        vehicles: Sequence[str | None],
        autoreset: str,
        step_limit: int | None,
        threads: int,
    ) -> Vector:
        """Makes as many environments as there are scenarios and distributions."""
    def reset(
        self,
        indices: Sequence[int],
        seeds: Sequence[int | None],
        scenarios: Sequence[str | None],
        distributions: Sequence[str | None],
    ) -> None:
        """Resets environments, each with its seed and, just this once, its scenario or distribution."""
    def observe(self, indices: Sequence[int], again: bool = False) -> _Floats:
        """Observations of environments, one row each; those seen before are not counted again."""
    def step(self, action: NDArray[Any]) -> Outcomes:
        """Drives all environments on for one control interval."""
    def action_masks(self) -> _Bools:
        """Options that would be granted in the coming second, one row an environment."""
    def masks(self) -> _Bools:
        """The same, all options where no trip has begun."""
    def rule_based_actions(self) -> NDArray[Any]:
        """What the rule-based controllers would do next, one row an environment."""
    def option_counts(self) -> list[int]:
        """Number of options of each action; empty in continuous mode."""
    def action_rows(self) -> _Actuators:
        """Name, unit, options (empty for levels) and description of each action."""
    def observation_rows(self) -> _Observed:
        """Name, unit, low, high and meaning of every row of an observation."""
    def narrow_rows(self) -> list[tuple[str, str, float, float]]:
        """Rows whose bounds a vehicle can leave: vehicle, row, upper bound, what the vehicle can reach."""
    def signal_names(self, index: int) -> tuple[str, ...]:
        """Names of all signals of the vehicle of an environment's trip."""
    def layout(self, index: int) -> dict[str, Any]:
        """What the vehicle of an environment's trip is made of."""
    def look(self, index: int) -> NDArray[np.float64]:
        """Present values of all signals of an environment."""
    def speeds_m_s(self, index: int) -> NDArray[np.float64]:
        """Speed at every full second of the trip of an environment."""
    def kpis(self, index: int) -> dict[str, float]:
        """KPIs of the present trip of an environment."""
    def summary(self, index: int) -> dict[str, float]:
        """Totals of the present trip of an environment, as `simulate` gives them."""
    def trip(self, index: int) -> dict[str, Any]:
        """What the present trip is: scenario, vehicle, cycle, part of it, duration, ambient temperature."""
    def end_reason(self, index: int) -> str | None:
        """Why the present trip is over; None while it is not."""
    def clipped_shares(self, index: int) -> dict[str, float]:
        """Share of the observations of the present trip in which each row was beyond its bounds."""
    def fork(self, indices: Sequence[int]) -> None:
        """Lets every environment go on from where another one is now."""
    def get_state(self, index: int) -> bytes:
        """Everything that the future of an environment depends on."""
    def set_states(self, indices: Sequence[int], states: Sequence[bytes]) -> None:
        """Restores environments, all or none."""
    def close(self) -> None:
        """Ends them."""

def observation_table() -> list[tuple[tuple[str, str, float, float, str], bool]]:
    """Name, unit, low, high and meaning of every row that can be observed; whether it is by default."""

def reward_parts() -> list[str]:
    """Names of the parts of a reward."""

def reward_terms() -> list[str]:
    """Names of the terms, in physical units, that rewards and KPIs are counted from."""

def action_groups() -> list[tuple[str, list[str]]]:
    """Groups of actuators (`default`, `hpcu`, `all`), and the names of those of the default architecture."""

def default_settings() -> str:
    """Default settings of an environment as JSON."""

def architecture_layout(name: str) -> dict[str, Any]:
    """Reads and checks an architecture by name or path; returns what it is made of.

    Raises:
        ConfigurationError: It has a flaw.
    """

def vehicle_layout(name: str, overrides: Sequence[str] = ...) -> dict[str, Any]:
    """Reads and checks a vehicle by name or path; returns what it is made of.

    Raises:
        ConfigurationError: It, its architecture or an override has a flaw.
    """

def totals(
    scenarios: Sequence[str], overrides: Sequence[str] = ..., vehicle: str | None = None
) -> list[tuple[dict[str, float], str]]:
    """Totals of several scenarios with the same overrides, run side by side."""

def summaries(
    runs: Sequence[tuple[str, str | None, str | None, Sequence[str]]], threads: int, substeps: int = 1
) -> tuple[list[str], NDArray[np.float64], list[str | None], list[str | None]]:
    """Totals of many runs, side by side, each bit for bit what `simulate` gives.

    Args:
        runs: Scenario, controller, vehicle and overrides of each, as `Experiment` takes them.
        threads: Native threads.
        substeps: Steps of the plant in each second.

    Returns:
        Names of the totals; a row of them for each run, NaN where one does not exist; why each run ended,
        None where it was refused; and why it was refused, else None.
    """

def plant_step_seconds(
    scenario: str, seed: int | None = None, vehicle: str | None = None
) -> tuple[float, int]:
    """Seconds of all steps with the compressor on, and their number; random actions with a seed."""

def signals(name: str = ...) -> _Signals:
    """Name, unit and description of every signal of an architecture, in the order of a row."""

def actuators(name: str = ...) -> _Actuators:
    """Name, unit, options (empty for levels) and description of every actuator of an architecture."""

def looks_deep(text: str) -> bool:
    """Whether a TOML text goes deeper than any file may, found without parsing it."""

def names(kind_word: str) -> list[str]:
    """Names of the compiled-in files of a kind: `scenario`, `vehicle`, `architecture`, `drive cycle`, ..."""

def config_text(kind_word: str, name: str) -> str:
    """Text of a configuration file by name or path."""

def trace(path: str) -> dict[str, NDArray[np.float64]]:
    """Columns of a trace file at full seconds, under their names; `time_s` counts from 0 (docs/traces.md).

    Raises:
        ConfigurationError: There is no such file, or it is no trace.
    """

def trace_columns() -> list[tuple[str, float, float]]:
    """Name, lowest and highest value of every column that a trace may have."""

def reference_policy_names() -> list[str]:
    """Names of the reference policies: their files in `agents/reference_policies` without ending, sorted."""

def reference_policy(name: str) -> bytes:
    """Bytes of the file of a reference policy.

    Raises:
        ConfigurationError: There is none of this name.
    """
