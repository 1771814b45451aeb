"""Rows in Rust: a kind of component, a rule-based controller, a signal and a term of the reward.

They are added to a copy of the repository, which is built (some minutes the first time) and driven. What is
added stands in `examples/08_rows_in_rust/rows.toml`, nothing else is touched.

    python examples/08_rows_in_rust.py FOLDER
"""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ADDED = Path(__file__).with_suffix("")
COPIED = ("Cargo.toml", "Cargo.lock", ".cargo", "agents", "configs", "hp_gym", "rust_core")
LIBRARIES = ("lib_core.so", "lib_core.dylib", "_core.dll")

DRIVE = """
import sys
import gymnasium as gym
import hp_gym
from hp_gym import _core

car, controller = sys.argv[1:]
uses_it = {"scenario.strategy.converter": True}
run = hp_gym.simulate("ours/commute-minus5", controller, uses_it, vehicle=car)
print(run.end_reason, *[name for name in run.columns if "converter" in name])
print(f"converter cooled to {run['converter_temperature_degc'][-1]:.1f} degC by the rules")
print(f"pressure ratio up to {run['pressure_ratio'].max():.2f}")
print(f"ledger within {run.summary['worst_relative_residual']:.0e}")
env = gym.make("EVHeatPump-v0", vehicle=car, scenario="ours/commute-minus5",
               observations=["pressure_ratio"], reward={"compressor_per_kwh": 2.0}).unwrapped
print("actions:", *env.action_names)
env.reset(seed=0)
for _ in range(300):
    observation, reward, _, _, info = env.step(env.rule_based_action())
print(f"observed {observation[0]:.3f}, reward_compressor {info['reward_compressor']:.2e}")
print(f"compressor_energy_kwh {env.kpis()['compressor_energy_kwh']:.4f}")
"""


def copy(folder: Path) -> None:
    """Copies what is needed, with the additions."""
    leave_out = shutil.ignore_patterns("__pycache__", "_core*")
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=leave_out, dirs_exist_ok=True)
        elif source.exists():
            shutil.copy2(source, folder / name)
    shutil.copy2(ROOT / "hp_gym" / "_core.pyi", folder / "hp_gym")
    rows = tomllib.loads((ADDED / "rows.toml").read_text(encoding="utf-8"))
    for file in rows["file"]:
        shutil.copy2(ADDED / file["from"], folder / file["to"])
    for row in rows["row"]:
        path = folder / row["file"]
        text = path.read_text(encoding="utf-8")
        anchor = row["behind"] + "\n"
        if text.count(anchor) != 1:
            sys.exit(
                f"{row['file']} has {text.count(anchor)} lines `{row['behind'].strip()}`, but must have one"
            )
        path.write_text(text.replace(anchor, anchor + row["row"].strip("\n") + "\n"), encoding="utf-8")


def build(folder: Path) -> None:
    """Compiles the extension and puts it into the package; dependencies are kept for the next time."""
    target = ROOT / "target" / "examples-rows"
    settings = {**os.environ, "PYO3_BUILD_EXTENSION_MODULE": "1", "CARGO_TARGET_DIR": str(target)}
    subprocess.run(
        ["cargo", "build", "-q", "--release", "-p", "hp_bindings"], cwd=folder, env=settings, check=True
    )
    built = next(path for name in LIBRARIES if (path := target / "release" / name).exists())
    suffix = ".pyd" if built.suffix == ".dll" else ".abi3.so"
    shutil.copy2(built, folder / "hp_gym" / f"_core{suffix}")


def main(folder: Path) -> None:
    """Adds, builds, drives."""
    copy(folder)
    build(folder)
    arguments = [sys.executable, "-c", DRIVE, str(ADDED / "car.toml"), str(ADDED / "controller.toml")]
    subprocess.run(arguments, cwd=folder, env={**os.environ, "PYTHONPATH": str(folder)}, check=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python examples/08_rows_in_rust.py FOLDER")
    main(Path(sys.argv[1]))
