"""A first run: its totals, a signal over time, and what changes in the cold.

In a notebook, `run` alone in a cell shows totals and picture.
"""

import hp_gym


def main() -> None:
    """Drives the paper's first case as it is, and at -7 degC."""
    run = hp_gym.simulate("jeffs2019/case1-1")
    cold = hp_gym.simulate("jeffs2019/case1-1", overrides={"scenario.climate.ambient_temperature_degc": -7.0})
    for name, one in (("as in the paper", run), ("at -7 degC", cold)):
        print(f"{name}: {one.summary['energy_kwh']:.2f} kWh, {one.end_reason} after {len(one) - 1} s")
    warm = run["cabin_temperature_degc"] > 20.0
    print(f"cabin above 20 degC after {int(run['time_s'][warm][0])} s" if warm.any() else "cabin stays cold")
    print(f"{len(run.columns)} signals, for example battery_power_w in {run.units['battery_power_w']}")


if __name__ == "__main__":
    main()
