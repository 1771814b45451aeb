"""Without an extra's packages: what works goes on working, the rest says in one line how to get them."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import hp_gym
from hp_gym import extras

ROOT = Path(__file__).parents[1]
IMPORT_NAMES = {
    "pillow": "PIL",
    "salib": "SALib",
    "sb3-contrib": "sb3_contrib",
    "stable-baselines3": "stable_baselines3",
}
# Typer brings pydantic along.
ALL = sorted({package for packages in extras.EXTRAS.values() for package in packages} - {"pydantic"})

BLOCK = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {blocked!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Blocked())
"""


def python(code: str, blocked: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs code in a Python that does not find some packages."""
    return subprocess.run(
        [sys.executable, "-c", BLOCK.format(blocked=set(blocked)) + code],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "MPLBACKEND": "Agg"},
    )


def hp_gym_command(
    arguments: list[str], blocked: list[str], folder: Path
) -> subprocess.CompletedProcess[str]:
    code = f"from hp_gym.cli.app import app; app({arguments!r}, prog_name='hp-gym')"
    return python(code, blocked, folder)


def without(*names: str) -> list[str]:
    """All optional packages but those of some extras."""
    kept = {package for name in names for package in extras.EXTRAS[name]}
    return [package for package in ALL if package not in kept]


def test_the_list_of_extras_is_that_of_the_package() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    listed = {
        extra: sorted(IMPORT_NAMES.get(name, name) for name in (_name(entry) for entry in requirements))
        for extra, requirements in project["optional-dependencies"].items()
    }
    assert listed == {extra: sorted(packages) for extra, packages in extras.EXTRAS.items()}
    assert project["name"] == extras.DISTRIBUTION
    assert {_name(entry) for entry in project["dependencies"]} == {"gymnasium", "numpy", "rich", "typer"}


def _name(requirement: str) -> str:
    return re.split(r"[<>=!~;\[ ]", requirement, maxsplit=1)[0]


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["scenarios"]])
def test_the_bare_command_line_works(arguments: list[str], tmp_path: Path) -> None:
    result = hp_gym_command(arguments, ALL, tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stdout


def test_the_bare_package_drives_and_writes_the_table_that_pandas_would(tmp_path: Path) -> None:
    arguments = ["run", "ours/commute-minus5", "--out", "run.csv", "--json"]
    result = hp_gym_command(arguments, ALL, tmp_path)
    assert result.returncode == 0, result.stderr
    trajectory = hp_gym.simulate("ours/commute-minus5")
    assert json.loads(result.stdout)["summary"]["energy_kwh"] == trajectory.summary["energy_kwh"]
    trajectory.to_pandas().to_csv(tmp_path / "pandas.csv", index=False)
    assert (tmp_path / "run.csv").read_bytes() == (tmp_path / "pandas.csv").read_bytes()


def test_the_bare_package_replays_a_trip(tmp_path: Path) -> None:
    rows = "".join(f"{second},{min(second, 30)},{second * 50}\n" for second in range(60))
    (tmp_path / "trip.csv").write_text(
        f"time_s,speed_km_h,measured_battery_power_w\n{rows}", encoding="utf-8"
    )
    result = hp_gym_command(["replay", "compact_ev", "trip.csv", "--out", "out", "--json"], ALL, tmp_path)
    assert result.returncode == 0, result.stderr
    # 50 W more every second, up to 59 s.
    assert json.loads(result.stdout)["energy_kwh"]["measured"] == 50.0 * 59.0**2 / 2.0 / 3.6e6
    code = "import hp_gym; print(hp_gym.replay('compact_ev', 'trip.csv')._repr_html_())"
    assert "<table>" in python(code, ALL, tmp_path).stdout


def test_the_bare_package_makes_environments(tmp_path: Path) -> None:
    code = (
        "import gymnasium as gym, hp_gym; from hp_gym.envs.hpcu_policy import HpcuPolicy\n"
        "env = gym.make('EVHeatPump-v0'); observation, _ = env.reset(seed=0)\n"
        "env.step(HpcuPolicy(env)(observation))\n"
        "from hp_gym import *; assert 'sweep' in dir(hp_gym)\n"
        "envs = gym.make_vec('EVHeatPump-v0', num_envs=3); envs.reset(seed=0)\n"
        "envs.step(envs.action_space.sample())"
    )
    result = python(code, ALL, tmp_path)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (["benchmark"], "benchmark"),
        (["run", "ours/commute-minus5", "--out", "run.parquet"], "benchmark"),
        (["run", "ours/commute-minus5", "--plot", "run.png"], "plot"),
        (["replay", "compact_ev", "trip.csv", "--plot", "trip.png"], "plot"),
        (["reproduce"], "plot"),
        (["calibrate"], "studies"),
        (["tune"], "studies"),
        (["optimise", "--axis", "htc_set_point_degc=40:90"], "studies"),
        (["sweep", "--axis", "htc_set_point_degc=40,90"], "sweep"),
        (["train"], "train"),
        (["record", "hpcu"], "data"),
        (["export", "policy.safetensors", "--out", "policy.onnx"], "export"),
    ],
    ids=" ".join,
)
def test_a_command_without_its_extra_says_in_one_line_how_to_get_it(
    arguments: list[str], extra: str, tmp_path: Path
) -> None:
    result = hp_gym_command(arguments, ALL, tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert len(result.stderr.splitlines()) == 1, result.stderr
    assert f'pip install "ev-heat-pump-gym[{extra}]"' in result.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("code", "extra"),
    [
        ("hp_gym.simulate('ours/commute-minus5').to_pandas()", "benchmark"),
        ("hp_gym.simulate('ours/commute-minus5').save('run.parquet')", "benchmark"),
        ("import hp_gym.pictures.plotting", "plot"),
        ("env = gym.make('EVHeatPump-v0', render_mode='rgb_array'); env.reset(); env.render()", "plot"),
        ("from hp_gym.pictures.window import Window; Window()", "plot"),
        ("import hp_gym.envs.sb3", "train"),
        ("hp_gym.simulate('ours/commute-minus5').to_xarray()", "sweep"),
        ("hp_gym.sweep({'htc_set_point_degc': [50.0]})", "sweep"),
        ("hp_gym.optimise({'htc_set_point_degc': (50.0, 80.0)})", "studies"),
        ("hp_gym.calibrate('jeffs2019')", "studies"),
        ("import hp_gym.agents.policies", "benchmark"),
        ("import hp_gym.agents.controllers", "benchmark"),
        ("import hp_gym.agents.training.train", "train"),
        ("import hp_gym.agents.recording", "data"),
        ("import hp_gym.studies.benchmark.request", "benchmark"),
        ("import hp_gym.studies.calibration.fit", "studies"),
        ("import hp_gym.studies.tuning.search", "studies"),
        ("import hp_gym.studies.reproduction.figures", "plot"),
    ],
)
def test_a_part_without_its_extra_raises_an_error_that_names_it(
    code: str, extra: str, tmp_path: Path
) -> None:
    caught = (
        "import gymnasium as gym, hp_gym; from hp_gym.extras import MissingExtraError\n"
        f"try:\n    exec({code!r})\n"
        "except MissingExtraError as error:\n    print(error.extra, error, sep='\\n')"
    )
    result = python(caught, ALL, tmp_path)
    assert result.returncode == 0, result.stderr
    name, message = result.stdout.splitlines()
    assert name == extra
    assert f'pip install "ev-heat-pump-gym[{extra}]"' in message


@pytest.mark.parametrize(
    ("names", "modules"),
    [
        (["benchmark"], ["cli.benchmark_command", "studies.benchmark.request", "studies.benchmark.table"]),
        (["data"], ["agents.recording", "cli.record_command"]),
        (["export"], ["agents.policies.equality", "agents.policies.onnx_file"]),
        (["plot"], ["pictures.plotting", "pictures.rendering", "studies.reproduction.figures"]),
        (["plot"], ["studies.replay.replay_plot"]),
        (
            ["studies"],
            ["studies.calibration.held_out", "studies.tuning.search", "studies.reproduction.figures"],
        ),
        (["studies"], ["studies.optimise.front_plot", "studies.calibration.calibrating"]),
        (["sweep"], ["studies.sweep.sweep_plots", "studies.sweep.sensitivities", "studies.sweep.sweeping"]),
        (["train"], ["agents.training.train", "agents.policies.from_sb3", "envs.sb3"]),
        (["export", "train"], ["agents.policies.sb3_zip", "agents.policies.equality"]),
    ],
    ids=str,
)
def test_an_extra_brings_all_that_its_part_imports(
    names: list[str], modules: list[str], tmp_path: Path
) -> None:
    if set(names) & {"train"}:
        # stable-baselines3 itself imports these.
        blocked = [package for package in without(*names) if package not in {"matplotlib", "pandas", "PIL"}]
    else:
        blocked = without(*names)
    code = "\n".join(f"import hp_gym.{module}" for module in modules)
    result = python(code, blocked, tmp_path)
    assert result.returncode == 0, result.stderr


def test_the_reference_policies_need_no_torch(tmp_path: Path) -> None:
    code = "from hp_gym.agents.controllers import resolve; print(len(resolve('ppo')))"
    result = python(code, without("benchmark"), tmp_path)
    assert result.returncode == 0, result.stderr
    assert int(result.stdout) > 0


def test_a_sweep_on_a_cluster_without_ray_says_how_to_get_it(tmp_path: Path) -> None:
    arguments = ["sweep", "--axis", "htc_set_point_degc=50,60", "--on", "ray", "--out", "sweep"]
    result = hp_gym_command(arguments, without("sweep"), tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert len(result.stderr.splitlines()) == 1, result.stderr
    assert 'pip install "ev-heat-pump-gym[ray]"' in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_another_missing_module_is_not_taken_for_an_extra() -> None:
    with pytest.raises(ModuleNotFoundError, match="no_such_module"), extras.needed("plot"):
        import no_such_module  # type: ignore[import-not-found]  # noqa: F401
