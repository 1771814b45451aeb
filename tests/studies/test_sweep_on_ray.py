"""A sweep on a cluster gives the bits of threads, also where a node is lost, and mixes no builds."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("ray", reason="no Ray: uv run --group dev --extra ray pytest")

SCRIPT = Path(__file__).parents[2] / "scripts" / "sweep_on_ray.py"


def test_a_lost_node_changes_nothing() -> None:
    command = [sys.executable, str(SCRIPT), "--runs", "800"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 of 2 nodes left, the same values: True" in done.stdout
    assert "a worker of the cluster has hp_gym" in done.stdout
