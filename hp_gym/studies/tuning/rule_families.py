"""Kinds of rules whose numbers are searched: what varies, between what, and where the search starts."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

from hp_gym import toml_files
from hp_gym.near_names import unknown
from hp_gym.overrides import Value
from hp_gym.studies.axes import Axis, Between
from hp_gym.studies.tuning.ambient_bands import Band
from hp_gym.studies.tuning.rule_choices import PAPER, Choices

COOLED_ABOVE_DEGC: Final = 20.0
"""A band that reaches beyond is one that is cooled in."""


def _axis(key: str, values: tuple[Value, ...] | Between) -> Axis:
    # Named by its whole key: the sampler takes axes by name, so that other names would be another search.
    return Axis(key, (key,), values)


BATTERY: Final = _axis("strategy.battery", ("heat", "isolate", "source"))
SWITCHES: Final = tuple(
    _axis(f"strategy.{part}", (True, False)) for part in ("ptc", "ambient", "motor", "transmission")
)
_CABIN: Final = (
    _axis("controller.blower_level", Between(0.3, 1.0)),
    _axis("controller.heating_recirculation", Between(0.0, 0.9)),
    _axis("controller.options.heating_blower_band_k", Between(2.0, 25.0)),
    _axis("controller.options.least_blower_level", Between(0.2, 0.5)),
)
_COOLED_CABIN: Final = (
    _axis("controller.cooling_recirculation", Between(0.0, 0.9)),
    _axis("controller.cooling_blower_level", Between(0.4, 1.0)),
)
_COOLED_BLOWER: Final = _axis("controller.options.cooling_blower_band_k", Between(0.5, 6.0))


@dataclass(frozen=True)
class RuleFamily:
    """Rules of one kind.

    Attributes:
        name: Name of the tuned rules, and of their file.
        what: What they are, for that file.
        base: Controller that they start from.
        axes: What is searched; ranges hold what the base has and what a heat pump engineer would try.
        cooled_axes: What is searched besides in a band that is cooled in.
        options_of: Controller whose options they have where their base has none.
    """

    name: str
    what: str
    base: str
    axes: tuple[Axis, ...]
    cooled_axes: tuple[Axis, ...]
    options_of: str

    def axes_in(self, band: Band) -> tuple[Axis, ...]:
        """What is searched in a band."""
        return self.axes + self.cooled_axes if band.high_degc > COOLED_ABOVE_DEGC else self.axes

    def start(self, band: Band) -> Choices:
        """The rules as their base has them, all sources used and the battery isolated."""
        there = {
            **PAPER.values,
            "strategy.battery": "isolate",
            **_options(self.options_of),
            **_numbers(self.base),
        }
        kept = {axis.keys[0] for axis in self.axes_in(band)}
        if self.base != self.options_of:
            kept |= _options(self.options_of).keys()
        return Choices(self.base, {key: value for key, value in there.items() if key in kept})


HPCU: Final = RuleFamily(
    "hpcu-tuned",
    "HPCU with modes, set points and thresholds tuned in each ambient band",
    "hpcu-modern",
    (
        BATTERY,
        *SWITCHES,
        _axis("controller.cabin_set_point_degc", Between(17.0, 24.0)),
        _axis("controller.htc_set_point_degc", Between(30.0, 90.0)),
        _axis("controller.battery.heat_up_to_degc", Between(-20.0, 20.0)),
        _axis("controller.ptc_from_deviation_k", Between(-20.0, 30.0)),
        *_CABIN,
        _axis("controller.options.ptc_below_target_k", Between(0.0, 5.0)),
        _axis("controller.options.battery_after_cabin_band_k", Between(0.5, 5.0)),
    ),
    (
        *_COOLED_CABIN,
        _axis("controller.cooling_chiller_set_point_degc", Between(0.0, 12.0)),
        _COOLED_BLOWER,
    ),
    "hpcu-modern",
)

THERMOSTAT: Final = RuleFamily(
    "thermostat-tuned",
    "Thermostat with sources, thresholds, power and air tuned in each ambient band",
    "thermostat",
    (
        *SWITCHES,
        _axis("controller.cabin_set_point_degc", Between(17.0, 24.0)),
        _axis("controller.half_band_k", Between(0.1, 3.0)),
        _axis("controller.ptc_below_degc", Between(-30.0, 25.0)),
        _axis("controller.compressor_power_w", Between(0.0, 4000.0)),
        _axis("controller.compressor_power_per_lack_w_k", Between(0.0, 600.0)),
        _axis("controller.compressor_up_to_htc_degc", Between(35.0, 150.0)),
        *_CABIN,
    ),
    (*_COOLED_CABIN, _COOLED_BLOWER),
    "hpcu-modern",
)

FAMILIES: Final = {family.name: family for family in (HPCU, THERMOSTAT)}
"""All of them by name."""


def family(name: str) -> RuleFamily:
    """Returns a family by name.

    Raises:
        ValueError: There is no such family.
    """
    if name not in FAMILIES:
        raise ValueError(unknown("rules that can be tuned", name, FAMILIES))
    return FAMILIES[name]


@cache
def _numbers(controller: str) -> Mapping[str, Value]:
    """All numbers of a controller by dotted key, those of its bases included."""
    return dict(_flat("controller", toml_files.merged("controller", controller)))


def _options(controller: str) -> dict[str, Value]:
    return {key: value for key, value in _numbers(controller).items() if ".options." in key}


def _flat(prefix: str, table: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from _flat(f"{prefix}.{key}", value)
        else:
            yield f"{prefix}.{key}", value
