"""Folders of results: replaced whole or not at all, by one process at a time, and nothing is left behind."""

import errno
import os
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from hp_gym import transactions
from hp_gym.agents.training import configuration
from hp_gym.agents.training.run_folder import RunFolder, RunFolderError
from hp_gym.cli.app import app
from hp_gym.files import atomic_write
from hp_gym.locks import lock, lock_path
from hp_gym.messages import FileError
from hp_gym.transactions import new_contents

ROOT = Path(__file__).parents[2]


def invoke(*words: object) -> str:
    """A command that fails: its one line."""
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exit_code == 2, result.output
    assert len(result.stderr.splitlines()) == 1
    return result.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="the script forks")
def test_a_kill_at_any_step_leaves_old_or_new_results_and_no_debris_after_the_next_run() -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "scripts" / "kill_results.py"],
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    counts = dict(line.split(": ") for line in done.stdout.splitlines())
    assert done.returncode == 0, done.stdout + done.stderr
    assert counts["wrong"] == "0"
    assert int(counts["folder"]) > 20
    assert int(counts["folder without swap"]) > 20
    assert int(counts["file"]) > 8


def test_old_and_new_contents_change_places_in_one_rename(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "results"
    folder.mkdir()
    (folder / "a.txt").write_text("old")
    renames: list[str] = []
    for name in ("rename", "replace"):
        monkeypatch.setattr(os, name, lambda *_, name=name: renames.append(name))
    with new_contents(folder) as staged:
        (staged / "a.txt").write_text("new")
        assert (folder / "a.txt").read_text() == "old"
    if sys.platform == "linux":
        assert renames == []
        assert (folder / "a.txt").read_text() == "new"
    assert [path.name for path in tmp_path.iterdir()] == ["results"]


def test_results_that_cannot_take_their_place_leave_the_old_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def busy(*_: object) -> None:
        raise OSError(errno.EBUSY, os.strerror(errno.EBUSY), "results")

    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "a.txt").write_text("old")
    monkeypatch.setattr(transactions, "_exchange", busy)
    with pytest.raises(OSError, match="busy"), new_contents(tmp_path / "results") as staged:
        (staged / "a.txt").write_text("new")
    assert (tmp_path / "results" / "a.txt").read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["results"]


def test_debris_of_earlier_versions_goes_and_files_of_others_stay(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    (folder / ".new.0123abcd").mkdir(parents=True)
    (folder / ".new.mine").mkdir()
    (folder / "notes.txt").write_text("mine")
    (folder / "link").symlink_to("notes.txt")
    others = tmp_path / ".results-of-mine.hp-gym-01234567.new"
    others.mkdir()
    with new_contents(folder):
        pass
    assert {path.name for path in folder.iterdir()} == {".new.mine", "notes.txt", "link"}
    assert (folder / "link").is_symlink()
    assert others.exists()


def test_the_working_folder_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "inner").mkdir()
    monkeypatch.chdir(tmp_path / "inner")
    for folder in (Path(), tmp_path):
        with pytest.raises(FileError, match="choose one in it"), new_contents(folder):
            pytest.fail("was begun")


def test_a_second_writer_is_refused_in_one_line(tmp_path: Path) -> None:
    out = tmp_path / "out"
    config = tmp_path / "small.toml"
    config.write_text("algorithm = 'ppo'")
    with lock(out):
        for words in (
            ["benchmark", "off", "--out", out],
            ["tune", "--trips", 1, "--trials", 10, "--out", out],
            ["train", "ppo", "--out", out],
        ):
            line = invoke(*words)
            assert f"{out}: another process ({os.getpid()}) writes its results there" in line
    assert not lock_path(out).exists()
    assert not out.exists()


def test_two_that_resume_do_not_meet(tmp_path: Path) -> None:
    out = tmp_path / "run"
    RunFolder(out).create(configuration.load("ppo"), "ppo", 0)
    (out / "checkpoints" / "000000000001.pt").write_text("of the first")
    with lock(out):
        assert "another process" in invoke("train", "--resume", out)
    assert (out / "checkpoints" / "000000000001.pt").read_text() == "of the first"


@pytest.mark.skipif(sys.platform == "win32", reason="killed by SIGKILL")
def test_a_lock_does_not_outlive_a_killed_process(tmp_path: Path) -> None:
    code = (
        "import os, sys; from pathlib import Path; from hp_gym.locks import lock\n"
        "with lock(Path(sys.argv[1])): os.kill(os.getpid(), 9)"
    )
    killed = subprocess.run([sys.executable, "-c", code, tmp_path / "out"], check=False, timeout=60)
    assert killed.returncode == -9
    assert lock_path(tmp_path / "out").exists()
    with lock(tmp_path / "out"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_half_written_files_of_killed_processes_are_swept_and_those_of_living_ones_are_not(
    tmp_path: Path,
) -> None:
    target = tmp_path / "policy.bin"
    debris = tmp_path / ".policy.hp-gym-0123abcd.bin"
    foreign = tmp_path / ".policy.0123abcd.bin"
    debris.touch()
    foreign.touch()
    with atomic_write(target) as outer:
        outer.write_text("outer")
        with atomic_write(target) as inner:
            inner.write_text("inner")
        assert outer.exists()
    assert target.read_text() == "outer"
    assert {path.name for path in tmp_path.iterdir()} == {target.name, foreign.name}


def test_a_run_that_was_killed_while_it_began_can_be_begun_again(tmp_path: Path) -> None:
    out = tmp_path / "run"
    training = configuration.load("ppo")
    RunFolder(out).create(training, "ppo", 0)
    (out / "config.toml").unlink()
    (out / ".run.hp-gym-0123abcd.json").touch()
    with pytest.raises(RunFolderError, match="holds no run"):
        RunFolder(out).require_begun()
    RunFolder(out).create(training, "ppo", 1)
    assert RunFolder(out).reopen()[2] == 1
    assert {path.name for path in out.iterdir()} == {"config.toml", "run.json", "checkpoints"}
