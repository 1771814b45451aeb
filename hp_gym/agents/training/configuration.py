"""Training configurations: what is learned, on which trips, how, and how it is watched."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Self, TypeAlias

import tomlkit
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    TypeAdapter,
    ValidationError,
    field_validator,
    model_validator,
)

from hp_gym import toml_files
from hp_gym.messages import FileError, OneLineError
from hp_gym.pydantic_errors import one_line

Count: TypeAlias = Annotated[int, Field(ge=1, le=2**62)]
Positive: TypeAlias = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative: TypeAlias = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Pair: TypeAlias = Annotated[list[float], Field(min_length=2, max_length=2)]
Share: TypeAlias = Annotated[float, Field(ge=0.0, le=1.0)]


class TrainingConfigurationError(OneLineError):
    """A training configuration that cannot be used; the message says where and why, in one line."""


class _Table(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class Environments(_Table):
    """How many environments are driven side by side."""

    number: Count
    threads: Count | None = None
    """Of the plant; as many as there are cores by default. Results do not depend on it."""


class Environment(_Table):
    """Arguments of `EVHeatPumpEnv`; see there."""

    distribution: str = "train-v2"
    vehicle: str | None = None
    control_interval_s: Count = 1
    actions: str | list[str] = "default"
    observations: str | list[str] = "default"
    reward: str | dict[str, float | str] = "balanced"
    continuous: bool = False
    sensor_noise: NotNegative = 0.0


class LearningRate(_Table):
    """Learning rate over the training."""

    start: Positive
    end: NotNegative | None = None
    """As at the start by default."""
    schedule: Literal["linear", "cosine"] = "linear"

    def at(self, remaining: float) -> float:
        """Returns it for the share of the training that remains, 1 at the start."""
        if self.end is None:
            return self.start
        share = remaining if self.schedule == "linear" else 0.5 * (1.0 - math.cos(math.pi * remaining))
        return self.end + (self.start - self.end) * share


class Network(_Table):
    """Multilayer perceptrons of policy and value function, which share nothing."""

    hidden_sizes: Annotated[list[Count], Field(max_length=64)]
    value_hidden_sizes: Annotated[list[Count], Field(max_length=64)] | None = None
    """As those of the policy by default."""
    activation: Literal["tanh", "relu"] = "tanh"


class NormalisationSettings(_Table):
    """Scaling of observations and rewards beyond the environment's own."""

    observations: bool = False
    observation_clip: Positive = 10.0
    rewards: bool = False
    reward_clip: Positive = 10.0
    reward_scale: Positive = 1.0
    """Factor on rewards; points of the environment are of the order of a hundredth a second."""
    typical_cost: list[Pair] | None = None
    """Ambient temperatures in degC, rising, and what a trip there costs in points; rewards are divided by it.

    A cold trip costs twenty times a mild one: without this, mild weather is learnt last. What is best for a
    trip stays the same.
    """

    @field_validator("typical_cost")
    @classmethod
    def _rises(cls, table: list[list[float]] | None) -> list[list[float]] | None:
        rows = table if table is not None else [[0.0, 1.0]]
        degc = [row[0] for row in rows]
        if not rows or degc != sorted(set(degc)) or min(row[1] for row in rows) <= 0.0:
            message = "must be pairs of rising temperatures and values above 0"
            raise ValueError(message)
        return table


class ComfortConstraintSettings(_Table):
    """Comfort that must hold in every climate: discomfort weighs more where it exceeds that of rules."""

    interval_decisions: Count
    """Between two looks at fixed trips, after each of which the weight moves."""
    ambient_degc: Annotated[list[float], Field(min_length=1)]
    """Ambient temperatures in degC, rising; between them weights are interpolated, beyond them held."""
    rules: str = "hpcu"
    """Controller that must not be more comfortable, by name or path."""
    margin_k: NotNegative = 0.0
    """By how much the policy must be more comfortable."""
    margin_share: Share = 1.0
    """Largest margin as a share of the rules' discomfort."""
    trips: Count = 256
    seed: Annotated[int, Field(ge=0)] = 2_000_000
    start: NotNegative = 0.0
    """What is added to the weight at the beginning."""
    step_per_k: Positive = 0.2
    """Lasting change of the weight for each Kelvin of violation (at most one) at each look."""
    damping_per_k: NotNegative = 0.0
    """Passing change for each Kelvin of violation (at most one): a policy that follows late overshoots."""
    convex: bool = False
    """Whether the addition grows with the cabin's distance from comfort, so that discomfort costs its square
    up to the allowed one and a straight line beyond. Where energy and comfort trade evenly, as with the PTC
    in deep cold, the best policy is otherwise all or nothing, and no weight between them is found."""
    largest: Positive = 3.0
    """Largest addition to the weight, where the condition cannot be met."""

    @field_validator("ambient_degc")
    @classmethod
    def _rises(cls, degc: list[float]) -> list[float]:
        if degc != sorted(set(degc)):
            message = "must be rising temperatures"
            raise ValueError(message)
        return degc


