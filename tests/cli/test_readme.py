"""The snippets of the README and of the page on learning run as they stand."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"


def snippets(page: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), flags=re.DOTALL)


SNIPPETS = snippets(README)
# Of the page on learning, what needs neither training nor another package.
SNIPPETS += [
    text
    for text in snippets(ROOT / "docs" / "rl.md")
    if not any(word in text for word in ("ray", "learn(", "runs/"))
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
    used = set(re.findall(r"uv run hp-gym (\w+)", README.read_text(encoding="utf-8")))
    assert used <= names
