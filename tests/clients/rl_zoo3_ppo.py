"""rl_zoo3: one command trains PPO with a file of hyperparameters, another plays what came out."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

FILE = """\
EVHeatPump-v0:
  n_timesteps: !!float 4000
  policy: 'MlpPolicy'
  n_envs: 4
  n_steps: 256
  batch_size: 256
"""

with tempfile.TemporaryDirectory() as folder:
    (Path(folder) / "evheatpump.yml").write_text(FILE, encoding="utf-8")
    common = "--algo ppo --env EVHeatPump-v0 --gym-packages hp_gym -f logs --num-threads 1"
    train = f"{common} --conf-file evheatpump.yml --eval-freq 2000 --eval-episodes 1 --n-eval-envs 1 --seed 0"
    play = f"{common} --no-render -n 500"
    for module, words in (("train", train), ("enjoy", play)):
        command = [sys.executable, "-m", f"rl_zoo3.{module}", *words.split()]
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        subprocess.run(command, cwd=folder, check=True, env=environment, timeout=600)
