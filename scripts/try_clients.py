"""Runs stock examples of outside RL clients on our environments: `.ci/clients` makes the environment for it.

Each client gets a fresh virtual environment with a wheel of ours and its own packages, and each example of
tests/clients is a process in it, one thread, on the CPU. The table goes to the terminal and, with `--write`,
into docs/clients.md. Ends with 1 if an example fails whose failure is not known to be the client's.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).resolve().parents[1]
EXAMPLES: Final = ROOT / "tests" / "clients"
PAGE: Final = ROOT / "docs" / "clients.md"
TIMEOUT_S: Final = 900

# Only needed to compile models, and a gigabyte.
WITHOUT_TRITON: Final = "triton ; sys_platform == 'never'\n"


@dataclass(frozen=True)
class Example:
    """A file of tests/clients with its arguments; `what` says what it does."""

    file: str
    what: str
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True)
class Client:
    """What is installed, whose versions are told, and what runs.

    Attributes:
        name: On the command line and in the table.
        packages: What is installed beside our wheel.
        told: Distributions whose versions are told.
        examples: What runs.
        extras: Extras of ours that are installed too: those whose bounds might not fit the client's.
        note: What is wrong in the client itself, or to know of it, for the table.
    """

    name: str
    packages: tuple[str, ...]
    told: tuple[str, ...]
    examples: tuple[Example, ...]
    extras: str = ""
    note: str = ""


CLIENTS: Final = (
    Client(
        "stable-baselines3",
        ("stable-baselines3",),
        ("stable-baselines3",),
        (Example("stable_baselines3_ppo.py", "`check_env`, PPO (`MultiDiscrete`, `Box`), DQN"),),
    ),
    Client(
        "cleanrl",
        ("torch",),
        ("torch",),
        (
            Example("cleanrl_ppo.py", "PPO's single file, discrete: default and flat id", ("discrete",)),
            Example("cleanrl_ppo.py", "PPO's single file, continuous, with its wrappers", ("continuous",)),
        ),
        note="the distribution `cleanrl` 1.2.0 is for Python below 3.11, pins gym 0.23.1 and pygame 2.1.0; "
        "its algorithm's shape runs in lines of our own",
    ),
    Client(
        "torchrl",
        ("torchrl", "torch"),
        ("torchrl", "tensordict"),
        (
            Example(
                "torchrl_single.py", "`GymEnv`, `check_env_specs`, `auto_register_info_dict`, PPO's loss"
            ),
            Example(
                "torchrl_vector.py",
                "native vector environment (`SAME_STEP`, `DISABLED`) over ends of trips, `ParallelEnv`",
            ),
        ),
        note="refuses vector environments that reset in the next step (Gymnasium's default, its own too): "
        "`make_vec(..., autoreset_mode=...)`",
    ),
    Client(
        "minari",
        ("minari[hdf5,create]", "pillow"),
        ("minari",),
        (Example("minari_record.py", "`DataCollector(record_infos=True)`, replayed bit for bit"),),
        note="its extra `hdf5` lacks Pillow, which it imports",
    ),
    Client(
        "tianshou",
        ("tianshou[eval]",),
        ("tianshou", "pandas"),
        (
            Example("tianshou_low.py", "procedural: collector, buffer, DQN"),
            Example("tianshou_high.py", "high level: PPO and DQN experiments"),
        ),
        extras="benchmark",
        note="its high level needs its extra `eval`; it pins pandas below 3, which our extras take",
    ),
    Client(
        "skrl",
        ("skrl[torch]",),
        ("skrl",),
        (Example("skrl_ppo.py", "PPO on all kinds of action, native vector and single environment"),),
    ),
    Client(
        "rllib",
        ("ray[rllib]", "torch"),
        ("ray", "gymnasium"),
        (Example("rllib_ppo.py", "PPO on all kinds of action"),),
        note="pins Gymnasium 1.2.2, which we take",
    ),
    Client(
        "rl_zoo3",
        ("rl_zoo3", "requests"),
        ("rl_zoo3",),
        (Example("rl_zoo3_ppo.py", "`rl_zoo3.train` with a file of hyperparameters, `rl_zoo3.enjoy`"),),
        note="`rl_zoo3.enjoy` imports requests without asking for it",
    ),
    Client(
        "sbx",
        ("sbx-rl",),
        ("sbx-rl", "jax"),
        (Example("sbx_ppo.py", "PPO (`MultiDiscrete`, `Box`), SAC, DQN"),),
    ),
    Client(
        "mo-gymnasium",
        ("mo-gymnasium",),
        ("mo-gymnasium",),
        (Example("mo_gymnasium_vector.py", "`LinearReward`, statistics, `MOSyncVectorEnv`"),),
    ),
)


def main() -> int:
    """Runs the clients that were asked for, all by default."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clients", nargs="*", metavar="NAME", help=", ".join(one.name for one in CLIENTS))
    parser.add_argument("--write", action="store_true", help="write the table into docs/clients.md")
    asked = parser.parse_args()
    unknown = set(asked.clients) - {one.name for one in CLIENTS}
    if unknown:
        known = ", ".join(one.name for one in CLIENTS)
        parser.error(f"no client {', '.join(sorted(unknown))}; there are {known}")
    chosen = [one for one in CLIENTS if not asked.clients or one.name in asked.clients]
    rows, failed = [], False
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "overrides.txt").write_text(WITHOUT_TRITON, encoding="utf-8")
        wheel = build(folder)
        for client in chosen:
            for row, ok in outcomes(client, wheel, folder):
                print(row, flush=True)
                rows.append(row)
                failed = failed or not ok
    if asked.write and not asked.clients:
        write(rows)
    return int(failed)


