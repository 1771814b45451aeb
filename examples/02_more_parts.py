"""A member, a heater and an exchanger more: rows of an architecture file, sections of the vehicle's."""

from pathlib import Path

import hp_gym

CAR = Path(__file__).with_suffix(".toml")
SCENARIO = "ours/commute-minus5"


def main() -> None:
    """Shows what follows from the rows, and drives the car with all of it in use."""
    experiment = hp_gym.Experiment(SCENARIO, vehicle=str(CAR))
    before = hp_gym.Experiment(SCENARIO)
    print("actuators:", *[name for name in experiment.actuator_names if name not in before.actuator_names])
    print("signals:", *[name for name in experiment.signal_names if name not in before.signal_names])

    def controller(run: hp_gym.Run):  # type: ignore[no-untyped-def]
        settings = {"electronics": "chiller", "battery_heater": "allowed", "cabin_condenser": "open"}
        return hp_gym.encode(run.experiment, settings, run.rule_based_command())

    run = hp_gym.simulate(SCENARIO, controller, vehicle=CAR)
    for column in (
        "electronics_chiller_heat_flow_w",
        "battery_heater_power_w",
        "cabin_condenser_heat_flow_w",
    ):
        print(f"{column}: {run[column].mean():.0f} W on average")


if __name__ == "__main__":
    main()
