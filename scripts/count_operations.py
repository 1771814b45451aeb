"""Count what a plant step executes: arithmetic, moves and branches, by the program that callgrind ran.

Build the workload with ``cargo build --release -p hp_trip --example step_cost``, then run
``python scripts/count_operations.py heating`` (or ``random``). Needs valgrind and objdump on an x86-64 Linux.
"""

import argparse
import collections
import pathlib
import re
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
GROUPS = {
    "add, subtract": r"(add|sub)[sp]d",
    "multiply": r"mul[sp]d",
    "divide": r"div[sp]d",
    "square root": r"sqrt[sp]d",
    "compare, select": r"(u?comis|cmp\w*|max|min|and|andn|or|xor)[sp][sd]",
    "move, convert, shuffle": r"mov(?!s[lwbq]|z)\w*|unpck\w+|shuf\w+|cvt\w+|mova?[pq]\w*",
}


def mnemonics(program: pathlib.Path) -> dict[int, str]:
    """Instruction names of a program by address."""
    listing = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", str(program)], check=True, capture_output=True, text=True
    ).stdout
    found = re.finditer(r"^\s*([0-9a-f]+):\t(\S+)", listing, flags=re.MULTILINE)
    return {int(match[1], 16): match[2] for match in found}


def executed(program: pathlib.Path, workload: str) -> tuple[int, dict[int, int], int]:
    """Steps, executions by address inside the program, and executions elsewhere (libraries)."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "callgrind"
        command = ["valgrind", "--tool=callgrind", "--dump-instr=yes", "--toggle-collect=*measured*"]
        command += [f"--callgrind-out-file={out}", str(program), workload, "1"]
        run = subprocess.run(command, check=True, capture_output=True, text=True)
        text = out.read_text()
    steps = int(re.search(r"(\d+) steps", run.stdout)[1])  # type: ignore[index]
    inside, outside = collections.Counter[int](), 0
    address, ours, call = 0, False, False
    names: dict[str, str] = {}
    for line in text.splitlines():
        if line.startswith("ob="):
            number, _, name = line[3:].partition(" ")
            names[number] = name or names.get(number, "")
            ours = names[number].endswith(program.name)
        elif line.startswith("calls="):
            call = True
        elif match := re.match(r"(0x[0-9a-f]+|\+\d+|-\d+|\*)(?: \S+)? (\d+)$", line):
            place = match[1]
            address = (
                address if place == "*" else address + int(place) if place[0] in "+-" else int(place, 16)
            )
            if not call:
                inside[address] += int(match[2]) if ours else 0
                outside += 0 if ours else int(match[2])
            call = False
    return steps, dict(inside), outside


def main() -> None:
    """Print executions a step by kind."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("workload", choices=["heating", "random"])
    workload = parser.parse_args().workload
    program = ROOT / "target/release/examples/step_cost"
    names = mnemonics(program)
    steps, counts, outside = executed(program, workload)
    # valgrind loads the program at a page of its own choice: the one where the addresses are instructions.
    lowest = min(address for address, count in counts.items() if count)
    bases = (
        base for base in range(0, lowest, 0x1000) if all(a - base in names for a, n in counts.items() if n)
    )
    base = next(bases)
    groups: collections.Counter[str] = collections.Counter()
    for address, count in counts.items():
        if count:
            name = names[address - base]
            group = next(
                (key for key, form in GROUPS.items() if re.fullmatch(form, name)), "integer, branch, call"
            )
            groups[group + (", packed" if name.endswith("pd") and group in list(GROUPS)[:4] else "")] += count
    groups["libraries (exp, log, pow, memcpy)"] = outside
    for group, count in sorted(groups.items(), key=lambda item: -item[1]):
        print(f"{group:40s} {count / steps:8.1f}")
    print(f"{'all':40s} {sum(groups.values()) / steps:8.1f}")


if __name__ == "__main__":
    main()
