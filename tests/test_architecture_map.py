"""The map of ARCHITECTURE.md is true, and the code keeps what it promises of itself.

What it promises: a newcomer finds an equation of the paper with at most three look-ups, no function of the
core is longer than 60 lines, and a single kind of member is spelled out in few files.
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
MAP = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
PLANT = ROOT / "rust_core" / "plant" / "src"
LONGEST_FUNCTION_LINES = 60
MOST_FILES_WITH_A_THERMAL_BATTERY = 8

# What a newcomer looks for, as the map puts it.
LOOKED_FOR = (
    "equation 1",
    "equations 2 and 3",
    "equations 4 and 5",
    "equation 6",
    "balance of the cabin",
    "exhaust recovery",
    "PTC and its cut-off",
    "the HPCU's rules",
    "-10 degC",
    "thermal switches",
    "bypass",
    "pressure control",
)


def found(path: str) -> Path:
    """A path of the map: from the root, or from the plant's sources."""
    return ROOT / path if (ROOT / path).exists() else PLANT / path


def tree() -> list[str]:
    """Paths of the tree at the top, each from the root."""
    block = MAP.split("```")[1]
    folders: list[str] = []
    paths = []
    for line in block.splitlines():
        entry = re.match(r"^( *)(\S.*?)(?:  |$)", line)
        # A line that goes on with what the one above says.
        if entry is None or len(entry[1]) > 6:
            continue
        # `tests/ benches/` are two; `src/experiment.rs` with `run.rs` in its text is one.
        names = entry[2].split()
        depth = len(entry[1]) // 2
        folders = [*folders[:depth], names[0].rstrip("/")]
        paths += ["/".join([*folders[:depth], name.rstrip("/")]) for name in names]
    return paths


def rows() -> list[tuple[str, list[str], list[str]]]:
    """What is looked for, files, items in them."""
    lines = MAP.split("## Where is ...?")[1].split("\n## ")[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    quoted = re.compile("`([^`]+)`")
    return [(what, quoted.findall(files), quoted.findall(items)) for what, files, items in cells[2:]]


def test_every_path_of_the_tree_is_there() -> None:
    paths = tree()
    assert len(paths) > 60
    assert "rust_core/plant/src/components" in paths
    assert "hp_gym/studies/benchmark" in paths
    for path in paths:
        assert list(ROOT.glob(path)), path


def test_every_path_in_the_text_is_there() -> None:
    text = MAP.split("```")[2]
    quoted = set(re.findall(r"`([\w./-]+/[\w./*-]+)`", text)) | set(
        re.findall(r"`([\w-]+\.(?:rs|toml|py))`", text)
    )
    assert len(quoted) > 15
    for path in quoted:
        assert found(path).exists() or list(ROOT.glob(path)), path
    links = re.findall(r"\]\(([^)#]+)\)", text)
    assert links
    for link in links:
        assert (ROOT / link).exists(), link


@pytest.mark.parametrize("wanted", LOOKED_FOR)
def test_a_newcomer_finds_it(wanted: str) -> None:
    matching = [row for row in rows() if wanted in row[0]]
    assert len(matching) == 1, wanted


def test_every_named_item_is_in_a_named_file() -> None:
    for what, files, items in rows():
        assert files, what
        assert items, what
        folders = [found(file) for file in files]
        texts = [
            path.read_text(encoding="utf-8")
            for folder in folders
            for path in (sorted(folder.glob("*.rs")) if folder.is_dir() else [folder])
        ]
        for item in items:
            # As a definition or a use in code, not in a comment.
            code = re.compile(rf"^(?!\s*//).*\b{re.escape(item)}\b", re.MULTILINE)
            assert any(code.search(text) for text in texts), (what, item)


def functions(text: str) -> dict[str, int]:
    """Lines of each function that has a body, by name; formatted code closes it at the indent of its `fn`."""
    lines, lengths = text.splitlines(), {}
    head = re.compile(r"^( *)(?:pub(?:\([a-z]+\))? )?(?:const )?(?:unsafe )?fn (\w+)")
    for start, line in enumerate(lines):
        if (declared := head.match(line)) is None:
            continue
        indent, name = declared.groups()
        for end in range(start, len(lines)):
            last = lines[end]
            if last.startswith(f"{indent}}}") or (end == start and last.endswith(("}", "{}"))):
                lengths[f"{name}:{start + 1}"] = end - start + 1
                break
            # A declaration of a trait.
            if last.endswith(";") and not last.startswith(f"{indent}  "):
                break
            if end == start and last.endswith(";"):
                break
            if last == f"{indent});":
                break
    return lengths


def test_the_count_of_lines_sees_long_functions() -> None:
    body = "\n".join(f"        let x{i} = {i};" for i in range(70))
    declared = "trait T {\n    fn a(&self);\n}\n"
    text = f"{declared}impl X {{\n    pub fn long(\n        &self,\n    ) {{\n{body}\n    }}\n}}\n"
    assert functions(text) == {"long:5": 74}


def test_no_function_of_the_core_is_longer_than_60_lines() -> None:
    files = sorted((ROOT / "rust_core").glob("*/src/**/*.rs"))
    assert len(files) > 90
    counted = 0
    for file in files:
        lengths = functions(file.read_text(encoding="utf-8"))
        counted += len(lengths)
        for name, length in lengths.items():
            assert length <= LONGEST_FUNCTION_LINES, f"{file.relative_to(ROOT)}: {name} has {length} lines"
    assert counted > 900


def test_a_thermal_battery_is_spelled_out_in_few_files() -> None:
    sources = [*(ROOT / "rust_core").glob("*/src/**/*.rs"), *(ROOT / "hp_gym").glob("**/*.py")]
    mentions = re.compile("thermal.?battery", re.IGNORECASE)
    files = [
        str(path.relative_to(ROOT)) for path in sources if mentions.search(path.read_text(encoding="utf-8"))
    ]
    assert len(files) <= MOST_FILES_WITH_A_THERMAL_BATTERY, files