def build(folder: Path) -> Path:
    """Builds our wheel, once for all clients."""
    run(["uv", "build", "--wheel", "--quiet", "--out-dir", str(folder / "dist")], ROOT)
    (wheel,) = (folder / "dist").glob("*.whl")
    return wheel


def outcomes(client: Client, wheel: Path, folder: Path) -> list[tuple[str, bool]]:
    """Installs a client and runs its examples: rows of the table, and whether each went well."""
    place = folder / client.name
    python = place / "bin" / "python"
    ours = f"ev-heat-pump-gym{f'[{client.extras}]' if client.extras else ''} @ {wheel.as_uri()}"
    overrides = str(folder / "overrides.txt")
    try:
        run(["uv", "venv", "--quiet", str(place)], folder)
        install = ["uv", "pip", "install", "--quiet", "--python", str(python), "--overrides", overrides]
        run([*install, ours, *client.packages], folder)
    except subprocess.CalledProcessError as error:
        return [(row(client, "", "installation", f"fails: {last_line(error.stderr)}", client.note), False)]
    versions = ", ".join(f"{name} {version(python, name)}" for name in client.told)
    rows = []
    for number, example in enumerate(client.examples):
        result = attempt(example, python)
        note = "" if number else client.note
        rows.append((row(client, versions, example.what, result, note), result.startswith("ok")))
    return rows


def attempt(example: Example, python: Path) -> str:
    """Runs one example in a folder of its own, with one thread; what came of it."""
    alone = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "PASSIVE", "CUDA_VISIBLE_DEVICES": ""}
    began_s = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        command = [str(python), str(EXAMPLES / example.file), *example.arguments]
        try:
            run(command, Path(folder), alone)
        except subprocess.CalledProcessError as error:
            print(error.stderr, file=sys.stderr)
            return f"fails: {last_line(error.stderr)}"
        except subprocess.TimeoutExpired:
            return f"fails: not done after {TIMEOUT_S} s"
    return f"ok, {time.perf_counter() - began_s:.0f} s"


def run(command: list[str], folder: Path, environment: dict[str, str] | None = None) -> str:
    """Runs a command and returns what it printed."""
    done = subprocess.run(
        command,
        cwd=folder,
        env={**os.environ, **(environment or {})},
        capture_output=True,
        text=True,
        check=True,
        timeout=TIMEOUT_S,
    )
    return done.stdout


def version(python: Path, distribution: str) -> str:
    """Returns the version of what is installed in an environment."""
    code = f"from importlib.metadata import version; print(version({distribution!r}))"
    return run([str(python), "-c", code], python.parent).strip()


def last_line(text: str) -> str:
    """Returns the last line that says something, fit for a cell."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1].replace("|", "/")[:300] if lines else "without a word"


def row(client: Client, versions: str, what: str, result: str, note: str) -> str:
    """Returns a row of the table."""
    return f"| {client.name} | {versions} | {what} | {result} | {note} |"


def write(rows: list[str]) -> None:
    """Puts the table in its place in the page."""
    head = ["| Client | Versions | Example | Result | Note |", "|---|---|---|---|---|"]
    table = "\n".join(("<!-- table -->", "", *head, *rows, "", "<!-- end -->"))
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(
        re.sub(r"<!-- table -->.*<!-- end -->", lambda _: table, text, flags=re.DOTALL), encoding="utf-8"
    )


if __name__ == "__main__":
    sys.exit(main())
