"""Ctrl-C: seen at once, told in one line, and what was done so far is kept."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
from safetensors.numpy import load_file
from typer.testing import CliRunner, Result

import hp_gym
from hp_gym import _core
from hp_gym.agents.training import configuration, train
from hp_gym.agents.training.watch import Watch
from hp_gym.cli.app import app
from hp_gym.cli.output import one_line_for_missing_packages
from hp_gym.studies.tuning import ambient_bands, search, tuned_rules
from hp_gym.studies.tuning.objective import Objective

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
from kill_results import training

SMALL = training(total=1024, checkpoint_interval=100_000, validation_interval=512)
SAC = [
    "algorithm=sac",
    "environment.continuous=true",
    "hyperparameters={buffer_size = 1000, learning_starts = 64, batch_size = 32, gamma = 0.9}",
]
CASE = "jeffs2019/case1-1"


def command(*words: object, set_up: str = "") -> subprocess.Popen[str]:
    code = f"import sys; sys.argv[0] = 'hp-gym'\n{set_up}\nfrom hp_gym.cli.app import main; main()"
    return subprocess.Popen(
        [sys.executable, "-c", code, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def stop(process: subprocess.Popen[str], is_there: Callable[[], bool]) -> tuple[str, float]:
    """Sends Ctrl-C once something is there; returns what was told and the seconds to the end."""
    deadline_s = time.monotonic() + 60.0
    while not is_there():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    began_s = time.monotonic()
    _, told = process.communicate(timeout=60)
    return told, time.monotonic() - began_s


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
@pytest.mark.parametrize("what", ["simulate", "first array"])
def test_ctrl_c_in_the_first_native_call_of_a_process_is_a_keyboard_interrupt(what: str) -> None:
    body = {
        "simulate": "hp_gym.simulate('jeffs2019/case1-4', substeps=1000)",
        "first array": "kill(); e.simulate()",
    }[what]
    code = (
        "import hp_gym, os, signal, threading\n"
        "e = hp_gym.Experiment('jeffs2019/case1-4')\n"
        "kill = lambda: os.kill(os.getpid(), signal.SIGINT)\n"
        "threading.Timer(0.2, kill).start()\n"
        f"try:\n    {body}\n    __import__('time').sleep(5)\n"
        "except KeyboardInterrupt:\n    print('interrupted')"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], check=False, capture_output=True, text=True, timeout=60
    )
    assert done.stdout == "interrupted\n", done.stderr


def test_a_long_run_asks_now_and_then_whether_to_go_on() -> None:
    experiment = hp_gym.Experiment(CASE, substeps=100)
    asked: list[None] = []
    values, _, end_reason = experiment.simulate(lambda: asked.append(None))
    alone, _, _ = experiment.simulate()
    np.testing.assert_array_equal(values, alone)
    assert end_reason == "arrived"
    assert len(asked) == (len(values) - 1 - 1) // 100

    def give_up() -> None:
        message = "enough"
        raise InterruptedError(message)

    with pytest.raises(InterruptedError, match="enough"):
        experiment.simulate(give_up)


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_totals_of_3000_trips_can_be_stopped_within_a_second() -> None:
    threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
    began_s = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        _core.totals([CASE] * 3000)
    assert time.monotonic() - began_s < 1.5


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_totals_after_a_fork_do_not_hang() -> None:
    code = (
        "import os, sys; from hp_gym import _core\n"
        f"before = _core.totals(['{CASE}'] * 2)\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        f"    os._exit(0 if _core.totals(['{CASE}'] * 2) == before else 1)\n"
        "sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False, timeout=30).returncode == 0


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_ctrl_c_while_libraries_load_gets_one_line() -> None:
    process = command("train", "ppo", set_up="print('loading', file=sys.stderr, flush=True)")
    assert process.stderr is not None
    assert process.stderr.readline() == "loading\n"
    # The first of this package's own lines is run in a moment; the libraries take longer.
    time.sleep(0.1)
    told, seconds = stop(process, lambda: True)
    assert process.returncode == 130, told
    assert told.startswith("hp-gym: stopped")
    assert len(told.splitlines()) == 1
    assert seconds < 3.0


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_a_training_that_is_stopped_writes_a_checkpoint_and_loses_at_most_a_rollout(tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(SMALL.replace("1024", "1_000_000"))
    out = tmp_path / "run"

    def is_under_way() -> bool:
        status = out / "status.json"
        return status.exists() and json.loads(status.read_text())["decisions"] >= 512

    process = command("train", tmp_path / "small.toml", "--out", out)
    told, seconds = stop(process, is_under_way)
    line = told.splitlines()[-1]
    status = json.loads((out / "status.json").read_text())
    kept = status["latest_checkpoint"]
    assert process.returncode == 130, told
    assert "Traceback" not in told
    # Mostly a hundredth; a disk that others keep busy may take its time.
    assert seconds < 20.0
    assert status["state"] == "interrupted"
    assert 0 <= status["decisions"] - kept <= 32 * 8
    assert [path.name for path in (out / "checkpoints").iterdir()] == [f"{kept:012d}.pt"]
    assert line == (
        f"hp-gym: stopped; its checkpoint is at {kept:,} decisions; go on with: hp-gym train --resume {out}"
    )


def _stop_at(decision: int) -> Callable[[Any], bool]:
    """Ctrl-C at a decision, as the handler of the training sees it."""
    asked: list[int] = []

    def on_step(watch: Any) -> bool:
        if watch.model.num_timesteps >= decision and not asked:
            asked.append(watch.model.num_timesteps)
            watch.stop()
        return True

    return on_step


@pytest.mark.parametrize("given", [pytest.param([], id="ppo"), pytest.param(SAC, id="sac")])
@pytest.mark.parametrize("at", [8, 700])
def test_a_training_that_was_stopped_ends_as_one_that_was_not(
    given: list[str], at: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "small.toml").write_text(SMALL)
    training = configuration.load(str(tmp_path / "small.toml"), given)
    train.start(training, "small", 1, tmp_path / "whole")
    with monkeypatch.context() as patch:
        patch.setattr(Watch, "_on_step", _stop_at(at))
        with pytest.raises(KeyboardInterrupt):
            train.start(training, "small", 1, tmp_path / "cut")
    made = [int(path.stem) for path in (tmp_path / "cut" / "checkpoints").iterdir()]
    assert len(made) == 1
    assert 0 <= at + 8 - made[0] <= 32 * 8 + 8
    train.resume(tmp_path / "cut")
    whole, cut = (load_file(tmp_path / name / "final.safetensors") for name in ("whole", "cut"))
    for name, value in whole.items():
        np.testing.assert_array_equal(value, cut[name])


def invoke(*words: object) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words])


def test_a_training_that_is_stopped_before_it_began_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    (tmp_path / "small.toml").write_text(SMALL)
    out = tmp_path / "run"
    with monkeypatch.context() as patch:
        patch.setattr(train, "_first_notes", interrupted)
        result = invoke("train", tmp_path / "small.toml", "--out", out)
    assert (result.exit_code, result.stderr) == (
        130,
        "hp-gym: stopped; no run was begun, and nothing was written\n",
    )
    assert [path.name for path in tmp_path.iterdir()] == ["small.toml"]
    with monkeypatch.context() as patch:
        patch.setattr(train, "_learn", interrupted)
        result = invoke("train", tmp_path / "small.toml", "--out", out)
    assert result.exit_code == 130
    assert result.stderr == (
        f"hp-gym: stopped; there is no checkpoint yet; begin anew with: hp-gym train --resume {out}\n"
    )


def test_a_search_that_was_stopped_goes_on_and_ends_as_one_that_was_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tuned_rules, "BANDS", ambient_bands.BANDS[:1])
    monkeypatch.setattr(
        search, "modes", lambda: [search.PAPER, search.PAPER.changed({"strategy.ptc": False})]
    )
    driven: list[object] = []
    original = Objective._drive

    def drive(self: Objective, choices: Any) -> Any:
        driven.append(choices)
        if len(driven) == 9:
            raise KeyboardInterrupt
        return original(self, choices)

    words = ("tune", "hpcu-tuned", "--trials", 12, "--trips", 1)
    assert invoke(*words, "--out", tmp_path / "whole").exit_code == 0
    (tmp_path / "cut").mkdir()
    (tmp_path / "cut" / "hpcu-tuned.toml").write_text("earlier")
    monkeypatch.setattr(Objective, "_drive", drive)
    result = invoke(*words, "--out", tmp_path / "cut")
    assert result.exit_code == 130
    assert result.stderr.splitlines() == [
        "hp-gym: stopped; trials so far are kept, and the same command goes on with them"
    ]
    assert (tmp_path / "cut" / "hpcu-tuned.toml").read_text() == "earlier"
    first = len(driven)
    result = invoke(*words, "--out", tmp_path / "cut")
    assert result.exit_code == 0, result.stderr
    # The paper's choices are driven again, to see whether the plant is the same; the others only once.
    assert len(driven) < 2 * first
    for name in ("hpcu-best-mode.toml", "hpcu-tuned.toml"):
        assert (tmp_path / "cut" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cut", "whole"]


def test_too_little_memory_gets_one_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(SMALL)
    for change in ("environments.number=1000000000", "hyperparameters.n_steps=4000000000000"):
        result = invoke("train", tmp_path / "small.toml", "--set", change, "--out", tmp_path / "run")
        assert result.exit_code == 2, result.output
        assert "MiB of memory" in result.stderr
        assert len(result.stderr.splitlines()) == 1
    with pytest.raises(hp_gym.ConfigurationError, match="num_envs is 1,000,000,000, which needs about"):
        hp_gym_vector(1_000_000_000)

    def none_left(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(train, "start", none_left)
    result = invoke("train", tmp_path / "small.toml", "--out", tmp_path / "run")
    assert (result.exit_code, result.stderr) == (
        2,
        "hp-gym: memory does not suffice for what was asked for\n",
    )


def hp_gym_vector(number: int, threads: int | None = None) -> Any:
    from hp_gym.envs.vector_env import EVHeatPumpVectorEnv

    return EVHeatPumpVectorEnv(number, threads=threads)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="counts threads by /proc")
def test_2000_threads_for_8_environments_are_not_started() -> None:
    before = len(list(Path("/proc/self/task").iterdir()))
    envs = hp_gym_vector(8, threads=2000)
    envs.reset(seed=0)
    envs.step(np.zeros((8, 11), dtype=np.int64))
    assert len(list(Path("/proc/self/task").iterdir())) - before <= 8


def test_a_trip_of_0_km_has_null_for_what_does_not_exist(tmp_path: Path) -> None:
    (tmp_path / "standing.csv").write_text("# standing\ntime_s,speed_m_s\n0,0\n60,0\n")
    (tmp_path / "standing.toml").write_text(
        f'base = "{CASE}"\ndescription = "standing"\ncycle = {json.dumps(str(tmp_path / "standing.csv"))}\n'
    )
    result = invoke("run", tmp_path / "standing.toml", "--json")
    assert result.exit_code == 0, result.stderr
    told = json.loads(result.stdout, parse_constant=pytest.fail)
    assert told["summary"]["distance_km"] == 0.0
    assert told["summary"]["energy_kwh_per_100_km"] is None
    shutil.rmtree(tmp_path)


def test_ctrl_c_that_an_extension_reports_as_a_failed_import_is_ctrl_c() -> None:
    """As pybind11 does with a signal that comes while it loads a module."""

    def loads() -> None:
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as error:
            message = "initialization failed"
            raise ImportError(message) from error

    def lacks() -> None:
        message = "No module named 'absent'"
        raise ImportError(message, name="absent")

    with pytest.raises(KeyboardInterrupt):
        one_line_for_missing_packages(loads)()
    with pytest.raises(typer.Exit):
        one_line_for_missing_packages(lacks)()
