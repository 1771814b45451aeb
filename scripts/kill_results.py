"""Kills writers of results at every step and commands at random moments, and looks at what is left.

    uv run scripts/kill_results.py                    # faults at every step of a transaction, seconds
    uv run scripts/kill_results.py --kills 50 --interrupts 20

After each kill a folder must hold the old results or the new ones, whole, and after the next run there must
be no debris. After each Ctrl-C a command must end with one line and exit code 130. Exits with 1 otherwise.
"""

from __future__ import annotations

import argparse
import errno
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from hp_gym import transactions
from hp_gym.files import OURS, atomic_write

if TYPE_CHECKING:
    from collections.abc import Callable

KILLED: Final = 99
STEPS: Final = ("mkdir", "rename", "replace", "link", "unlink", "rmdir", "fsync", "open")
"""Calls of the system before and after which a process is killed."""

GRID: Final = """
description = "kills"
scenario = "jeffs2019/case1-1"
cycles = [{ name = "nedc" }]
ambient_temperatures_degc = [-10.0, 30.0]
variants = [{ name = "dark", occupants = 1, state_of_charge_pct = 90.0 }]
bands = [
    { name = "cold", low_degc = -30.0, headline = true },
    { name = "warm", low_degc = 10.0, headline = false },
]
"""
TRAINING: Final = """
algorithm = "ppo"
total_decisions = {total_decisions}
checkpoint_interval_decisions = {checkpoint_interval_decisions}
torch_threads = 1
environments = {{ number = 8, threads = 1 }}
environment = {{ control_interval_s = 60 }}
learning_rate = {{ start = 1e-2 }}
network = {{ hidden_sizes = [8, 8] }}
validation = {{ interval_decisions = {validation_interval_decisions}, trips = 2 }}
hyperparameters = {{ n_steps = 32, batch_size = 128, n_epochs = 2, gamma = 0.9 }}
"""

Contents = dict[str, str]


