"""What a calibration fits to what: parameters with ranges, targets, soft claims."""

import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

from hp_gym import _core
from hp_gym.messages import OneLineError

LOGARITHMIC_RATIO: Final = 10.0
"""A range that spans more than this is searched on a logarithmic scale."""


class CalibrationError(OneLineError):
    """A calibration file or a value that it needs is not right."""


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


@dataclass(frozen=True)
class Target:
    """Published totals of a scenario; None where there are none or they are held out."""

    scenario: str
    energy_kwh: float | None
    final_soc_pct: float | None


@dataclass(frozen=True)
class Problem:
    """A calibration.

    Attributes:
        description: What it is.
        vehicle: Vehicle whose values are free.
        controller: Controller whose values are free.
        parameters: Free values.
        targets: What the fit sees.
        soft_claims: Weight of each claim of the text (by number) that the fit sees too.
        energy_sigma_share: Spread of an energy error that counts 1, as a share.
        final_soc_sigma_pct: The same for the final state of charge, in points.
        prior_sigma_share: The same for the distance from the prior, as a share of the range.
        maximum_evaluations: Evaluations of all targets after which the fit stops.
        seed: Seed of the disturbed starts.
        soft_claim_margin: Margin that the fit wants a soft claim to hold with, in units of its scale.
        subset_energy: Scenarios whose energy a fit to a subset sees.
        subset_final_soc: Scenarios whose final state of charge a fit to a subset sees.
    """

    description: str
    vehicle: str
    controller: str
    parameters: tuple[Parameter, ...]
    targets: tuple[Target, ...]
    soft_claims: Mapping[int, float]
    energy_sigma_share: float
    final_soc_sigma_pct: float
    prior_sigma_share: float
    maximum_evaluations: int
    seed: int = 0
    soft_claim_margin: float = 0.0
    subset_energy: tuple[str, ...] = ()
    subset_final_soc: tuple[str, ...] = ()

    def without(self, scenario: str) -> "Problem":
        """The same with a scenario held out; soft claims compare scenarios, so they go too."""
        return self._seen(
            {target.scenario for target in self.targets} - {scenario},
            {target.scenario for target in self.targets} - {scenario},
        )

    def subset(self) -> "Problem":
        """The same with only the subset seen.

        Raises:
            CalibrationError: The file names no subset.
        """
        if not self.subset_energy:
            raise CalibrationError("the calibration has no `subset_energy`")
        return self._seen(set(self.subset_energy), set(self.subset_final_soc))

    def _seen(self, energies: set[str], final_socs: set[str]) -> "Problem":
        targets = tuple(
            Target(
                target.scenario,
                target.energy_kwh if target.scenario in energies else None,
                target.final_soc_pct if target.scenario in final_socs else None,
            )
            for target in self.targets
        )
        return replace(self, targets=targets, soft_claims={})


def load(name: str) -> Problem:
    """Loads a calibration.

    Args:
        name: Name of a file in `configs/calibration`, or a path.

    Raises:
        CalibrationError: Something in the file is wrong.
        ConfigurationError: There is no such file.
    """
    try:
        return parse(tomllib.loads(_core.config_text("calibration", name)))
    except (tomllib.TOMLDecodeError, CalibrationError) as error:
        raise CalibrationError(f"{name}: {error}") from error


def parse(tables: Mapping[str, Any]) -> Problem:
    """Makes a calibration of the tables of its file.

    Raises:
        CalibrationError: A key is missing, unknown or out of order.
    """
    _allow("the file", tables, {"calibration", "parameter", "target", "soft_claim"})
    head = tables.get("calibration", {})
    fields = {"description", "vehicle", "controller", "energy_sigma_share", "final_soc_sigma_pct"}
    fields |= {"prior_sigma_share", "maximum_evaluations", "seed", "soft_claim_margin"}
    fields |= {"subset_energy", "subset_final_soc"}
    _allow("[calibration]", head, fields)
    targets = tuple(_target(table) for table in tables.get("target", ()))
    if not targets:
        raise CalibrationError("there is no [[target]]")
    parameters = tuple(_parameter(table) for table in tables.get("parameter", ()))
    if not parameters:
        raise CalibrationError("there is no [[parameter]]")
    _once("key", (key for parameter in parameters for key in parameter.keys))
    _once("target", (target.scenario for target in targets))
    try:
        soft_claims = {int(table["id"]): float(table["weight"]) for table in tables.get("soft_claim", ())}
        values: dict[str, Any] = {
            key: tuple(value) if isinstance(value, list) else value for key, value in head.items()
        }
        return Problem(parameters=parameters, targets=targets, soft_claims=soft_claims, **values)
    except (KeyError, TypeError) as error:
        raise CalibrationError(f"something is missing: {error}") from error


def _parameter(table: Mapping[str, Any]) -> Parameter:
    where = f"[[parameter]] {table.get('key', table.get('keys', '?'))}"
    _allow(where, table, {"key", "keys", "low", "high", "prior", "prior_weight", "source"})
    if ("key" in table) == ("keys" in table):
        raise CalibrationError(f"{where}: needs either `key` or `keys`")
    try:
        low, high, prior = float(table["low"]), float(table["high"]), float(table["prior"])
        keys = tuple(table["keys"]) if "keys" in table else (str(table["key"]),)
        parameter = Parameter(
            keys, low, high, prior, str(table["source"]), float(table.get("prior_weight", 1.0))
        )
    except KeyError as error:
        raise CalibrationError(f"{where}: {error} is missing") from error
    if not low <= prior <= high or low == high:
        raise CalibrationError(f"{where}: must be low <= prior <= high, but is {low}, {prior}, {high}")
    return parameter


def _target(table: Mapping[str, Any]) -> Target:
    where = f"[[target]] {table.get('scenario', '?')}"
    _allow(where, table, {"scenario", "energy_kwh", "final_soc_pct"})
    if "scenario" not in table:
        raise CalibrationError(f"{where}: `scenario` is missing")
    return Target(str(table["scenario"]), table.get("energy_kwh"), table.get("final_soc_pct"))


def _allow(where: str, table: Mapping[str, Any], allowed: set[str]) -> None:
    unknown = sorted(set(table) - allowed)
    if unknown:
        raise CalibrationError(
            f"{where}: unknown `{unknown[0]}`, expected one of {', '.join(sorted(allowed))}"
        )


def _once(what: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise CalibrationError(f"{what} `{name}` appears twice")
        seen.add(name)
