"""The README's lines of stock stable-baselines3 train and save, and the benchmark takes what they saved."""

import json
import re
from pathlib import Path

import pytest
from stable_baselines3 import DQN, PPO
from typer.testing import CliRunner, Result

from hp_gym.cli.app import app

pytestmark = pytest.mark.training

README = Path(__file__).parents[2] / "README.md"

GRID = """
description = "One cold trip"
scenario = "ours/commute-minus5"
ambient_temperatures_degc = [-5, 5]

[[cycles]]
name = "nedc"

[[variants]]
name = "dark"
occupants = 1
state_of_charge_pct = 90.0

[[bands]]
name = "all"
low_degc = -50.0
headline = true

[[fronts]]
family = "hpcu"
cabin_offsets_k = [-4, 0]
htc_offsets_k = [0]
"""

MODEL = {"n_steps": 16, "batch_size": 16, "seed": 0}


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.toml").write_text(GRID, encoding="utf-8")
    return tmp_path


def benchmark(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["benchmark", "--grid", "small.toml", "--out", "out", *arguments])


def test_the_lines_of_the_readme_train_save_and_are_compared(place: Path) -> None:
    text = README.read_text(encoding="utf-8")
    (lines,) = (
        code for code in re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL) if "learn(" in code
    )
    (command,) = re.findall(r"^uv run --extra train hp-gym benchmark (.*)$", text, flags=re.MULTILINE)
    short, changed = re.subn(r"total_timesteps=[0-9_]+", "total_timesteps=2048", lines)
    assert changed == 1
    exec(compile(short, str(README), "exec"), {})
    assert (place / "ppo.zip").is_file()
    result = benchmark(*command.split(), "--json")
    assert result.exit_code == 0, result.output
    assert "Warning: loading a zip file" in result.stderr
    summary = json.loads(result.stdout)
    assert set(summary["controllers"]) >= {"hpcu", "ppo.zip"}
    assert any(name.startswith("ppo.zip_vs_hpcu") for name in summary["gains"])


def test_a_zip_file_is_benchmarked_on_request_only(place: Path) -> None:
    PPO("MlpPolicy", "EVHeatPump-v0", **MODEL).save(place / "mine.zip")
    result = benchmark("mine.zip")
    assert result.exit_code == 2
    assert "can run code" in result.stderr
    assert "--allow-code" in result.stderr
    assert not (place / "out").exists()


def test_actions_of_a_zip_file_tell_its_id_and_what_does_not_fit_is_refused(place: Path) -> None:
    PPO("MlpPolicy", "EVHeatPumpContinuous-v0", **MODEL).save(place / "values-seed3.zip")
    result = benchmark("values-seed3.zip", "--allow-code", "--json")
    assert result.exit_code == 0, result.output
    assert "values.zip" in json.loads(result.stdout)["controllers"]
    DQN("MlpPolicy", "EVHeatPumpFlat-v0", buffer_size=10).save(place / "flat.zip")
    result = benchmark("flat.zip", "--allow-code")
    assert result.exit_code == 2
    assert "only PPO, MaskablePPO, A2C, SAC and TD3" in result.stderr
