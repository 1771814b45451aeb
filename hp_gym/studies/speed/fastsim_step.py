"""FASTSim 3, where it is installed: an electric car with thermal models after a cold soak on the WLTC."""

from __future__ import annotations

from importlib.util import find_spec
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

import hp_gym

if TYPE_CHECKING:
    from collections.abc import Callable

VEHICLE: Final = "2020 Chevrolet Bolt EV thrml.yaml"
SCENARIO: Final = "jeffs2019/case1-4"
"""Its cycle is driven."""

SOAK_K: Final = 266.45
"""-6.7 degC, as in the cold test that this vehicle of FASTSim's was fitted to."""


def measurement() -> Callable[[], float] | None:
    """Returns a measurement of the mean time of a step [us]; none where FASTSim is not installed."""
    if find_spec("fastsim") is None:
        return None
    import fastsim

    speeds_m_s: list[float] = hp_gym.simulate(SCENARIO)["speed_m_s"].tolist()
    cycle = fastsim.Cycle.from_dict(
        {
            "time_seconds": [float(second) for second in range(len(speeds_m_s))],
            "speed_meters_per_second": speeds_m_s,
            "temp_amb_air_kelvin": [SOAK_K] * len(speeds_m_s),
        }
    )
    data: dict[str, Any] = fastsim.Vehicle.from_resource(VEHICLE).to_dict()
    battery = data["pt_type"]["BEV"]["res"]["thrml"]["RESLumpedThermal"]["state"]
    for state in (battery, data["cabin"]["LumpedCabin"]["state"]):
        state["temperature_kelvin"] = state["temp_prev_kelvin"] = SOAK_K
    vehicle = fastsim.Vehicle.from_dict(data)
    vehicle.set_save_interval(None)

    def measure() -> float:
        drive = fastsim.SimDrive(vehicle, cycle)
        start_s = perf_counter()
        drive.run_once()
        return 1e6 * (perf_counter() - start_s) / (len(speeds_m_s) - 1)

    return measure
