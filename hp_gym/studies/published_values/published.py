"""The file of published values: what is driven, what is judged, and by how much it may be off."""

from pathlib import Path
from typing import Annotated, Any, Final, Literal

from hp_gym import extras, toml_files
from hp_gym.messages import FileError, OneLineError

with extras.needed("studies"):
    from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

    from hp_gym.pydantic_errors import one_line

DEFAULT_FILE: Final = "published"

_CHECKED: Final = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
_Changes = dict[str, Any]


class ValidationFileError(OneLineError):
    """A file of published values, or a value in it, is not right."""


class Rig(BaseModel):
    """A vehicle on a bench.

    Attributes:
        vehicle: Its name.
        judged: The side whose heat is the capacity.
        settings: Actuators in physical units; what is not named is off or isolated.
        changes: Of the vehicle, by key.
    """

    model_config = _CHECKED

    vehicle: str
    judged: Literal["condenser", "evaporator"]
    settings: dict[str, str | float]
    changes: _Changes = {}


class RigExperiment(BaseModel):
    """A steady point of a rig.

    Attributes:
        rig: Its name.
        room_degc: Air of the room (the cabin).
        recirculation: Share of the room's air in what the blower moves.
        bath_degc: Temperature of the bath (the battery), where the rig has one.
        speed_rev_s: Compressor speed that is held.
        capacity_w: Capacity that the displacement is set to.
        displacement_of: Experiment whose displacement is taken; the vehicle's own where neither is given.
        duration_s: How long it settles; the last minute counts.
    """

    model_config = _CHECKED

    name: str
    kind: Literal["rig"]
    rig: str
    ambient_degc: float
    room_degc: float
    recirculation: float = 0.95
    bath_degc: float | None = None
    speed_rev_s: float
    capacity_w: float | None = None
    displacement_of: str | None = None
    duration_s: Annotated[int, Field(ge=120)] = 900
    changes: _Changes = {}


class ParkedExperiment(BaseModel):
    """A car at rest in a chamber, soaked at its temperature.

    Attributes:
        blower_level: Largest blower level; the rules' own by default.
        off: Whether nothing runs, flaps closed.
        cabin_degc: Cabin at the start, where it is not the soak temperature.
    """

    model_config = _CHECKED

    name: str
    kind: Literal["parked"]
    cars: tuple[str, ...]
    ambient_degc: float
    minutes: Annotated[float, Field(ge=30.0)]
    set_point_degc: float = 22.0
    blower_level: float | None = None
    off: bool = False
    cabin_degc: float | None = None
    solar_gain_w: float = 0.0
    relative_humidity: float = 0.8
    strategy: dict[str, bool | str] = {}


class TripExperiment(BaseModel):
    """Cars, or one vehicle, on the road, soaked at ambient temperature.

    Attributes:
        cycles: Drive cycles one after the other.
        until_empty: Whether they are repeated until the battery is empty.
        cruise_km_h: Constant speed instead of cycles, for `minutes`.
        climate: `auto`, `heat` (never cools), or `off`.
        dynamometer: Whether the road load is that of 24 degC: no denser air, no colder tyres.
        initial: Further temperatures at the start.
    """

    model_config = _CHECKED

    name: str
    kind: Literal["trip"]
    cars: tuple[str, ...] = ()
    vehicle: str | None = None
    controller: str | None = None
    cycles: tuple[str, ...] = ()
    until_empty: bool = False
    cruise_km_h: float | None = None
    minutes: float | None = None
    ambient_degc: float | None = None
    ambients_degc: tuple[float, ...] = ()
    climate: Literal["auto", "heat", "off"]
    dynamometer: bool = False
    strategy: dict[str, bool | str] = {}
    changes: _Changes = {}
    initial: dict[str, float] = {}

    @model_validator(mode="after")
    def _complete(self) -> "TripExperiment":
        if (self.vehicle is None) == (not self.cars):
            raise ValueError("must have either `cars` or a `vehicle`")
        if (self.ambient_degc is None) == (not self.ambients_degc):
            raise ValueError("must have either `ambient_degc` or `ambients_degc`")
        if bool(self.cycles) == (self.cruise_km_h is not None and self.minutes is not None):
            raise ValueError("must have either `cycles` or `cruise_km_h` with `minutes`")
        return self


class LayoutExperiment(BaseModel):
    """What a vehicle is made of."""

    model_config = _CHECKED

    name: str
    kind: Literal["layout"]
    vehicle: str


Experiment = Annotated[
    RigExperiment | ParkedExperiment | TripExperiment | LayoutExperiment, Field(discriminator="kind")
]


