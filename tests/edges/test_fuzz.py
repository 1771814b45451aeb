"""The scripts that fuzz files, states, policies and checkpoints, small; all of it is `--count 10000`."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"


@pytest.mark.training
@pytest.mark.skipif(sys.platform == "win32", reason="forks")
@pytest.mark.parametrize(("script", "count"), [("fuzz_files.py", 150), ("fuzz_damage.py", 80)])
def test_what_is_damaged_is_refused_in_one_line(script: str, count: int) -> None:
    words = [sys.executable, SCRIPTS / script, "--count", str(count), "--seed", "11"]
    done = subprocess.run(words, check=False, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("\nwrong: 0\n")
