"""The hand-written stubs of the compiled core tell what is there."""

import subprocess
import sys


def test_stubs_match_the_compiled_core() -> None:
    command = [sys.executable, "-m", "mypy.stubtest", "hp_gym._core", "--concise"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
