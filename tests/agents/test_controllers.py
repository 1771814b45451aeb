"""Controllers by name, file and class."""

from pathlib import Path

import numpy as np
import pytest

import hp_gym
from hp_gym.agents.controllers import ControllerError, resolve
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.studies.benchmark.kpis import energies_kwh

MINE = """
import numpy as np

class Idle:
    environment = {"actions": ["ptc", "compressor_power"], "control_interval_s": 20}

    def predict(self, observations):
        return np.zeros((len(observations), 2), dtype=np.int64), None

class Broken:
    def __init__(self):
        raise RuntimeError("no licence")

class Empty:
    pass

class Odd:
    environment = 3

    def predict(self, observations):
        return None
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    name = "mine_" + tmp_path.name.replace("-", "_")
    (tmp_path / f"{name}.py").write_text(MINE, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return name


def driven(
    name: str, steps: int = 30, num_envs: int = 2, scenario: str = "ours/commute-minus5"
) -> EVHeatPumpVectorEnv:
    (controller,) = resolve(name)
    env = EVHeatPumpVectorEnv(num_envs, scenario=scenario, threads=1, **controller.environment)
    observations, _ = env.reset(seed=0)
    act = controller.begin(env)
    for _ in range(steps):
        observations, *_ = env.step(act(observations))
    return env


def test_off_takes_least_air_and_coolant_and_no_heat() -> None:
    now = driven("off").signals(0)
    assert now["compressor_power_w"] == now["ptc_power_w"] == now["condenser_heat_flow_w"] == 0.0
    assert now["blower_power_w"] < 20.0
    assert now["htc_flow_kg_s"] < 0.1
    rules = driven("hpcu").signals(0)
    assert now["blower_power_w"] < 0.2 * rules["blower_power_w"]


@pytest.mark.parametrize("vehicle", hp_gym.names("vehicle"))
def test_controllers_that_look_at_nothing_drive_any_car(vehicle: str) -> None:
    (off,) = resolve("off")
    env = EVHeatPumpVectorEnv(1, scenario="ours/commute-minus5", vehicle=vehicle, **off.environment)
    observations, _ = env.reset(seed=0)
    act = off.begin(env)
    for _ in range(60):
        env.step(act(observations))
    energies = energies_kwh(env.summary(0), env.layout(0))
    assert energies["compressor_energy_kwh"] == energies["ptc_energy_kwh"] == 0.0
    assert energies["blower_energy_kwh"] > 0.0
    assert (energies["pump_energy_kwh"] > 0.0) == bool(env.layout(0)["loops"])
    connections = [member["connection"] for member in env.layout(0)["members"] if member["connection"]]
    now = env.signals(0)
    assert all(now[connection] == 0.0 for connection in connections)
    (random,) = resolve("random")
    env = EVHeatPumpVectorEnv(1, scenario="ours/commute-minus5", vehicle=vehicle, **random.environment)
    observations, _ = env.reset(seed=0)
    act = random.begin(env)
    for _ in range(60):
        observations, *_ = env.step(act(observations))
    assert np.isfinite(observations).all()


def test_ptc_only_heats_the_cabin_and_nothing_else() -> None:
    totals = driven("ptc-only", steps=300).summary(0)
    assert totals["compressor_energy_kwh"] == totals["battery_htc_energy_kwh"] == 0.0
    assert totals["ptc_energy_kwh"] > totals["cabin_htc_energy_kwh"] > 0.1


def test_random_is_the_same_for_the_same_seed_and_differs_between_environments() -> None:
    one, again = driven("random"), driven("random")
    assert one.kpis(0) == again.kpis(0)
    assert one.kpis(0) != one.kpis(1)
    (other,) = resolve("random", seed=5)
    assert other.seed == 5


def test_a_class_drives_with_its_own_environment(module: str) -> None:
    (controller,) = resolve(f"{module}:Idle")
    assert controller.learned
    assert driven(f"{module}:Idle", steps=2).signals(0)["time_s"] == 40.0


def test_a_controller_file_is_a_controller(tmp_path: Path) -> None:
    path = tmp_path / "mild.toml"
    path.write_text('base = "hpcu"\ncabin_set_point_degc = 10.0\n', encoding="utf-8")
    (controller,) = resolve(str(path))
    assert controller.name == "mild"
    cool, warm = (driven(each, 1200, scenario="jeffs2019/case1-4").signals(0) for each in (str(path), "hpcu"))
    assert cool["cabin_temperature_degc"] < 12.0 < warm["cabin_temperature_degc"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("hpcuu", ["hpcuu", "off", "hpcu-tuned", "ppo", "module:Class"]),
        ("nowhere.safetensors", ["nowhere.safetensors", "no such file"]),
        ("nowhere.toml", ["nowhere.toml", "no such file"]),
        ("no_such_module:Class", ["no_such_module", "cannot import"]),
        ("json:Nobody", ["json", "no `Nobody`"]),
        (":Class", ["module:Class"]),
        ("MODULE:Broken", ["cannot be made", "RuntimeError", "no licence"]),
        ("MODULE:Empty", ["predict(observations)"]),
        ("MODULE:Odd", ["environment", "3", "dict"]),
    ],
)
def test_what_is_no_controller_is_told_in_one_line(name: str, words: list[str], module: str) -> None:
    with pytest.raises(ControllerError) as caught:
        resolve(name.replace("MODULE", module))
    message = str(caught.value)
    assert "\n" not in message
    assert all(word in message for word in words), message


def test_a_file_that_is_no_policy_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "junk.safetensors"
    path.write_bytes(b"not a policy")
    with pytest.raises(ControllerError, match=r"junk\.safetensors"):
        resolve(str(path))


def test_rules_act_in_full_resolution() -> None:
    env = driven("hpcu", steps=5)
    actions = env.rule_based_actions()
    assert actions.dtype == np.float32
    assert actions.shape == (2, 26)
