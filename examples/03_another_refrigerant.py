"""Another refrigerant, by the name of a table that is built in or by the path of one's own."""

from pathlib import Path

import hp_gym

CAR = Path(__file__).with_suffix(".toml")
SCENARIO = "jeffs2019/case1-4"


def main() -> None:
    """Heats the cabin with five refrigerants."""
    runs = {
        "R134a, as in the paper": hp_gym.simulate(SCENARIO),
        "R1234ze(E), by path": hp_gym.simulate(SCENARIO, vehicle=CAR),
    }
    # With its name comes what the fluid's machines stand: highest and lowest pressure, discharge temperature.
    for name in ("R1234yf", "R290", "R152a"):
        runs[f"{name}, by name"] = hp_gym.simulate(SCENARIO, overrides={"vehicle.refrigerant": name})
    for name, run in runs.items():
        summary = run.summary
        print(
            f"{name}: COP {summary['heat_pump_cop']:.2f}, "
            f"{summary['highest_pressure_bar']:.1f} bar at most, {summary['limit_breaches']:.0f} breaches"
        )


if __name__ == "__main__":
    main()
