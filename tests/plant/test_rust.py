"""Runs the Rust tests, so that `uv run pytest` is the one test command.

Release profile: the integration tests evaluate the plant at many random points, which takes minutes in
a debug build and seconds here, and most of the dependencies are already built for the extension module.
"""

import shutil
import subprocess
from pathlib import Path

import pytest

pytestmark = pytest.mark.rust

ROOT = Path(__file__).resolve().parents[2]
TAIL_LINES = 80


def test_cargo_test_passes() -> None:
    cargo = shutil.which("cargo")
    if cargo is None:
        pytest.skip("no cargo on PATH: the Rust tests need a Rust toolchain (https://rustup.rs)")
    run = subprocess.run(
        [cargo, "test", "--release"],
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        errors="replace",
        check=False,
    )
    if run.returncode != 0:
        tail = "\n".join(run.stdout.splitlines()[-TAIL_LINES:])
        pytest.fail(f"`cargo test --release` exited with {run.returncode}:\n{tail}", pytrace=False)
