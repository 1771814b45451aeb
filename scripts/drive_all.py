"""Drives vehicles on every cycle, from -30 to 45 degC, with each built-in refrigerant: all must arrive within their limits.

uv run scripts/drive_all.py compact_ev crossover_ev direct_ev

Prints a line for each vehicle and refrigerant, and each trip that failed; ends with 1 if there is one. `--vehicle` takes names or
paths. Air is humid in the cold and dry in the heat (dew points up to 16 degC), the sun shines from 20 degC up.
"""

import argparse
import sys
from collections.abc import Sequence
from itertools import product
from typing import Final

import hp_gym
from hp_gym.studies.planned_runs import Planned, Totals, drive, processors

SCENARIO: Final = "jeffs2019/case1-1"
AMBIENTS_DEGC: Final = (-30.0, -20.0, -10.0, -5.0, 0.0, 10.0, 20.0, 35.0, 45.0)
CONTROLLERS: Final = ("hpcu", "hpcu-modern")
LEDGER_TOLERANCE: Final = 1e-9
LEDGERS: Final = ("worst_relative_residual", "worst_relative_water_residual")
MEMBERS: Final = ("motor", "transmission", "ambient", "thermal_battery", "ptc")


def climate(ambient_degc: float) -> list[str]:
    """Returns what a trip differs in at an ambient temperature: everything allowed, heating and cooling."""
    warm = ambient_degc > 16.0
    return [
        f"scenario.climate.ambient_temperature_degc={ambient_degc}",
        f"scenario.climate.relative_humidity={0.25 if warm else 0.9}",
        f"scenario.climate.solar_gain_w={500.0 if warm else 0.0}",
        "scenario.strategy.climate_control=auto",
        "scenario.strategy.battery=heat",
        *(f"scenario.strategy.{member}=true" for member in MEMBERS),
    ]


def planned(vehicle: str, refrigerant: str | None, cycles: Sequence[str]) -> list[Planned]:
    """Returns all trips of a vehicle with a refrigerant; None leaves it the vehicle's own or none."""
    fluid = [f"vehicle.refrigerant={refrigerant}"] if refrigerant else []
    return [
        (SCENARIO, controller, vehicle, [f"scenario.cycle={cycle}", *climate(ambient_degc), *fluid])
        for controller, cycle, ambient_degc in product(CONTROLLERS, cycles, AMBIENTS_DEGC)
    ]


def failures(runs: Sequence[Planned], totals: Totals) -> list[str]:
    """Returns a line for each trip that did not arrive, breached a limit or has an open ledger."""
    column = {name: totals.values[:, place] for place, name in enumerate(totals.names)}
    found = []
    for place, (_, controller, _, changes) in enumerate(runs):
        trip = f"{controller}, {changes[0]}, {changes[1]}"
        if totals.refusals[place] is not None:
            found.append(f"{trip}: refused: {totals.refusals[place]}")
            continue
        if totals.ends[place] != "arrived":
            found.append(f"{trip}: {totals.ends[place]}")
        if column["limit_breaches"][place] != 0.0:
            found.append(f"{trip}: {column['limit_breaches'][place]:.0f} breaches of limits")
        found.extend(
            f"{trip}: {ledger} {column[ledger][place]:.2e}"
            for ledger in LEDGERS
            if not column[ledger][place] <= LEDGER_TOLERANCE
        )
    return found


def drive_vehicle(vehicle: str, refrigerants: Sequence[str], cycles: Sequence[str]) -> tuple[int, int]:
    """Drives a vehicle with each refrigerant that its architecture has use for, and prints what came of it.

    Returns:
        The number of trips, and that of failures.
    """
    refrigerates = hp_gym._core.vehicle_layout(vehicle)["refrigerates"]
    trips = failed = 0
    for refrigerant in refrigerants if refrigerates else (None,):
        runs = planned(vehicle, refrigerant, cycles)
        totals = drive(runs, processors())
        wrong = failures(runs, totals)
        delay_s = totals.values[:, totals.names.index("delay_s")]
        print(
            f"{vehicle}, {refrigerant or 'no refrigerant'}: {len(runs)} trips, {len(wrong)} failures, "
            f"{int((delay_s > 0.0).sum())} late, by {delay_s.max():.0f} s at most",
            flush=True,
        )
        print(*(f"  {line}" for line in wrong), sep="\n", end="\n" if wrong else "")
        trips, failed = trips + len(runs), failed + len(wrong)
    return trips, failed


def main() -> None:
    """Reads the command line and drives.

    Raises:
        SystemExit: With 1 if a trip failed.
    """
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("vehicles", nargs="*", default=hp_gym.names("vehicle"), help="names or paths; all built-in ones")
    parser.add_argument("--refrigerants", nargs="+", default=hp_gym.names("refrigerant"))
    parser.add_argument("--cycles", nargs="+", default=hp_gym.names("drive cycle"))
    arguments = parser.parse_args()
    each = [drive_vehicle(name, arguments.refrigerants, arguments.cycles) for name in arguments.vehicles]
    trips, failed = (sum(numbers) for numbers in zip(*each, strict=True))
    print(f"{trips} trips, {failed} failures")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