class ValidationSettings(_Table):
    """How the policy is watched: the same trips every time, driven without chance."""

    interval_decisions: Count
    trips: Count = 64
    seed: Annotated[int, Field(ge=0)] = 1_000_000
    distribution: str | None = None
    """That of the training by default, with seeds that training does not use."""
    reward: str | dict[str, float | str] = "balanced"
    """What the score is counted in, whatever the policy is trained with."""


class ImitationSettings(_Table):
    """A warm start: the policy imitates a rule-based controller before it learns from rewards."""

    teacher: str = "hpcu-tuned"
    """Controller, by name or path."""
    rounds: Annotated[int, Field(ge=0)] = 3
    """0 for no warm start. In the first the teacher drives, in the others mostly the policy."""
    environments: Count = 512
    steps: Count = 130
    """Decisions in each environment and round."""
    policy_share: Share = 0.7
    """Share of the environments that the policy drives after the first round."""
    disturbed_share: Share = 0.1
    """Share of decisions in which some actuators do what chance says."""
    disturbed_actuators: Share = 0.3
    """Share of the actuators that do so then."""
    epochs: Count = 8
    """Passes over the demonstrations of all rounds so far, in each round."""
    batch_size: Count = 2048
    learning_rate: Positive = 1e-3
    value_weight: NotNegative = 0.5
    """Of the squared error of the value function beside the likelihood of the teacher's actions."""


class PPOHyperparameters(_Table):
    """Arguments of PPO and MaskablePPO by their names in stable-baselines3."""

    n_steps: Count
    batch_size: Annotated[int, Field(ge=2)]
    n_epochs: Count
    gamma: Annotated[float, Field(gt=0.0, le=1.0)]
    gae_lambda: Share = 0.95
    clip_range: Positive = 0.2
    clip_range_vf: Positive | None = None
    normalize_advantage: bool = True
    ent_coef: NotNegative = 0.0
    ent_coef_end: NotNegative | None = None
    """Linear change of `ent_coef` to this at the end; ours."""
    vf_coef: NotNegative = 0.5
    max_grad_norm: Positive = 0.5
    target_kl: Positive | None = None


class RecurrentPPOHyperparameters(PPOHyperparameters):
    """Those of PPO and the memory's."""

    lstm_hidden_size: Count
    n_lstm_layers: Count = 1


class SACHyperparameters(_Table):
    """Arguments of SAC by their names in stable-baselines3."""

    buffer_size: Count
    learning_starts: Annotated[int, Field(ge=0)] = 100
    batch_size: Annotated[int, Field(ge=2)] = 256
    gamma: Annotated[float, Field(gt=0.0, le=1.0)]
    tau: Share = 0.005
    train_freq: Count = 1
    gradient_steps: Count = 1
    ent_coef: Literal["auto"] | NotNegative = "auto"
    target_entropy: Literal["auto"] | float = "auto"


class _Common(_Table):
    description: str = ""
    total_decisions: Count
    checkpoint_interval_decisions: Count
    torch_threads: Annotated[int, Field(ge=1, le=256)] = 2
    environments: Environments
    environment: Environment
    learning_rate: LearningRate
    network: Network
    normalisation: NormalisationSettings = NormalisationSettings()
    comfort_constraint: ComfortConstraintSettings | None = None
    validation: ValidationSettings


class _OnPolicy(_Common):
    hyperparameters: PPOHyperparameters
    imitation: ImitationSettings | None = None

    @model_validator(mode="after")
    def _whole_batches(self) -> Self:
        gathered = self.hyperparameters.n_steps * self.environments.number
        if gathered % self.hyperparameters.batch_size:
            message = (
                f"hyperparameters.batch_size {self.hyperparameters.batch_size} does not divide the "
                f"{gathered} decisions of n_steps and environments.number"
            )
            raise ValueError(message)
        return self


class PPOTraining(_OnPolicy):
    """Training by PPO."""

    algorithm: Literal["ppo"]


class MaskablePPOTraining(_OnPolicy):
    """Training by MaskablePPO."""

    algorithm: Literal["maskable-ppo"]

    @model_validator(mode="after")
    def _has_masks(self) -> Self:
        if self.environment.continuous:
            message = "environment.continuous is true, but maskable-ppo needs options to mask"
            raise ValueError(message)
        return self


