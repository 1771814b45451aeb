"""A calibration on measured traces: what it finds, how sure it is, and what the data cannot tell.

The "rig" is the model itself with other values and noise, so that the truth is known.

python examples/11_calibrate.py [FOLDER]
"""

import sys
import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import hp_gym
from hp_gym.studies.calibration.fit import Options

FILE = Path(__file__).with_suffix(".toml")
TRUTH = {
    "vehicle.htc.circuit.heat_capacity_j_k": 20530.0,
    "vehicle.cabin.panel_conductance_w_k": 60.84,
    "vehicle.cabin.maximum_air_flow_kg_s": 0.0916,
    "vehicle.ptc.maximum_power_w": 5377.0,
    "vehicle.body.drag_area_m2": 0.8374,
}
EVERY_S = 10

# Rules switch: near the truth, too, a sample of the PTC may be on the wrong side of a switch, 5 kW off.
# Squares of that would decide the fit, and wide differences step over what is left.
OPTIONS = Options(loss="soft_l1", steps=(3e-2, 1e-2, 3e-3, 1e-3))


def measure(folder: Path) -> Path:
    """Writes what a rig would: a file a drive, and the calibration with the energy that it counted."""
    random = np.random.default_rng(2026)
    text = FILE.read_text(encoding="utf-8")
    for drive in tomllib.loads(text)["measurement"]:
        run = hp_gym.simulate(drive["scenario"], overrides=TRUTH | drive.get("overrides", {}))
        rows = slice(0, None, EVERY_S)
        columns = {"time_s": run["time_s"][rows]}
        for trace in drive["trace"]:
            values = run[trace["signal"]][rows]
            columns[trace["signal"]] = values + random.normal(0.0, trace["sigma"], len(values))
        table = np.stack(list(columns.values()), axis=1)
        head = ",".join(columns)
        np.savetxt(folder / drive["file"], table, "%.6g", ",", header=head, comments="")
        if "total" in drive:
            counted_kwh = run.summary["energy_kwh"] + random.normal(0.0, drive["total"][0]["sigma"])
            text = text.replace("value = 0.0", f"value = {counted_kwh:.3f}")
    path = folder / "calibration.toml"
    path.write_text(text, encoding="utf-8")
    return path


def main(folder: Path) -> None:
    """Measures, calibrates, and drives with what was found."""
    result = hp_gym.calibrate(measure(folder), out=folder / "result", options=OPTIONS)
    found = result.fit.by_name()
    knowledge = result.knowledge
    assert knowledge is not None
    deviations = dict(zip(knowledge.names, knowledge.deviations, strict=True))
    for key, true in TRUTH.items():
        off_pct = 100.0 * (found[key] / true - 1.0)
        print(f"{key}: {found[key]:g} +- {deviations[key]:.2g}, {off_pct:+.1f} % from the truth")
    for group in knowledge.open_groups:
        print("not told by the data:" if len(group) == 1 else "not told apart:", ", ".join(group))
    for one in result.judged:
        print(f"{one.role} {one.measurement}, {one.quantity}: {one.deviation:.2f} of its uncertainty")
    run = hp_gym.simulate("jeffs2019/case1-1", overrides=folder / "result" / "calibrated.toml")
    print(f"with the calibrated values: {run.summary['energy_kwh']:.2f} kWh")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]))
    else:
        with TemporaryDirectory() as temporary:
            main(Path(temporary))
