"""A calibration file as it is written, every key and value checked."""

import math
from dataclasses import dataclass
from typing import Annotated, Final, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from hp_gym.studies.calibration.measurements import MeasurementTable

LOGARITHMIC_RATIO: Final = 10.0
"""A range that spans more than this is searched on a logarithmic scale."""

_CHECKED: Final = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
_LARGEST: Final = 1e12

_Value = Annotated[float, Field(ge=-_LARGEST, le=_LARGEST)]
_Positive = Annotated[float, Field(gt=0.0, le=_LARGEST)]
_NotNegative = Annotated[float, Field(ge=0.0, le=_LARGEST)]
_Name = Annotated[str, Field(min_length=1, max_length=300)]


@dataclass(frozen=True)
class Parameter:
    """A free value.

    Attributes:
        keys: Dotted keys that share the value, each `vehicle.`, `controller.` or `scenario.` and its path.
        low: Lower bound.
        high: Upper bound.
        prior: Value expected before the fit.
        source: Where range and prior come from.
        prior_weight: How much more than others it is held at its prior.
    """

    keys: tuple[str, ...]
    low: float
    high: float
    prior: float
    source: str
    prior_weight: float = 1.0

    @property
    def name(self) -> str:
        """First key."""
        return self.keys[0]

    @property
    def logarithmic(self) -> bool:
        """Whether the search runs on a logarithmic scale."""
        return self.low > 0.0 and self.high / self.low > LOGARITHMIC_RATIO

    def to_share(self, value: float) -> float:
        """Position of a value in the range, 0 to 1."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def at_bound(self, value: float, share: float) -> bool:
        """Whether a value is within a share of the plain range of a bound, whatever the search's scale."""
        return min(value - self.low, self.high - value) <= share * (self.high - self.low)

    def from_share(self, share: float) -> float:
        """Value at a position in the range."""
        if self.logarithmic:
            return self.low * math.exp(share * math.log(self.high / self.low))
        return self.low + share * (self.high - self.low)


class ParameterTable(BaseModel):
    """A `[[parameter]]`."""

    model_config = _CHECKED

    key: _Name | None = None
    keys: Annotated[tuple[_Name, ...], Field(min_length=1, max_length=100)] | None = None
    """Several that share the value."""
    low: _Value
    high: _Value
    prior: _Value
    prior_weight: _NotNegative = 1.0
    source: str

    @model_validator(mode="after")
    def _fits(self) -> Self:
        where = self.key or (self.keys or ("?",))[0]
        if (self.key is None) == (self.keys is None):
            message = f"{where}: needs either `key` or `keys`"
            raise ValueError(message)
        if not self.low <= self.prior <= self.high or self.low == self.high:
            message = f"{where}: must be low <= prior <= high, but is {self.low}, {self.prior}, {self.high}"
            raise ValueError(message)
        if 0.0 < self.low < self.high / _LARGEST:
            message = f"{where}: `low` is {self.low}, but must be 0 or at least {self.high / _LARGEST}"
            raise ValueError(message)
        return self

    def parameter(self) -> Parameter:
        """Returns the free value."""
        keys = self.keys if self.keys is not None else (self.key or "",)
        return Parameter(keys, self.low, self.high, self.prior, self.source, self.prior_weight)


class TargetTable(BaseModel):
    """A `[[target]]`."""

    model_config = _CHECKED

    scenario: _Name
    energy_kwh: _Positive | None = None
    final_soc_pct: Annotated[float, Field(ge=0.0, le=100.0)] | None = None


class ClaimTable(BaseModel):
    """A `[[soft_claim]]`."""

    model_config = _CHECKED

    id: Annotated[int, Field(ge=1, le=1000)]
    weight: _NotNegative


class CalibrationTable(BaseModel):
    """`[calibration]`; see `Problem` for what the values mean."""

    model_config = _CHECKED

    description: str
    vehicle: _Name
    controller: _Name
    energy_sigma_share: _Positive | None = None
    """Needed where there is a `[[target]]`, as the next one."""
    final_soc_sigma_pct: _Positive | None = None
    prior_sigma_share: _Positive
    maximum_evaluations: Annotated[int, Field(ge=1, le=1_000_000_000)]
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    soft_claim_margin: _NotNegative = 0.0
    subset_energy: tuple[_Name, ...] = ()
    subset_final_soc: tuple[_Name, ...] = ()


class CalibrationFile(BaseModel):
    """The whole file."""

    model_config = _CHECKED

    calibration: CalibrationTable
    parameter: Annotated[tuple[ParameterTable, ...], Field(min_length=1)]
    target: tuple[TargetTable, ...] = ()
    soft_claim: tuple[ClaimTable, ...] = ()
    measurement: tuple[MeasurementTable, ...] = ()

    @model_validator(mode="after")
    def _has_data(self) -> Self:
        if not self.target and not any(one.role == "fit" for one in self.measurement):
            message = "there is nothing to fit: needs a [[target]], or a [[measurement]] with the role `fit`"
            raise ValueError(message)
        for key in ("energy_sigma_share", "final_soc_sigma_pct"):
            if self.target and getattr(self.calibration, key) is None:
                message = f"`calibration.{key}` is missing"
                raise ValueError(message)
        return self