@dataclass
class Tally:
    """What was tried and what went wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    wrong: list[str] = field(default_factory=list)

    def require(self, holds: bool, what: str) -> None:
        """Notes what does not hold."""
        if not holds:
            self.wrong.append(what)


def training(total: int = 4096, checkpoint_interval: int = 512, validation_interval: int = 1024) -> str:
    """Returns the configuration of a training that takes a moment; all in decisions."""
    return TRAINING.format(
        total_decisions=total,
        checkpoint_interval_decisions=checkpoint_interval,
        validation_interval_decisions=validation_interval,
    )


def contents(folder: Path) -> Contents:
    """Files of a folder by name, with their text; empty if it is not there."""
    found = folder.rglob("*") if folder.exists() else ()
    return {str(p.relative_to(folder)): p.read_text(encoding="utf-8") for p in found if p.is_file()}


def kill_at(number: int, after: bool) -> None:
    """Lets this process end at the given call of the system, before or after it is made."""
    made = 0

    def wrap(original: Callable[..., Any]) -> Callable[..., Any]:
        def call(*args: Any, **kwargs: Any) -> Any:
            nonlocal made
            made += 1
            if made == number and not after:
                os._exit(KILLED)
            this = made
            try:
                return original(*args, **kwargs)
            finally:
                # A step that fails, for example as a folder is there already, is one as well.
                if this == number:
                    os._exit(KILLED)

        return call

    for name in STEPS:
        setattr(os, name, wrap(getattr(os, name)))
    transactions._exchange = wrap(transactions._exchange)


def killed_at_each_step(
    write: Callable[[], None], look: Callable[[str], None], prepare: Callable[[], None]
) -> int:
    """Runs a writer once for each of its steps, killed there; looks at what is left; returns the kills."""
    kills = 0
    for number in range(1, 1000):
        for after in (False, True):
            prepare()
            child = os.fork()
            if child == 0:
                try:
                    kill_at(number, after)
                    write()
                    os._exit(0)
                except BaseException:  # noqa: BLE001, a child must not go on as its parent would
                    traceback.print_exc()
                    os._exit(1)
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
            if code == 0:
                return kills
            if code != KILLED:
                message = "a writer failed by itself"
                raise RuntimeError(message)
            kills += 1
            look(f"step {number}, {'after' if after else 'before'}")
    message = "a writer has more than 1000 steps"
    raise RuntimeError(message)


def folder_faults(place: Path, tally: Tally, *, swap: bool) -> None:
    """Faults in the replacement of a folder of results, with or without a swap in one call of the system."""
    folder = place / "results"
    old = {"a.txt": "old a", "sub/b.txt": "old b", "notes.txt": "mine"}
    new = {"a.txt": "new a", "sub/c.txt": "new c", "notes.txt": "mine"}

    def prepare() -> None:
        shutil.rmtree(place, ignore_errors=True)
        for name, text in old.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")

    def write() -> None:
        if not swap:
            transactions._exchange = no_swap
        with transactions.new_contents(folder) as staged:
            (staged / "a.txt").write_text("new a", encoding="utf-8")
            (staged / "sub").mkdir()
            (staged / "sub" / "c.txt").write_text("new c", encoding="utf-8")

    def look(where: str) -> None:
        # Without a swap the folder may be missing between two renames; the next run brings it back.
        left = contents(folder)
        tally.require(left in ([old, new] if swap else [old, new, {}]), f"{where}: holds {left}")
        try:
            with transactions.new_contents(folder):
                found = contents(folder)
                tally.require(found in [old, new], f"{where}: the next run finds {found}")
                raise InterruptedError
        except InterruptedError:
            pass
        tally.require(contents(folder) == found, f"{where}: a run that fails changes the folder")
        original = transactions._exchange
        write()
        transactions._exchange = original
        tally.require(contents(folder) == new, f"{where}: the next run gives {contents(folder)}")
        debris = sorted(path.name for path in place.iterdir() if path != folder)
        tally.require(not debris, f"{where}: debris {debris}")

    name = "folder" if swap else "folder without swap"
    tally.counts[name] += killed_at_each_step(write, look, prepare)


def no_swap(one: Path, other: Path) -> None:
    """A system that cannot swap two names."""
    del one, other
    raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))


def file_faults(place: Path, tally: Tally) -> None:
    """Faults in the replacement of one file."""
    file = place / "policy.txt"

    def prepare() -> None:
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir(parents=True)
        file.write_text("old", encoding="utf-8")

    def write() -> None:
        with atomic_write(file) as temporary:
            temporary.write_text("new", encoding="utf-8")

    def look(where: str) -> None:
        tally.require(file.read_text(encoding="utf-8") in {"old", "new"}, f"{where}: the file is damaged")
        write()
        debris = sorted(path.name for path in place.iterdir() if path != file)
        tally.require(not debris, f"{where}: debris {debris}")

    tally.counts["file"] += killed_at_each_step(write, look, prepare)


def commands(place: Path) -> dict[str, list[str]]:
    """Commands that write results, each with a folder of its own."""
    (place / "grid.toml").write_text(GRID, encoding="utf-8")
    (place / "training.toml").write_text(training(), encoding="utf-8")
    return {
        "benchmark": [
            "benchmark",
            "off",
            "--grid",
            str(place / "grid.toml"),
            "--out",
            str(place / "benchmark"),
        ],
        "tune": ["tune", "--trials", "10", "--trips", "1", "--out", str(place / "tune")],
        "train": ["train", str(place / "training.toml"), "--out", str(place / "train")],
    }


def begin(words: list[str]) -> subprocess.Popen[str]:
    """Starts a command."""
    code = (
        "import sys; print(file=sys.stderr, flush=True); sys.argv[0] = 'hp-gym'\n"
        "from hp_gym.cli.app import main; main()"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, *words], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    # Before that it is Python that starts, not the command.
    assert process.stderr is not None
    process.stderr.readline()
    return process


def complete(words: list[str]) -> float:
    """Runs a command to its end and returns the seconds that it took."""
    began_s = time.perf_counter()
    process = begin(words)
    _, told = process.communicate()
    if process.returncode != 0:
        message = f"{' '.join(words)}: {told}"
        raise RuntimeError(message)
    return time.perf_counter() - began_s


def names(folder: Path) -> set[str]:
    """Files of a folder that holds results."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def random_kills(place: Path, kills: int, tally: Tally, chance: random.Random) -> None:
    """Kills commands at random moments; the next run must find whole results and leave no debris."""
    for name, words in commands(place).items():
        folder = place / name
        duration_s = complete(words)
        whole = names(folder)
        for number in range(kills):
            if name == "train":
                shutil.rmtree(folder)
            process = begin(words)
            time.sleep(chance.uniform(0.0, duration_s))
            process.kill()
            process.communicate()
            where = f"{name}, kill {number}"
            if name == "train":
                resumed = ["train", "--resume", str(folder)] if (folder / "config.toml").exists() else words
                finished = (folder / "final.zip").exists() and '"finished"' in (
                    folder / "status.json"
                ).read_text()
                if not finished:
                    complete(resumed)
                hidden = {file for file in names(folder) if Path(file).name.startswith(".")}
                tally.require(not hidden, f"{where}: debris {hidden}")
                tally.require((folder / "final.safetensors").exists(), f"{where}: no policy")
            else:
                tally.require(names(folder) == whole, f"{where}: holds {names(folder) ^ whole}")
            tally.counts[f"{name} kills"] += 1
        if name != "train":
            complete(words)
            tally.require(names(folder) == whole, f"{name}: holds {names(folder) ^ whole}")
        debris = sorted(path.name for path in place.iterdir() if path.name.startswith(f".{name}."))
        tally.require(not debris, f"{name}: debris {debris}")


