"""Claims of the paper's section 3.1: the battery as a heat source."""

from typing import Final

import numpy as np

from hp_gym.studies.reproduction.claim import claim
from hp_gym.studies.reproduction.conditions import Outcome, above, at_least, at_most, below
from hp_gym.studies.reproduction.measures import energy_kwh, first_time_s, mean, value_at
from hp_gym.studies.reproduction.runs import Runs
from hp_gym.trajectory import Trajectory

BEFORE_LAST_PHASE_S: Final = 1470.0
LAST_PHASE_S: Final = 1478.0
"""Start of the cycle's extra-high phase."""

REQUEST_W: Final = 5000.0
HTC_TARGET_DEGC: Final = 84.9
HEATED_DEGC: Final = 19.9

CABIN: Final = "cabin_temperature_degc"
BATTERY: Final = "battery_temperature_degc"
HTC: Final = "htc_supply_temperature_degc"
BATTERY_HTC: Final = "battery_htc_heat_flow_w"


def _isolated_at_s(run: Trajectory) -> float:
    """First time without a connection once the battery is heated; the end if there is none."""
    heated_s = first_time_s(run, BATTERY, HEATED_DEGC)
    isolated = run["time_s"][(run["time_s"] >= heated_s) & (run["battery_connection"] == 0.0)]
    return float(isolated[0]) if isolated.size else float(run["time_s"][-1])


@claim(1)
def heated_battery_is_isolated(runs: Runs) -> Outcome:
    """The heated battery quickly reaches 20 degC and is then isolated.

    S1 reaches 19.9 degC before 1200 s; from 30 s later its coolant heat flow stays below 1 W.
    """
    run = runs["S1"]
    reached_s = first_time_s(run, BATTERY, HEATED_DEGC)
    after = run["time_s"] >= reached_s + 30.0
    flow_w = np.abs(run[BATTERY_HTC]) + np.abs(run["battery_chiller_heat_flow_w"])
    highest_w = float(np.max(flow_w[after])) if after.any() else float("nan")
    hottest_degc = float(np.max(run[BATTERY]))
    return Outcome(
        f"{HEATED_DEGC} degC at {reached_s:.0f} s (highest {hottest_degc:.1f} degC), "
        f"then at most {highest_w:.2g} W",
        [below(reached_s, 1200.0, 100.0), below(highest_w, 1.0, 100.0)],
    )


@claim(2)
def request_is_sustained(runs: Runs) -> Outcome:
    """The 5 kW request is sustained while heating.

    Mean within 150 W of 5000 W from first reaching 4900 W until isolation.
    """
    run = runs["S1"]
    flow_w = run[BATTERY_HTC]
    start_s = first_time_s(run, BATTERY_HTC, 4900.0)
    end_s = _isolated_at_s(run)
    heating = (run["time_s"] >= start_s) & (run["time_s"] < end_s)
    if not heating.any():
        highest_w = float(np.max(flow_w))
        return Outcome(f"at most {highest_w:.0f} W", [at_least(highest_w, 4900.0, 500.0)])
    mean_w = float(np.mean(flow_w[heating]))
    return Outcome(
        f"mean {mean_w:.0f} W, least {np.min(flow_w[heating]):.0f} W from {start_s:.0f} to {end_s:.0f} s",
        [at_most(abs(mean_w - REQUEST_W), 150.0, 150.0)],
    )


@claim(3)
def battery_warms_by_its_losses(runs: Runs) -> Outcome:
    """The battery keeps warming by its own losses after isolation, below 30 degC.

    S1 ends between 20.5 and 30 degC.
    """
    end_degc = float(runs["S1"][BATTERY][-1])
    return Outcome(
        f"S1 ends at {end_degc:.2f} degC", [above(end_degc, 20.5, 1.0), below(end_degc, 30.0, 1.0)]
    )


@claim(4)
def cooling_keeps_the_battery_cold(runs: Runs) -> Outcome:
    """Cooling keeps the battery much lower throughout.

    Highest of S2 before 1470 s below half of S3 at 1470 s (degC).
    """
    cooled = runs["S2"]
    highest_degc = float(np.max(cooled[BATTERY][cooled["time_s"] < BEFORE_LAST_PHASE_S]))
    isolated_degc = value_at(runs["S3"], BATTERY, BEFORE_LAST_PHASE_S)
    return Outcome(
        f"S2 at most {highest_degc:.2f} degC, S3 {isolated_degc:.2f} degC",
        [below(highest_degc, 0.5 * isolated_degc, 0.5)],
    )


@claim(5)
def cooled_battery_rises_at_high_speed(runs: Runs) -> Outcome:
    """The cooled battery's temperature rises quickly at the end, at high speed.

    Rate of S2 in the last phase over 4 times the mean rate before.
    """
    run = runs["S2"]
    start_s, end_s = float(run["time_s"][0]), float(run["time_s"][-1])
    change_degc = value_at(run, BATTERY, LAST_PHASE_S)
    before_k_min = 60.0 * (change_degc - value_at(run, BATTERY, start_s)) / (LAST_PHASE_S - start_s)
    last_k_min = 60.0 * (value_at(run, BATTERY, end_s) - change_degc) / (end_s - LAST_PHASE_S)
    return Outcome(
        f"{last_k_min:.3f} K/min after {before_k_min:.3f} K/min",
        [above(last_k_min, 4.0 * before_k_min, 0.2), above(last_k_min, 0.0, 0.2)],
    )


