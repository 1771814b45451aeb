"""The snippets of the README, of the index's page and of the page on learning run as they stand."""

import re
from pathlib import Path

import pytest

from hp_gym import extras

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"


def snippets(page: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)


INDEX_PAGE = ROOT / "docs" / "index-page.md"

# What needs neither training nor another package; tests/agents/test_stock_ppo.py and test_record.py run more.
SNIPPETS = [
    text
    for page in (README, INDEX_PAGE, ROOT / "docs" / "rl.md")
    for text in snippets(page)
    if not any(word in text for word in ("ray", "learn(", "runs/", "minari"))
]


@pytest.mark.parametrize("snippet", SNIPPETS, ids=range(len(SNIPPETS)))
def test_snippet_runs(snippet: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(snippet, str(README), "exec"), {})


def test_there_are_snippets() -> None:
    assert SNIPPETS


def test_every_command_of_the_readme_exists() -> None:
    from hp_gym.cli.app import app

    names = {
        command.name or command.callback.__name__ for command in app.registered_commands if command.callback
    }
    used = set(re.findall(r"hp-gym ([a-z]+)[ \n`]", README.read_text(encoding="utf-8")))
    assert {"benchmark", "reproduce", "run", "scenarios"} <= used <= names


def test_every_extra_of_the_documents_exists() -> None:
    named: set[str] = set()
    for page in (
        README,
        ROOT / "CONTRIBUTING.md",
        *(ROOT / "docs").glob("*.md"),
        *(ROOT / "agents").rglob("*.md"),
    ):
        named |= set(re.findall(r"--extra ([a-z]+)", page.read_text(encoding="utf-8")))
    assert "studies" in named
    assert named <= set(extras.EXTRAS)
    for page in (README, INDEX_PAGE):
        table = re.findall(r"^\| `([a-z]+)`", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
        assert set(extras.EXTRAS) <= set(table)


def test_the_page_of_the_index_needs_no_file_beside_it() -> None:
    targets = re.findall(r"\]\(([^)]*)\)", INDEX_PAGE.read_text(encoding="utf-8"))
    assert targets
    assert all(target.startswith("https://") for target in targets)
