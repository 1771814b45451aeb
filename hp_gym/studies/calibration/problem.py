"""What a calibration fits to what: parameters with ranges, targets, soft claims."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from hp_gym import _core, toml_files
from hp_gym.messages import FileError, OneLineError
from hp_gym.pydantic_errors import one_line
from hp_gym.studies.calibration import measurements
from hp_gym.studies.calibration.calibration_file import CalibrationFile, Parameter
from hp_gym.studies.calibration.measurements import Measurement, MeasurementError

_SIGMAS: Final = ("energy_sigma_share", "final_soc_sigma_pct")


class CalibrationError(OneLineError):
    """A calibration file or a value that it needs is not right."""


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
        measurements: Drives that were measured; a fit sees those with the role `fit`.
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
    measurements: tuple[Measurement, ...] = ()

    def without(self, scenario: str) -> "Problem":
        """The same with a scenario held out; soft claims compare scenarios, so they go too."""
        return self._seen(
            {target.scenario for target in self.targets} - {scenario},
            {target.scenario for target in self.targets} - {scenario},
        )

    def without_measurement(self, name: str) -> "Problem":
        """The same without a measurement."""
        return replace(self, measurements=tuple(one for one in self.measurements if one.name != name))

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
        folder = Path(name).parent if name not in _core.names("calibration") else Path()
        return parse(toml_files.load("calibration", name), folder)
    except FileError as error:
        raise CalibrationError(str(error)) from error
    except (CalibrationError, MeasurementError) as error:
        raise CalibrationError(f"{name}: {error}") from error


def parse(tables: Mapping[str, Any], folder: Path = Path()) -> Problem:
    """Makes a calibration of the tables of its file.

    Args:
        tables: What the file says.
        folder: From where paths of measurements count.

    Raises:
        CalibrationError: A key is missing or unknown, or a value is of the wrong kind or out of range.
        MeasurementError: A measurement does not fit its scenario.
    """
    try:
        file = CalibrationFile.model_validate(tables)
    except ValidationError as error:
        raise CalibrationError(one_line(error)) from error
    parameters = tuple(table.parameter() for table in file.parameter)
    targets = tuple(Target(**table.model_dump()) for table in file.target)
    _once("key", (key for parameter in parameters for key in parameter.keys))
    _once("target", (target.scenario for target in targets))
    _once("soft_claim", (str(table.id) for table in file.soft_claim))
    _once("measurement", (table.name for table in file.measurement))
    settings = file.calibration
    return Problem(
        parameters=parameters,
        targets=targets,
        soft_claims={table.id: table.weight for table in file.soft_claim},
        measurements=measurements.load(file.measurement, folder, settings.vehicle, settings.controller),
        # Of a file without targets: nothing is divided by them.
        **(settings.model_dump() | {key: getattr(settings, key) or 1.0 for key in _SIGMAS}),
    )


def _once(what: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise CalibrationError(f"{what} `{name}` appears twice")
        seen.add(name)
