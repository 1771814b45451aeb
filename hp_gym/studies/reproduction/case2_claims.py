"""Claims of the paper's section 3.2, the transmission as a heat source, and of the limits."""

from typing import Final

import numpy as np

from hp_gym.studies.reproduction.case1_claims import CABIN, HTC, HTC_TARGET_DEGC
from hp_gym.studies.reproduction.claim import claim
from hp_gym.studies.reproduction.conditions import Outcome, above, at_least, at_most, below
from hp_gym.studies.reproduction.measures import energy_kwh, first_time_s, mean
from hp_gym.studies.reproduction.paper import LABELS
from hp_gym.studies.reproduction.runs import Runs

PRESSURE_TOLERANCE_BAR: Final = 0.05
TEMPERATURE_TOLERANCE_K: Final = 0.1


@claim(19)
def transmission_makes_no_cabin_difference(runs: Runs) -> Outcome:
    """The transmission makes no noticeable cabin difference with the PTC on.

    D1 against D2: at most 1.0 K at any time.
    """
    difference_k = float(np.max(np.abs(runs["D1"][CABIN] - runs["D2"][CABIN])))
    return Outcome(f"largest difference {difference_k:.2f} K", [at_most(difference_k, 1.0, 0.25)])


@claim(20)
def transmission_saves_energy(runs: Runs) -> Outcome:
    """With the PTC on the transmission saves energy.

    Energy of D2 below D1.
    """
    without_kwh, with_kwh = runs["D1"].summary["energy_kwh"], runs["D2"].summary["energy_kwh"]
    return Outcome(f"D1 {without_kwh:.3f}, D2 {with_kwh:.3f} kWh", [below(with_kwh, without_kwh, 0.05)])


@claim(21)
def transmission_costs_energy_without_the_ptc(runs: Runs) -> Outcome:
    """With the PTC off the transmission costs energy.

    Energy of D4 above D3.
    """
    without_kwh, with_kwh = runs["D3"].summary["energy_kwh"], runs["D4"].summary["energy_kwh"]
    return Outcome(f"D3 {without_kwh:.3f}, D4 {with_kwh:.3f} kWh", [above(with_kwh, without_kwh, 0.05)])


@claim(22)
def transmission_improves_the_cabin_without_the_ptc(runs: Runs) -> Outcome:
    """With the PTC off the transmission improves the cabin.

    D4 ends at least 0.5 K above D3.
    """
    ends_degc = [float(runs[label][CABIN][-1]) for label in ("D3", "D4")]
    return Outcome(
        f"end D3 {ends_degc[0]:.2f}, D4 {ends_degc[1]:.2f} degC",
        [at_least(ends_degc[1] - ends_degc[0], 0.5, 0.25)],
    )


@claim(23)
def extraction_keeps_the_transmission_lossier(runs: Runs) -> Outcome:
    """Extraction keeps the transmission colder and lossier.

    Mean temperature of D2 below D1, loss energy above.
    """
    means_degc = [mean(runs[label], "transmission_temperature_degc") for label in ("D1", "D2")]
    losses_kwh = [energy_kwh(runs[label], "transmission_loss_w") for label in ("D1", "D2")]
    return Outcome(
        f"mean D1 {means_degc[0]:.2f}, D2 {means_degc[1]:.2f} degC; "
        f"loss {losses_kwh[0]:.3f}, {losses_kwh[1]:.3f} kWh",
        [below(means_degc[1], means_degc[0], 1.0), above(losses_kwh[1], losses_kwh[0], 0.02)],
    )


@claim(24)
def htc_target_is_reached_earlier(runs: Runs) -> Outcome:
    """The HTC target is reached slightly earlier, so the PTC is used less.

    Time to 84.9 degC not later in D2, which must reach it; PTC energy lower.
    """
    without, with_transmission = runs["D1"], runs["D2"]
    times_s = [first_time_s(run, HTC, HTC_TARGET_DEGC) for run in (without, with_transmission)]
    energies_kwh = [energy_kwh(run, "ptc_power_w") for run in (without, with_transmission)]
    highest_degc = float(np.max(with_transmission[HTC]))
    conditions = [
        at_least(highest_degc, HTC_TARGET_DEGC, 2.0),
        below(energies_kwh[1], energies_kwh[0], 0.05),
    ]
    if np.isfinite(times_s[1]):
        conditions.append(at_most(times_s[1], times_s[0], 30.0))
    return Outcome(
        f"{HTC_TARGET_DEGC} degC at D1 {times_s[0]:.1f}, D2 {times_s[1]:.1f} s "
        f"(D2 at most {highest_degc:.1f} degC); "
        f"PTC D1 {energies_kwh[0]:.3f}, D2 {energies_kwh[1]:.3f} kWh",
        conditions,
    )


@claim(25)
def extraction_costs_little(runs: Runs) -> Outcome:
    """With the PTC on the cost of extraction is negligible.

    Compressor energy of D1 and D2 within 0.1 kWh.
    """
    energies_kwh = [energy_kwh(runs[label], "compressor_power_w") for label in ("D1", "D2")]
    return Outcome(
        f"compressor D1 {energies_kwh[0]:.3f}, D2 {energies_kwh[1]:.3f} kWh",
        [at_most(abs(energies_kwh[1] - energies_kwh[0]), 0.1, 0.1)],
    )


@claim(26)
def no_limit_is_breached(runs: Runs) -> Outcome:
    """No limit is breached.

    30 bar, HTC 90 degC, chiller -10 degC, at every step of all nine (tolerance 0.05 bar, 0.1 K).
    """
    nine = [runs[label] for label in LABELS.values()]
    highest_bar = max(float(np.max(run["condensing_pressure_bar"])) for run in nine)
    hottest_degc = max(float(np.max(run[HTC])) for run in nine)
    coldest_degc = min(float(np.min(run["chiller_supply_temperature_degc"])) for run in nine)
    return Outcome(
        f"highest {highest_bar:.2f} bar, HTC {hottest_degc:.2f} degC, chiller {coldest_degc:.2f} degC",
        [
            at_most(highest_bar, 30.0 + PRESSURE_TOLERANCE_BAR, 0.5),
            at_most(hottest_degc, 90.0 + TEMPERATURE_TOLERANCE_K, 1.0),
            at_least(coldest_degc, -10.0 - TEMPERATURE_TOLERANCE_K, 1.0),
        ],
    )


CASE2_CLAIMS: Final = (
    transmission_makes_no_cabin_difference,
    transmission_saves_energy,
    transmission_costs_energy_without_the_ptc,
    transmission_improves_the_cabin_without_the_ptc,
    extraction_keeps_the_transmission_lossier,
    htc_target_is_reached_earlier,
    extraction_costs_little,
    no_limit_is_breached,
)
