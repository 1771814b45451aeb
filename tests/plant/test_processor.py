from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

from hp_gym import _core, processor

OLD = {"AVX2": False, "FMA3": False}
MARK = b"hp_gym built for AVX2 and FMA"


def file(folder: Path, content: bytes) -> Path:
    path = folder / "_core.so"
    path.write_bytes(b"\x7fELF" + content)
    return path


def test_a_build_for_newer_processors_is_refused_with_what_is_lacking(tmp_path: Path) -> None:
    with pytest.raises(ImportError, match=r"lacks AVX2, FMA3; build it here with RUSTFLAGS"):
        processor.check(file(tmp_path, MARK), OLD)
    with pytest.raises(ImportError, match=r"lacks FMA3;"):
        processor.check(file(tmp_path, MARK), {"AVX2": True, "FMA3": False})


def test_a_build_for_every_processor_runs_on_an_old_one(tmp_path: Path) -> None:
    processor.check(file(tmp_path, b"hp_gym built for every processor of its kind"), OLD)


def test_a_processor_that_has_what_is_needed_or_is_unknown_is_not_refused(tmp_path: Path) -> None:
    processor.check(file(tmp_path, MARK), {"AVX2": True, "FMA3": True})
    processor.check(file(tmp_path, MARK), {})


def test_the_extension_holds_the_mark_of_what_it_was_built_for() -> None:
    spec = importlib.util.find_spec("hp_gym._core")
    assert spec is not None
    assert spec.origin is not None
    content = Path(spec.origin).read_bytes()
    assert _core.__built_for__.encode() in content
    assert (MARK in content) == (_core.__built_for__.encode() == MARK)


@pytest.mark.skipif(
    _core.__built_for__.encode() != MARK, reason="this build runs on every processor of its kind"
)
def test_the_command_says_in_one_line_that_the_processor_is_too_old() -> None:
    code = (
        "import sys, numpy\n"
        "from numpy._core import _multiarray_umath\n"
        "_multiarray_umath.__cpu_features__['AVX2'] = False\n"
        "sys.argv[0] = '/somewhere/bin/hp-gym'\n"
        "import hp_gym.cli.app"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 1
    assert len(run.stderr.splitlines()) == 1, run.stderr
    assert run.stderr.startswith("hp-gym: hp_gym was built for x86-64-v3, but this processor lacks AVX2")