class Row(BaseModel):
    """A published value and when the model meets it.

    Attributes:
        id: Its number in the project's list; of several cars each gets a number behind it.
        also: Other lists' numbers of the same value.
        low: Least published value; None where the highest alone is known.
        high: Highest published value.
        tolerance: Deviation allowed beyond them, in the row's unit.
        tolerance_pct: The same as a share of the published value.
        set: Size that is set to a published one.
        experiment: What is driven.
        against: What it is compared with.
        take: Figure of an experiment.
        as_: How the two are compared.
        over: A row for each car, or one for the mean of all.
        explanation: Why the row fails, checked by a run; per car where they differ.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, populate_by_name=True)

    id: str
    also: tuple[str, ...] = ()
    group: Literal["rig", "chamber", "car"]
    text: str
    conditions: str
    low: float | None = None
    high: float | None = None
    unit: str
    tolerance: float | None = None
    tolerance_pct: float | None = None
    source: str
    set: str | None = None
    experiment: str
    against: str | None = None
    take: str
    as_: Annotated[Literal["value", "ratio", "change_pct", "difference"], Field(alias="as")] = "value"
    over: Literal["each", "mean"] = "mean"
    explanation: str | dict[str, str] = ""

    @model_validator(mode="after")
    def _complete(self) -> "Row":
        if self.low is None and self.high is None:
            raise ValueError(f"row `{self.id}` has neither `low` nor `high`")
        if (self.tolerance is None) == (self.tolerance_pct is None):
            raise ValueError(f"row `{self.id}` must have either `tolerance` or `tolerance_pct`")
        if (self.against is None) != (self.as_ == "value"):
            raise ValueError(f"row `{self.id}` must have both `against` and `as`, or neither")
        return self

    def bounds(self) -> tuple[float | None, float | None]:
        """Least and highest value that passes."""

        def margin(value: float) -> float:
            return self.tolerance if self.tolerance is not None else abs(value) * self.tolerance_pct_ / 100.0

        low = None if self.low is None else self.low - margin(self.low)
        return low, None if self.high is None else self.high + margin(self.high)

    @property
    def tolerance_pct_(self) -> float:
        """Relative tolerance, 0 where an absolute one is given."""
        return self.tolerance_pct or 0.0


class Reference(BaseModel):
    """A published value that is not judged, and why."""

    model_config = _CHECKED

    id: str
    text: str
    source: str
    reason: str


class Published(BaseModel):
    """A file of published values."""

    model_config = _CHECKED

    description: str
    scenario: str
    controller: str
    cars: dict[str, str]
    bench: _Changes
    rig: dict[str, Rig]
    experiment: tuple[Experiment, ...]
    row: Annotated[tuple[Row, ...], Field(min_length=1)]
    reference: tuple[Reference, ...] = ()

    @model_validator(mode="after")
    def _known(self) -> "Published":
        names = [experiment.name for experiment in self.experiment]
        ids = [row.id for row in self.row] + [reference.id for reference in self.reference]
        for what, given in (("experiment", names), ("row", ids)):
            twice = next((name for name in given if given.count(name) > 1), None)
            if twice is not None:
                raise ValueError(f"{what} `{twice}` appears twice")
        for experiment in self.experiment:
            self._check_experiment(experiment, names)
        for row in self.row:
            for key, name in (("experiment", row.experiment), ("against", row.against)):
                if name is not None and name not in names:
                    raise ValueError(f"row `{row.id}` names `{name}` as `{key}`; there is no such experiment")
        return self

    def _check_experiment(self, experiment: Experiment, names: list[str]) -> None:
        if isinstance(experiment, RigExperiment):
            if experiment.rig not in self.rig:
                raise ValueError(
                    f"experiment `{experiment.name}` names `{experiment.rig}`; there is no such rig"
                )
            before = names[: names.index(experiment.name)]
            if experiment.displacement_of is not None and experiment.displacement_of not in before:
                raise ValueError(
                    f"experiment `{experiment.name}` has the displacement of `{experiment.displacement_of}`, "
                    "which must be an experiment above it"
                )
        elif isinstance(experiment, ParkedExperiment | TripExperiment):
            for car in experiment.cars:
                if car not in self.cars:
                    raise ValueError(f"experiment `{experiment.name}` names `{car}`; there is no such car")


def load(name: str = DEFAULT_FILE) -> Published:
    """Loads a file of published values.

    Args:
        name: Name of a file in `configs/validation`, or a path.

    Raises:
        ValidationFileError: Something in the file is wrong; the message says what.
        ConfigurationError: There is no such file.
        OSError: It cannot be read.
    """
    try:
        path = Path(name)
        tables = toml_files.read(path) if path.suffix == ".toml" else toml_files.load("validation", name)
        return Published.model_validate(tables)
    except FileError as error:
        raise ValidationFileError(str(error)) from error
    except ValidationError as error:
        raise ValidationFileError(f"{name}: {one_line(error)}") from error
