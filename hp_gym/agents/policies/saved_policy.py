"""A trained multilayer perceptron: what it was trained for and what it decides."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal, TypeAlias, Unpack

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from hp_gym import _core
from hp_gym.agents.policies.errors import PolicyError
from hp_gym.envs import settings
from hp_gym.envs.settings import Keywords

Layer: TypeAlias = tuple[NDArray[np.float32], NDArray[np.float32]]
"""Weight (outputs, inputs) and bias (outputs)."""

FORMAT_VERSION: Final = 2
"""Since 2 a policy file holds a checksum."""


MASKED_LOGIT: Final = np.float32(-1e8)
"""What sb3-contrib puts in place of the output of an option that is masked."""

FIRST_TABLE: Final[Mapping[str, tuple[float, float]]] = {
    "time_s": (0.0, 3600.0),
    "speed_m_s": (0.0, 40.0),
    "traction_power_w": (-100_000.0, 100_000.0),
    "evaporating_pressure_bar": (0.0, 10.0),
    "discharge_temperature_degc": (-40.0, 140.0),
    "battery_power_w": (-100_000.0, 100_000.0),
    "compressor_power_w": (0.0, 5000.0),
    "ptc_power_w": (0.0, 6000.0),
    "auxiliary_power_w": (0.0, 1500.0),
    "condenser_heat_flow_w": (0.0, 15_000.0),
    "evaporator_heat_flow_w": (0.0, 15_000.0),
    "ambient_htc_heat_flow_w": (-15_000.0, 15_000.0),
    "ambient_chiller_heat_flow_w": (-15_000.0, 15_000.0),
    "cabin_condenser_heat_flow_w": (0.0, 15_000.0),
    "cabin_evaporator_heat_flow_w": (0.0, 15_000.0),
    "front_condenser_heat_flow_w": (0.0, 15_000.0),
    "front_evaporator_heat_flow_w": (0.0, 15_000.0),
    "htc_condenser_heat_flow_w": (0.0, 15_000.0),
    "ambient_radiator_loop_heat_flow_w": (-15_000.0, 15_000.0),
    "radiator_battery_loop_heat_flow_w": (-15_000.0, 15_000.0),
    "radiator_low_temperature_heat_flow_w": (-15_000.0, 15_000.0),
    **{f"speed_in_{seconds}_s": (0.0, 40.0) for seconds in (2, 5, 10, 20, 40, 80)},
    "time_left_s": (0.0, 3600.0),
}
"""Bounds that rows had before policies said theirs, where they are others now (docs/versions.md)."""

_FROZEN: Final = ConfigDict(frozen=True, extra="forbid", strict=True)


class PolicyEnvironment(BaseModel):
    """The arguments of `EVHeatPumpEnv` that a policy depends on.

    Rows and options are meant by name: a policy fits every vehicle that has the rows, in whatever order.
    """

    model_config = _FROZEN

    continuous: bool
    actions: tuple[str, ...]
    """Actuators, in the order of an action."""
    observations: tuple[str, ...]
    """Rows of an observation, no names of groups."""
    control_interval_s: Annotated[int, Field(ge=1)]
    action_options: dict[str, tuple[str, ...]] | None = None
    """Options of each action, none for levels; None where rows and options are the default architecture's."""

    observation_bounds: dict[str, tuple[float, float]] | None = None
    """Lowest and highest value of each row; None in older files, which mean those of `FIRST_TABLE`."""

    @classmethod
    def resolve(cls, **chosen: Unpack[Keywords]) -> "PolicyEnvironment":
        """Returns the settings with every set and group spelled out.

        Args:
            **chosen: `vehicle`, `continuous`, `actions`, `action_options`, `observations`,
                `observation_bounds` and `control_interval_s` of the environment.

        Raises:
            ConfigurationError: A name or value is not accepted.
        """
        episode = _episode(**chosen)
        options = settings.option_names(episode)
        environment = cls(
            continuous=chosen.get("continuous", False),
            actions=tuple(options),
            observations=tuple(row[0] for row in episode.observation_rows()),
            observation_bounds={row[0]: (row[2], row[3]) for row in episode.observation_rows()},
            control_interval_s=chosen.get("control_interval_s", 1),
        )
        if environment.is_of_default_rows() and environment.options() == options:
            return environment
        return environment.model_copy(update={"action_options": options})

    def is_of_default_rows(self) -> bool:
        """Whether the default architecture has all rows."""
        try:
            _episode(actions=self.actions, observations=self.observations)
        except _core.ConfigurationError:
            return False
        return True

    def options(self) -> dict[str, tuple[str, ...]]:
        """Returns the options of each action by its name; none for levels.

        Raises:
            ConfigurationError: This version of hp_gym does not know a name.
        """
        if self.action_options is not None:
            return {name: self.action_options.get(name, ()) for name in self.actions}
        return settings.option_names(_episode(actions=self.actions, observations=self.observations))

    def option_counts(self) -> tuple[int, ...]:
        """Returns the number of options of each action; none if continuous.

        Raises:
            ConfigurationError: This version of hp_gym does not know a name.
        """
        options = self.options()
        return () if self.continuous else tuple(len(of_one) or _core.LEVELS for of_one in options.values())

    def keywords(self) -> dict[str, Any]:
        """Returns them as keyword arguments of an environment."""
        choices = {name: list(options) for name, options in self.options().items() if options}
        bounds = self.observation_bounds
        if bounds is None:
            bounds = {name: FIRST_TABLE[name] for name in self.observations if name in FIRST_TABLE}
        return self.model_dump() | {
            "actions": list(self.actions),
            "observations": list(self.observations),
            "action_options": choices,
            "observation_bounds": dict(bounds),
        }


