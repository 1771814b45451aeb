"""A large sweep once straight, once killed at random moments: rate, memory, and whether the values agree.

uv run --extra sweep scripts/kill_sweep.py [--runs 100000] [--kills 3] [--seed 0] OUT
"""

import argparse
import os
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from hp_gym.studies.sweep.swept import Sweep

MIB = 2**20


def resident_mib(process: int) -> float:
    """Memory of a process; 0 where the system does not tell."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1])
    except (OSError, IndexError):
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / MIB


def drive(out: Path, runs: int, kill_after_s: float | None) -> None:
    """Drives a sweep in a process of its own; tells time, memory and load."""
    ambient, capacity = 50, 20
    axes = (
        f"cell_capacity_ah=40:60/{capacity}",
        f"ambient_temperature_degc=-20:29/{ambient}",
        f"htc_set_point_degc=41:90/{max(runs // (ambient * capacity), 2)}",
    )
    command = ["hp-gym", "sweep", "jeffs2019/case1-1", "--out", str(out)]
    command += [word for axis in axes for word in ("--axis", axis)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    began_s = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    memory: list[float] = []
    while process.poll() is None:
        time.sleep(0.5)
        memory.append(resident_mib(process.pid))
        if kill_after_s is not None and time.monotonic() - began_s > kill_after_s:
            process.send_signal(signal.SIGKILL)
            process.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    wall_s = time.monotonic() - began_s
    parts = [f"{value:.0f}" for value in memory[:: max(len(memory) // 6, 1)]]
    print(
        f"{out.name}: {'killed' if process.returncode else 'complete'} after {wall_s:.0f} s, "
        f"{cpu_s:.0f} s of processors, load {os.getloadavg()[0]:.1f}, memory in MiB {', '.join(parts)}",
        flush=True,
    )


def main(out: Path, runs: int, kills: int, seed: int) -> int:
    """Drives both and compares them."""
    chance = random.Random(seed)
    drive(out / "straight", runs, None)
    for _ in range(kills):
        drive(out / "killed", runs, chance.uniform(15.0, 60.0))
    drive(out / "killed", runs, None)
    one, other = (Sweep(out / name).to_pandas() for name in ("straight", "killed"))
    same = list(one) == list(other) and all(
        np.array_equal(one[name].to_numpy(), other[name].to_numpy(), equal_nan=one[name].dtype.kind == "f")
        for name in one
    )
    print(f"{len(one):,} runs, the same values: {same}")
    return 0 if same else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, help="folder for both sweeps")
    parser.add_argument("--runs", type=int, default=100_000, help="number of runs")
    parser.add_argument("--kills", type=int, default=3, help="how often the second one is killed")
    parser.add_argument("--seed", type=int, default=0, help="seed of the moments")
    given = parser.parse_args()
    sys.exit(main(given.out, given.runs, given.kills, given.seed))
