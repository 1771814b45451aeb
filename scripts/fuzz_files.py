"""Mutates files of all kinds and reads them: no panic, no abort, no traceback, in bounded time and memory.

    uv run scripts/fuzz_files.py                       # 300 files, for a test
    uv run scripts/fuzz_files.py --count 10000

Named pipes, devices, links in a circle, `inf`, `1e300`, a depth of a million and 100 MB are among them. Each
file must be accepted or refused in one line of at most 500 characters, within 5 s and 500 MB beyond what the
loaded package takes. Exits with 1 otherwise.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import resource
import select
import signal
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from fuzz_damage import a_checkpoint

from hp_gym import _core
from hp_gym.agents import policies
from hp_gym.agents.policies import onnx_file, reference
from hp_gym.agents.training import checkpoint, configuration
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.messages import LONGEST_MESSAGE, OneLineError
from hp_gym.studies.benchmark import grid
from hp_gym.studies.calibration import problem

if TYPE_CHECKING:
    from collections.abc import Callable

LONGEST_S: Final = 5.0
LARGEST_MIB: Final = 500
AT_ONCE: Final = 50
"""Files that one process reads; one that dies takes no others with it."""

CASE: Final = "jeffs2019/case1-1"
STRANGE: Final = (
    *("inf", "-inf", "nan", "1e300", "-1e300", "1e-300", "1e10", "-1", "0", "0.0", "9" * 400),
    *('"x"', "true", "[]", "{}", "[[]]", "[1, 2]", "1979-05-27", '"' + "x" * 5000 + '"', '""', '"\\u0000"'),
)
PATHS: Final = ('"pipe.{0}"', '"zero.{0}"', '"circle.{0}"', '"folder.{0}"', '"none.{0}"', '"self.{0}"')


def changed_text(text: str, ending: str, chance: random.Random) -> str:
    """Returns a text with something in it replaced, left out, or put in."""
    lines = text.splitlines()
    for _ in range(chance.randint(1, 3)):
        place = chance.randrange(len(lines))
        line = lines[place]
        separator = "=" if ending == "toml" else ","
        match chance.randrange(9):
            case 0:
                del lines[place]
            case 1:
                lines.insert(place, lines[chance.randrange(len(lines))])
            case 2 | 3 | 4:
                key, found, _ = line.partition(separator)
                if found:
                    lines[place] = f"{key}{found}{chance.choice(STRANGE)}"
            case 5:
                key, found, _ = line.partition(separator)
                if found:
                    lines[place] = (
                        f"{key}{found}{chance.choice(PATHS).format(chance.choice(('toml', 'csv')))}"
                    )
            case 6:
                at = chance.randrange(len(line) + 1)
                lines[place] = line[:at] + chance.choice("[]{}\"'=.,#\\\x00\t9e-\ufeff") + line[at:]
            case 7:
                lines.insert(place, f"base = {chance.choice(PATHS).format(ending)}")
            case _:
                del lines[place : place + chance.randint(1, 20)]
        if not lines:
            lines = [""]
    return "\n".join(lines)


def deep(chance: random.Random) -> bytes:
    """Returns a text that goes down to a depth of up to a million."""
    depth = chance.choice((33, 1000, 100_000, 1_000_000))
    kinds = (
        "x = " + "[" * depth,
        "a" + ".a" * depth + " = 1",
        "[a" + ".a" * depth + "]",
        "x = " + "{a = " * depth,
    )
    return chance.choice(kinds).encode()


def mutate(seed: bytes, path: Path, chance: random.Random) -> None:
    """Writes, at a path, something that comes from a good file."""
    ending = path.suffix[1:]
    as_text = ending in {"toml", "csv"}
    what = chance.randrange(40)
    if what == 0:
        os.mkfifo(path)
    elif what == 1:
        path.symlink_to(chance.choice(("/dev/zero", "/dev/null", "/dev/random", "/proc/self/mem")))
    elif what == 2:
        path.symlink_to(path)
    elif what == 3:
        path.mkdir()
    elif what == 4:
        with path.open("wb") as file:
            file.write(seed)
            file.truncate(100_000_000)
    elif what == 5:
        path.write_bytes(deep(chance))
    elif what == 6:
        path.write_bytes(b"\xef\xbb\xbf" + seed)
    elif what == 7:
        path.write_bytes(seed[: chance.randrange(len(seed) + 1)])
    elif what < 14 or not as_text:
        data = bytearray(seed)
        for _ in range(chance.randint(1, 8)):
            data[chance.randrange(len(data))] = chance.randrange(256)
        path.write_bytes(data)
    else:
        path.write_bytes(changed_text(seed.decode(), ending, chance).encode("utf-8", "surrogatepass"))


def drive(experiment: _core.Experiment) -> None:
    """Drives a minute."""
    run = experiment.start()
    for _ in range(min(60, experiment.duration_s)):
        if run.step(run.rule_based_command()) is not None:
            return


def _beside(path: Path, text: str) -> str:
    other = path.with_name("asks.toml")
    other.write_text(text)
    return str(other)


def read_scenario(path: Path) -> None:
    """Reads a scenario, and drives it."""
    drive(_core.Experiment(str(path)))


def read_cycle(path: Path) -> None:
    """Reads a drive cycle that a scenario names."""
    drive(_core.Experiment(_beside(path, f'base = "{CASE}"\ncycle = "{path.name}"\n')))


def read_vehicle(path: Path) -> None:
    """Reads a vehicle, and drives it."""
    drive(_core.Experiment(CASE, vehicle=str(path)))


def read_architecture(path: Path) -> None:
    """Reads an architecture, alone and for a vehicle."""
    _core.architecture_layout(str(path))
    car = _beside(path, f'base = "three-loops"\narchitecture = "{path.name}"\n')
    drive(_core.Experiment(CASE, vehicle=car))


def read_refrigerant(path: Path) -> None:
    """Reads the table of a refrigerant that a vehicle names."""
    drive(_core.Experiment(CASE, vehicle=_beside(path, f'base = "jeffs2019"\nrefrigerant = "{path.name}"\n')))


def read_controller(path: Path) -> None:
    """Reads a controller, and lets it drive."""
    drive(_core.Experiment(CASE, str(path)))


def read_episodes(path: Path) -> None:
    """Reads a distribution of trips, and draws some."""
    env = EVHeatPumpEnv(distribution=str(path))
    for seed in range(3):
        env.reset(seed=seed)
        env.step(env.action_space.sample())


def read_reward(path: Path) -> None:
    """Reads a reward, and lets it judge."""
    env = EVHeatPumpEnv(scenario=CASE, reward=str(path))
    env.reset(seed=0)
    env.step(env.action_space.sample())


Reader = tuple[str, bytes, "Callable[[Path], object]"]


def readers(checkpoint_bytes: bytes) -> list[Reader]:
    """Returns ending, a good file and the reader of every kind."""

    def built_in(kind: str, name: str) -> bytes:
        return _core.config_text(kind, name).encode()

    policy = next(iter(reference.policies().values()))
    return [
        ("toml", built_in("scenario", CASE), read_scenario),
        ("toml", built_in("vehicle", "jeffs2019"), read_vehicle),
        ("toml", built_in("architecture", "three-loops"), read_architecture),
        ("toml", built_in("controller", "hpcu"), read_controller),
        ("toml", built_in("distribution of episodes", "train-v2"), read_episodes),
        ("toml", built_in("reward", "balanced"), read_reward),
        ("csv", built_in("drive cycle", "nedc"), read_cycle),
        ("csv", b"time_s,speed_km_h\n0,0\n10,36.5\n20,20\n30,0\n", read_cycle),
        ("csv", built_in("refrigerant", "r134a"), read_refrigerant),
        ("toml", built_in("training configuration", "ppo"), lambda path: configuration.load(str(path))),
        ("toml", built_in("benchmark", "heldout-v1"), lambda path: grid.load(str(path))),
        ("toml", built_in("calibration", "jeffs2019"), lambda path: problem.load(str(path))),
        ("safetensors", _core.reference_policy(_core.reference_policy_names()[0]), policies.load),
        ("onnx", onnx_file.to_model(policy).SerializeToString(), policies.load),
        ("pt", checkpoint_bytes, checkpoint.read),
    ]


def outcome(read: Callable[[Path], object], path: Path) -> str:
    """Returns how reading went: `accepted`, `refused`, or what must not be."""
    try:
        read(path)
    except (_core.ConfigurationError, OneLineError, OSError) as error:
        message = str(error)
        if len(message) > LONGEST_MESSAGE or "\n" in message:
            return f"a message of {len(message)} characters: {message[:100]!r}"
        return "refused"
    except BaseException as error:  # noqa: BLE001, a panic is none of `Exception`
        return f"{type(error).__name__}: {str(error)[:200]!r}"
    return "accepted"


def one(kind: Reader, number: int, seed: int, folder: Path) -> str:
    """Makes a file and reads it."""
    ending, good, read = kind
    chance = random.Random(seed * 1_000_003 + number)
    place = Path(tempfile.mkdtemp(dir=folder))
    for other in ("toml", "csv"):
        os.mkfifo(place / f"pipe.{other}")
        (place / f"zero.{other}").symlink_to("/dev/zero")
        (place / f"circle.{other}").symlink_to(place / f"circle.{other}")
        (place / f"folder.{other}").mkdir()
    path = place / f"self.{ending}"
    mutate(good, path, chance)
    return outcome(read, path)


def peak_mib() -> float:
    """Returns the most memory that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def work(numbers: range, seed: int, kinds: list[Reader], folder: Path, pipe: int) -> None:
    """Reads files one after the other, telling of each."""
    # What is printed about an abort goes nowhere.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    at_first_mib = peak_mib()
    for number in numbers:
        began_s = time.monotonic()
        told = one(kinds[number % len(kinds)], number, seed, folder)
        line = json.dumps([number, told, time.monotonic() - began_s, peak_mib() - at_first_mib])
        os.write(pipe, (line + "\n").encode())