def _episode(**chosen: Unpack[Keywords]) -> _core.Episode:
    return _core.Episode(settings.to_json(**chosen), None, settings.DEFAULT_DISTRIBUTION)


class Network(BaseModel):
    """A multilayer perceptron."""

    model_config = _FROZEN

    hidden_sizes: tuple[Annotated[int, Field(ge=1)], ...]
    activation: Literal["tanh", "relu"]


class Metadata(BaseModel):
    """All that a policy file says beside its numbers."""

    model_config = _FROZEN

    format_version: Literal[1, 2] = FORMAT_VERSION
    algorithm: str
    environment: PolicyEnvironment
    network: Network
    option_counts: tuple[int, ...]
    """Options of each action; none if continuous."""
    output: Literal["argmax", "clip", "tanh"]
    """How the last layer becomes an action: the best option of each branch, or values held in [-1, 1]."""
    masked: bool
    """Whether the policy was trained with action masks, and needs them."""
    seed: int | None
    decisions: int
    """Decisions that it was trained for."""
    package_version: str
    configuration: str
    """Name of the training configuration."""


@dataclass(frozen=True)
class Normalisation:
    """Normalisation of observations, with the values that training ended with."""

    mean: NDArray[np.float64]
    variance: NDArray[np.float64]
    clip: float
    epsilon: float

    def apply(self, observations: NDArray[np.float32]) -> NDArray[np.float32]:
        """Returns normalised observations."""
        centred = (observations - self.mean) / np.sqrt(self.variance + self.epsilon)
        normalised: NDArray[np.float32] = np.clip(centred, -self.clip, self.clip).astype(np.float32)
        return normalised


@dataclass(frozen=True)
class SavedPolicy:
    """A policy ready to decide.

    Attributes:
        metadata: What it was trained for and how.
        layers: The hidden layers and the output.
        normalisation: That of observations, if any.
    """

    metadata: Metadata
    layers: tuple[Layer, ...]
    normalisation: Normalisation | None = None

    @property
    def environment(self) -> dict[str, Any]:
        """Keyword arguments of `EVHeatPumpEnv` and its vector form that the policy needs."""
        return self.metadata.environment.keywords()

    @property
    def needs_masks(self) -> bool:
        """Whether `predict` wants action masks."""
        return self.metadata.masked

    def outputs(self, observations: NDArray[np.float32]) -> NDArray[np.float32]:
        """Returns the outputs of the network (n, outputs): logits, or continuous values before they are held.

        Raises:
            PolicyError: The observations have the wrong shape.
        """
        values = np.asarray(observations, dtype=np.float32)
        rows = len(self.metadata.environment.observations)
        if values.ndim != 2 or values.shape[1] != rows:
            message = f"observations have the shape {values.shape}, but the policy takes (n, {rows})"
            raise PolicyError(message)
        if self.normalisation is not None:
            values = self.normalisation.apply(values)
        for weight, bias in self.layers[:-1]:
            values = values @ weight.T + bias
            if self.metadata.network.activation == "tanh":
                np.tanh(values, out=values)
            else:
                np.maximum(values, 0.0, out=values)
        weight, bias = self.layers[-1]
        return values @ weight.T + bias

    def predict(
        self, observations: NDArray[np.float32], masks: NDArray[np.bool_] | None = None
    ) -> NDArray[np.int64] | NDArray[np.float32]:
        """Decides without chance, as `predict(deterministic=True)` of the trained model.

        Args:
            observations: One row an environment.
            masks: One row an environment, as `action_masks()` gives them; used if the policy was trained with
                masks, and needed then.

        Returns:
            One row an environment: options, or values in [-1, 1].

        Raises:
            PolicyError: Observations or masks do not fit.
        """
        outputs = self.outputs(observations)
        match self.metadata.output:
            case "clip":
                return np.clip(outputs, np.float32(-1.0), np.float32(1.0))
            case "tanh":
                return np.tanh(outputs)
        if self.metadata.masked:
            if masks is None or masks.shape != outputs.shape:
                given = None if masks is None else masks.shape
                message = f"masks have the shape {given}, but the policy was trained with {outputs.shape}"
                raise PolicyError(message)
            outputs = np.where(masks, outputs, MASKED_LOGIT)
        ends = np.cumsum(self.metadata.option_counts)[:-1]
        return np.stack([np.argmax(branch, axis=1) for branch in np.split(outputs, ends, axis=1)], axis=1)