@claim(6)
def isolated_battery_rises_unaided(runs: Runs) -> Outcome:
    """The isolated battery rises unaided, limited by falling loss and rising heat to ambient.

    In the last phase S3's electrical loss is below S2's and its heat flow to ambient rises (slope of a
    straight line through it, as the flow swings with speed).
    """
    cooled, isolated = runs["S2"], runs["S3"]
    losses_kwh = [energy_kwh(run, "battery_loss_w", LAST_PHASE_S) for run in (cooled, isolated)]
    last = isolated["time_s"] > LAST_PHASE_S
    to_ambient_w = isolated["battery_ambient_heat_flow_w"][last]
    slope_w_s = float(np.polyfit(isolated["time_s"][last], to_ambient_w, 1)[0])
    return Outcome(
        f"loss S3 {losses_kwh[1]:.3f} kWh, S2 {losses_kwh[0]:.3f} kWh; "
        f"heat to ambient mean {np.mean(to_ambient_w):.0f} W, {60.0 * slope_w_s:+.2f} W/min",
        [below(losses_kwh[1], losses_kwh[0], 0.01), above(60.0 * slope_w_s, 0.0, 1.0)],
    )


@claim(7)
def heating_the_battery_costs_comfort(runs: Runs) -> Outcome:
    """Heating the battery costs cabin comfort.

    Mean cabin temperature of S1 at least 0.5 K below S3.
    """
    heated_degc, isolated_degc = mean(runs["S1"], CABIN), mean(runs["S3"], CABIN)
    return Outcome(
        f"mean S1 {heated_degc:.2f} degC, S3 {isolated_degc:.2f} degC",
        [at_least(isolated_degc - heated_degc, 0.5, 0.25)],
    )


@claim(8)
def battery_heat_makes_no_cabin_difference(runs: Runs) -> Outcome:
    """Extra battery heat makes no significant cabin difference with the PTC on.

    S2 against S3: at most 1.0 K at any time.
    """
    difference_k = float(np.max(np.abs(runs["S2"][CABIN] - runs["S3"][CABIN])))
    return Outcome(f"largest difference {difference_k:.2f} K", [at_most(difference_k, 1.0, 0.25)])


@claim(9)
def battery_heat_warms_the_chiller(runs: Runs) -> Outcome:
    """The extra battery heat only warms the chiller coolant.

    Mean chiller supply after 300 s higher in S2 than in S3.
    """
    cooled_degc, isolated_degc = (
        mean(runs[label], "chiller_supply_temperature_degc", 300.0) for label in ("S2", "S3")
    )
    return Outcome(
        f"mean S2 {cooled_degc:.2f} degC, S3 {isolated_degc:.2f} degC",
        [above(cooled_degc, isolated_degc, 0.5)],
    )


@claim(10)
def htc_quickly_reaches_its_temperature(runs: Runs) -> Outcome:
    """With the PTC on the HTC quickly reaches its temperature.

    S3 above 84.9 degC before 700 s.
    """
    run = runs["S3"]
    highest_degc = float(np.max(run[HTC][run["time_s"] < 700.0]))
    return Outcome(
        f"at most {highest_degc:.1f} degC before 700 s; {HTC_TARGET_DEGC} degC at "
        f"{first_time_s(run, HTC, HTC_TARGET_DEGC):.0f} s",
        [above(highest_degc, HTC_TARGET_DEGC, 2.0)],
    )


@claim(11)
def cabin_reaches_its_target(runs: Runs) -> Outcome:
    """The cabin reaches its target with the PTC on.

    Highest of S1, S2, S3 each above 21.5 degC.
    """
    highest_degc = {label: float(np.max(runs[label][CABIN])) for label in ("S1", "S2", "S3")}
    return Outcome(
        "highest " + ", ".join(f"{label} {value:.2f} degC" for label, value in highest_degc.items()),
        [above(value, 21.5, 0.5) for value in highest_degc.values()],
    )


@claim(12)
def cabin_suffers_without_the_ptc(runs: Runs) -> Outcome:
    """Without the PTC the cabin suffers.

    Means of S4 and S5 each at least 1 K below S3.
    """
    mean_degc = {label: mean(runs[label], CABIN) for label in ("S3", "S4", "S5")}
    return Outcome(
        "mean " + ", ".join(f"{label} {value:.2f} degC" for label, value in mean_degc.items()),
        [at_least(mean_degc["S3"] - mean_degc[label], 1.0, 0.5) for label in ("S4", "S5")],
    )


