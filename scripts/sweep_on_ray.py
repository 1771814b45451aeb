"""The same sweep on threads and on a local Ray cluster of two nodes, one of which is lost on the way.

uv run --all-extras scripts/sweep_on_ray.py [--runs 3200]
"""

import argparse
import sys
import time
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import numpy as np
import pandas as pd
import ray
from ray.cluster_utils import Cluster

import hp_gym
from hp_gym.studies.sweep import ray_runs
from hp_gym.studies.sweep.sweep_plan import SweepError

SCENARIO = "jeffs2019/case1-4"
LOST_AFTER_CHUNKS = 3


def same(one: pd.DataFrame, other: pd.DataFrame) -> bool:
    """Whether two tables have the same bits."""
    return list(one) == list(other) and all(
        np.array_equal(one[name].to_numpy(), other[name].to_numpy(), equal_nan=one[name].dtype.kind == "f")
        for name in one
    )


def nodes_left() -> int:
    """Number of nodes, once the cluster has seen that one is lost, or after a minute."""
    deadline_s = time.monotonic() + 60.0
    while True:
        nodes: list[dict[str, Any]] = ray.nodes()  # type: ignore[no-untyped-call, unused-ignore]
        alive = sum(bool(node["Alive"]) for node in nodes)
        if alive < 2 or time.monotonic() > deadline_s:
            return alive
        time.sleep(0.5)


def main(runs: int) -> int:
    """Drives both, and a third time with workers of another build."""
    axes = {
        "htc_set_point_degc": np.linspace(45.0, 85.0, 10),
        "vehicle.body.mass_kg": np.linspace(1500.0, 2500.0, runs // 10),
    }
    on_threads = hp_gym.sweep(axes, SCENARIO).to_pandas()
    cluster: Any = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    node = cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    cluster.wait_for_nodes()
    chunks = 0

    def watch(_: object) -> None:
        nonlocal chunks
        chunks += 1
        if chunks == LOST_AFTER_CHUNKS:
            cluster.remove_node(node, allow_graceful=False)

    with TemporaryDirectory() as folder:
        out = f"{folder}/sweep"
        swept = hp_gym.sweep(axes, SCENARIO, out=out, on="ray", chunk_runs=max(runs // 40, 1), watch=watch)
        alive = nodes_left()
        equal = same(on_threads, swept.to_pandas())
        print(f"{len(on_threads)} runs, {chunks} chunks, {alive} of 2 nodes left, the same values: {equal}")
        refused = False
        with patch.object(ray_runs, "build", lambda: "0.0.1+other"):
            try:
                hp_gym.sweep(axes, SCENARIO, out=f"{folder}/other", on="ray")
            except SweepError as error:
                print(error)
                refused = "results of two builds are not mixed" in str(error)
    ray.shutdown()
    cluster.shutdown()
    return 0 if equal and alive == 1 and refused else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3200, help="number of runs, at least 40")
    sys.exit(main(parser.parse_args().runs))
