"""Draws the rule-based controller driving a scenario as an animated picture, some 30 s long.

uv run python scripts/make_video.py jeffs2019/case1-1 docs/images/hpcu.webp
"""

import argparse
from pathlib import Path
from typing import Final

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from hp_gym.envs.hpcu_policy import HpcuPolicy

FRAMES_PER_S: Final = 10
QUALITY: Final = 40


def frames(scenario: str, duration_s: float, size: tuple[int, int]) -> list[NDArray[np.uint8]]:
    """Returns pictures at even distances over the whole trip."""
    env = gym.make(
        "EVHeatPump-v0",
        scenario=scenario,
        continuous=True,
        actions=HpcuPolicy.ACTIONS,
        render_mode="rgb_array",
        render_size=size,
    )
    policy = HpcuPolicy(env)
    env.reset()
    every = max(1, round(env.get_wrapper_attr("trip")()["duration_s"] / (duration_s * FRAMES_PER_S)))
    pictures = [np.asarray(env.render())]
    second, over = 0, False
    while not over:
        _, _, over, _, _ = env.step(policy())
        second += 1
        if second % every == 0 or over:
            pictures.append(np.asarray(env.render()))
    env.close()
    return pictures


def main() -> None:
    """Reads the command line and writes the file."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenario", help="id or path of a scenario")
    parser.add_argument("path", type=Path, help="file to write (.webp or .gif)")
    parser.add_argument("--duration", type=float, default=30.0, help="length in seconds")
    parser.add_argument("--width", type=int, default=960, help="width in pixels")
    arguments = parser.parse_args()
    size = (arguments.width, arguments.width * 9 // 16)
    pictures = [Image.fromarray(one) for one in frames(arguments.scenario, arguments.duration, size)]
    pictures[0].save(
        arguments.path,
        save_all=True,
        append_images=pictures[1:],
        duration=round(1000 / FRAMES_PER_S),
        loop=0,
        quality=QUALITY,
        method=4,
    )
    kilobytes = arguments.path.stat().st_size // 1024
    print(f"{arguments.path}: {len(pictures)} pictures, {kilobytes} kB")


if __name__ == "__main__":
    main()