class Tally:
    """What was seen."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.wrong: list[str] = []
        self.slowest_s = 0.0
        self.added_mib = 0.0

    def note(self, number: int, told: str, seconds: float, added_mib: float) -> None:
        """Takes what a process tells of a file."""
        self.slowest_s = max(self.slowest_s, seconds)
        self.added_mib = max(self.added_mib, added_mib)
        self.counts[told if told in {"accepted", "refused"} else "wrong"] += 1
        if told not in {"accepted", "refused"}:
            self.wrong.append(f"file {number}: {told}")
        if seconds > LONGEST_S or added_mib > LARGEST_MIB:
            self.wrong.append(f"file {number}: {seconds:.1f} s, {added_mib:.0f} MiB more")

    def batch(self, numbers: range, seed: int, kinds: list[Reader], folder: Path) -> int:
        """Lets a process read files; returns the number of the one to go on with."""
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            try:
                work(numbers, seed, kinds, folder, writing)
            finally:
                os._exit(0)
        os.close(writing)
        after, buffer = numbers.start, b""
        late = False
        while not late:
            late = not select.select([reading], [], [], 2 * LONGEST_S)[0]
            data = b"" if late else os.read(reading, 65536)
            if not data:
                break
            buffer += data
            *lines, buffer = buffer.split(b"\n")
            for line in lines:
                fields: list[Any] = json.loads(line)
                self.note(*fields)
                after = fields[0] + 1
        if late:
            os.kill(child, signal.SIGKILL)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        os.close(reading)
        if after < numbers.stop:
            self.wrong.append(f"file {after}: " + ("no end" if late else f"the process died ({status})"))
            self.counts["wrong"] += 1
            return after + 1
        return numbers.stop


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=300, help="number of files")
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        kinds = readers(a_checkpoint(Path(folder)))
    tally, next_one = Tally(), 0
    while next_one < chosen.count:
        with tempfile.TemporaryDirectory() as folder:
            numbers = range(next_one, min(next_one + AT_ONCE, chosen.count))
            next_one = tally.batch(numbers, chosen.seed, kinds, Path(folder))
    print(f"files of {len(kinds)} kinds: {tally.counts.total()}")
    print(f"accepted: {tally.counts['accepted']}, refused in one line: {tally.counts['refused']}")
    print(f"slowest: {tally.slowest_s:.2f} s; most memory that a process added: {tally.added_mib:.0f} MiB")
    for what in tally.wrong:
        print(f"WRONG: {what}")
    print(f"wrong: {len(tally.wrong)}")
    sys.exit(1 if tally.wrong else 0)


if __name__ == "__main__":
    main()