class RecurrentPPOTraining(_OnPolicy):
    """Training by RecurrentPPO."""

    algorithm: Literal["recurrent-ppo"]
    hyperparameters: RecurrentPPOHyperparameters

    @model_validator(mode="after")
    def _starts_cold(self) -> Self:
        if self.imitation is not None and self.imitation.rounds:
            message = f"imitation.rounds is {self.imitation.rounds}, but must be 0 for recurrent-ppo"
            raise ValueError(message)
        return self


class SACTraining(_Common):
    """Training by SAC."""

    algorithm: Literal["sac"]
    hyperparameters: SACHyperparameters

    @model_validator(mode="after")
    def _is_continuous(self) -> Self:
        if not self.environment.continuous:
            message = "environment.continuous is false, but sac needs continuous actions"
            raise ValueError(message)
        return self


_NAMED: Final = (
    ("environment", "distribution", "distribution of episodes"),
    ("environment", "vehicle", "vehicle"),
    ("environment", "reward", "reward"),
    ("validation", "distribution", "distribution of episodes"),
    ("validation", "reward", "reward"),
    ("comfort_constraint", "rules", "controller"),
    ("imitation", "teacher", "controller"),
)
"""Keys whose value is the name or path of a file, with the kind of that file."""

Training: TypeAlias = PPOTraining | MaskablePPOTraining | RecurrentPPOTraining | SACTraining

_ADAPTER: Final[TypeAdapter[Training]] = TypeAdapter(Annotated[Training, Field(discriminator="algorithm")])


def load(name: str, changes: Sequence[str] = ()) -> Training:
    """Loads a training configuration.

    Args:
        name: Name of a file in `configs/agents`, or a path. A file may name a `base` and give what differs.
        changes: Single values as `key=value`, dotted key, value in TOML.

    Raises:
        TrainingConfigurationError: Something in it, or in a file that it names as its base, is wrong.
        ConfigurationError: There is no such file.
    """
    tables = _merged(name)
    for change in changes:
        _set(name, tables, change)
    return parse(tables, name)


def parse(tables: dict[str, Any], name: str) -> Training:
    """Makes a configuration of the tables of its file.

    Raises:
        TrainingConfigurationError: Something in them is wrong.
    """
    try:
        return _ADAPTER.validate_python(tables)
    except ValidationError as error:
        message = f"{name}: {one_line(error, skip=str(tables.get('algorithm')))}"
        raise TrainingConfigurationError(message) from error


def to_toml(training: Training) -> str:
    """Returns a configuration as the text of a file, every default spelled out."""
    return tomlkit.dumps(training.model_dump(exclude_none=True))


def read(path: Path) -> Training:
    """Reads a configuration that `to_toml` wrote.

    Raises:
        TrainingConfigurationError: It has been damaged.
        OSError: It cannot be read.
    """
    try:
        tables = toml_files.read(path)
    except FileError as error:
        raise TrainingConfigurationError(str(error)) from error
    return parse(tables, str(path))


def _merged(name: str) -> dict[str, Any]:
    try:
        files = list(toml_files.chain("training configuration", name))
    except FileError as error:
        raise TrainingConfigurationError(str(error)) from error
    return toml_files.overlaid(_with_paths(file, tables) for file, tables in files)


def _with_paths(file: str, tables: dict[str, Any]) -> dict[str, Any]:
    """The tables of a file; paths that count from its folder count from the working folder then."""
    found = dict(tables)
    for section, key, kind in _NAMED:
        values = found.get(section)
        name = values.get(key) if isinstance(values, dict) else None
        if isinstance(values, dict) and isinstance(name, str):
            found[section] = {**values, key: toml_files.beside(kind, file, name)}
    return found


def _set(name: str, tables: dict[str, Any], change: str) -> None:
    key, equals, text = change.partition("=")
    if not equals:
        message = f"`{change}` must have the form key=value"
        raise TrainingConfigurationError(message)
    try:
        value = toml_files.loads(f"value = {text}", key)["value"]
    except FileError:
        value = text.strip()
    *sections, last = key.strip().split(".")
    if len(sections) >= toml_files.DEEPEST:
        message = f"{name}: `{key.strip()}` has more than {toml_files.DEEPEST} parts"
        raise TrainingConfigurationError(message)
    place: Any = tables
    for section in sections:
        place = place.setdefault(section, {})
        if not isinstance(place, dict):
            message = f"{name}: `{key.strip()}`: `{section}` is no table"
            raise TrainingConfigurationError(message)
    place[last] = value