@claim(13)
def battery_heat_warms_the_cabin_without_the_ptc(runs: Runs) -> Outcome:
    """Without the PTC battery heat warms the cabin faster and higher.

    S5 ends at least 0.3 K above S4; mean after 600 s higher.
    """
    ends_degc = [float(runs[label][CABIN][-1]) for label in ("S4", "S5")]
    means_degc = [mean(runs[label], CABIN, 600.0) for label in ("S4", "S5")]
    return Outcome(
        f"end S4 {ends_degc[0]:.2f}, S5 {ends_degc[1]:.2f} degC; "
        f"mean after 600 s {means_degc[0]:.2f}, {means_degc[1]:.2f} degC",
        [at_least(ends_degc[1] - ends_degc[0], 0.3, 0.25), above(means_degc[1], means_degc[0], 0.25)],
    )


@claim(14)
def heating_the_battery_costs_energy(runs: Runs) -> Outcome:
    """S1 uses more energy than S3.

    Energy of S1 above that of S3.
    """
    heated_kwh, isolated_kwh = runs["S1"].summary["energy_kwh"], runs["S3"].summary["energy_kwh"]
    return Outcome(f"S1 {heated_kwh:.3f}, S3 {isolated_kwh:.3f} kWh", [above(heated_kwh, isolated_kwh, 0.05)])


@claim(15)
def heating_the_battery_saves_charge(runs: Runs) -> Outcome:
    """S1's final SOC is higher than S2's.

    Final SOC of S1 above that of S2.
    """
    heated_pct, cooled_pct = runs["S1"].summary["final_soc_pct"], runs["S2"].summary["final_soc_pct"]
    return Outcome(f"S1 {heated_pct:.2f} %, S2 {cooled_pct:.2f} %", [above(heated_pct, cooled_pct, 0.2)])


@claim(16)
def warmer_battery_holds_a_higher_voltage(runs: Runs) -> Outcome:
    """A warmer battery loses less and holds a higher voltage.

    Mean terminal voltage of S1 above S2.
    """
    voltages_v = [mean(runs[label], "battery_voltage_v") for label in ("S1", "S2")]
    losses_kwh = [energy_kwh(runs[label], "battery_loss_w") for label in ("S1", "S2")]
    return Outcome(
        f"mean S1 {voltages_v[0]:.1f}, S2 {voltages_v[1]:.1f} V; "
        f"loss {losses_kwh[0]:.3f}, {losses_kwh[1]:.3f} kWh",
        [above(voltages_v[0], voltages_v[1], 1.0)],
    )


@claim(17)
def soc_is_not_proportional_to_energy(runs: Runs) -> Outcome:
    """SOC is not proportional to energy.

    kWh per 100 % SOC: S1 above S3 and S4, both above S2 and S5.
    """

    def ratio_kwh(run: Trajectory) -> float:
        return run.summary["energy_kwh"] / float(run["soc"][0] - run["soc"][-1])

    ratios_kwh = {label: ratio_kwh(runs[label]) for label in ("S1", "S2", "S3", "S4", "S5")}
    heated, isolated, cooled = ("S1",), ("S3", "S4"), ("S2", "S5")
    pairs = [
        (high, low)
        for group, other in ((heated, isolated), (isolated, cooled))
        for high in group
        for low in other
    ]
    return Outcome(
        "kWh per 100 % " + ", ".join(f"{label} {value:.2f}" for label, value in ratios_kwh.items()),
        [above(ratios_kwh[high], ratios_kwh[low], 0.2) for high, low in pairs],
    )


@claim(18)
def battery_heat_is_not_worth_it(runs: Runs) -> Outcome:
    """S5 is no better than S3 in energy and worse in SOC.

    Energy not lower by more than 0.02 kWh; SOC lower.
    """
    cooled, isolated = runs["S5"], runs["S3"]
    return Outcome(
        f"S5 {cooled.summary['energy_kwh']:.3f} kWh, {cooled.summary['final_soc_pct']:.2f} %; "
        f"S3 {isolated.summary['energy_kwh']:.3f} kWh, {isolated.summary['final_soc_pct']:.2f} %",
        [
            at_least(cooled.summary["energy_kwh"] - isolated.summary["energy_kwh"], -0.02, 0.05),
            below(cooled.summary["final_soc_pct"], isolated.summary["final_soc_pct"], 0.2),
        ],
    )


CASE1_CLAIMS: Final = (
    heated_battery_is_isolated,
    request_is_sustained,
    battery_warms_by_its_losses,
    cooling_keeps_the_battery_cold,
    cooled_battery_rises_at_high_speed,
    isolated_battery_rises_unaided,
    heating_the_battery_costs_comfort,
    battery_heat_makes_no_cabin_difference,
    battery_heat_warms_the_chiller,
    htc_quickly_reaches_its_temperature,
    cabin_reaches_its_target,
    cabin_suffers_without_the_ptc,
    battery_heat_warms_the_cabin_without_the_ptc,
    heating_the_battery_costs_energy,
    heating_the_battery_saves_charge,
    warmer_battery_holds_a_higher_voltage,
    soc_is_not_proportional_to_energy,
    battery_heat_is_not_worth_it,
)
