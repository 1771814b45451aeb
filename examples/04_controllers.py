"""Controllers: rules with other numbers as a file, other rules as a Python callable.

Rules in Rust, as fast as the built-in ones: `examples/08_rows_in_rust.py`.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import hp_gym

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

FILE = Path(__file__).with_name("04_controller.toml")
SCENARIO = "jeffs2019/case1-1"


def cautious(run: hp_gym.Run) -> "NDArray[np.float32]":
    """The rules of the scenario, with the PTC forbidden as soon as the cabin is at 15 degC."""
    command = run.rule_based_command()
    if hp_gym.observe(run)["cabin_temperature_degc"] < 15.0:
        return command
    return hp_gym.encode(run.experiment, {"ptc": "off"}, command)


def main() -> None:
    """Drives one trip by each."""
    for controller in ("hpcu", "thermostat", FILE, cautious):
        run = hp_gym.simulate(SCENARIO, controller)
        name = Path(run.controller).name
        print(f"{name}: {run.summary['energy_kwh']:.2f} kWh, {run.summary['discomfort_k']:.1f} K off target")


if __name__ == "__main__":
    main()