def random_interrupts(
    place: Path, number: int, tally: Tally, chance: random.Random, chosen: list[str] | None
) -> None:
    """Sends Ctrl-C at random moments and prints how long commands take to end."""
    every = commands(place) | {
        "run": ["run", "jeffs2019/case1-4", "--out", str(place / "run.csv")],
        "reproduce": ["reproduce", "--substeps", "100", "--out", str(place / "reproduce")],
        "calibrate": ["calibrate", "--max-evaluations", "200", "--out", str(place / "calibrate")],
        "export": [
            "export",
            "agents/reference_policies/ppo-seed0.safetensors",
            "--out",
            str(place / "policy.onnx"),
        ],
    }
    for name, words in every.items():
        if chosen and name not in chosen:
            continue
        shutil.rmtree(place / "train", ignore_errors=True)
        duration_s = complete(words)
        waits_s, stopped = [], 0
        for attempt in range(number):
            shutil.rmtree(place / "train", ignore_errors=True)
            # A search would go on with what it has, and end too soon.
            shutil.rmtree(place / f".tune.{OURS}trials", ignore_errors=True)
            process = begin(words)
            # Until the first lines of the package are run Ctrl-C is Python's.
            time.sleep(chance.uniform(0.1, duration_s))
            process.send_signal(signal.SIGINT)
            began_s = time.perf_counter()
            _, told = process.communicate()
            waits_s.append(time.perf_counter() - began_s)
            if process.returncode == 0:
                continue
            stopped += 1
            lines = told.splitlines()
            mine = [line for line in lines if line.startswith("hp-gym: stopped")]
            where = f"{name}, interrupt {attempt}"
            tally.require(
                process.returncode == 130, f"{where}: exit code {process.returncode}: {told[-300:]}"
            )
            tally.require(len(mine) == 1 and "Traceback" not in told, f"{where}: {told[-300:]}")
        tally.counts[f"{name} interrupts"] += number
        slowest_s = max(waits_s, default=0.0)
        print(f"{name}: {stopped} of {number} stopped, slowest {slowest_s:.2f} s; a run: {duration_s:.1f} s")
        tally.require(slowest_s < 3.0, f"{name}: took {slowest_s:.1f} s to stop")


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=0, help="random kills of each command")
    parser.add_argument("--interrupts", type=int, default=0, help="random interrupts of each command")
    parser.add_argument("--commands", nargs="*", help="commands to interrupt; all by default")
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    tally, chance = Tally(), random.Random(chosen.seed)
    with tempfile.TemporaryDirectory() as name:
        place = Path(name).resolve()
        file_faults(place / "file", tally)
        folder_faults(place / "folder", tally, swap=True)
        folder_faults(place / "folder", tally, swap=False)
        if chosen.kills:
            (place / "kills").mkdir()
            random_kills(place / "kills", chosen.kills, tally, chance)
        if chosen.interrupts:
            (place / "interrupts").mkdir()
            random_interrupts(place / "interrupts", chosen.interrupts, tally, chance, chosen.commands)
    for what, number in tally.counts.items():
        print(f"{what}: {number}")
    for what in tally.wrong:
        print(f"WRONG: {what}")
    print(f"wrong: {len(tally.wrong)}")
    sys.exit(1 if tally.wrong else 0)


if __name__ == "__main__":
    main()
