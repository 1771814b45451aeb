"""What needs processes of its own: scaling over two cores and memory."""

from __future__ import annotations

import ctypes
import gc
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Final

import gymnasium as gym
import numpy as np

from hp_gym import _core

if TYPE_CHECKING:
    from collections.abc import Callable

FEW: Final = 1024
MANY: Final = 16384


def pure_compute_gain(seconds: float) -> tuple[Callable[[], float], Callable[[], None]]:
    """Returns a measurement of what two processes compute relative to one, and what ends the processes.

    They drive a scenario over and over and share nothing.
    """
    pool = ProcessPoolExecutor(2, mp_context=get_context("spawn"))

    def rate(processes: int) -> float:
        futures = [pool.submit(_trips_per_s, seconds) for _ in range(processes)]
        return sum(future.result() for future in futures)

    def measure() -> float:
        alone = rate(1)
        return rate(2) / alone

    rate(2)
    return measure, pool.shutdown


def bytes_per_environment() -> float | None:
    """Returns by how much an environment of a vector environment lets the resident set grow [bytes].

    Gymnasium's batched spaces count; what all share, and what the allocator keeps for later, does not. None
    where the system does not tell.
    """
    if not sys.platform.startswith("linux"):
        return None
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(_growth).result()


def _trips_per_s(seconds: float) -> float:
    trips, start_s = 0, perf_counter()
    while (passed_s := perf_counter() - start_s) < seconds:
        _core.plant_step_seconds("jeffs2019/case1-4")
        trips += 1
    return trips / passed_s


def _growth() -> float:
    few, kept = _resident_bytes(FEW)
    many, also_kept = _resident_bytes(MANY)
    del kept, also_kept
    return (many - few) / MANY


def _resident_bytes(environments: int) -> tuple[int, object]:
    envs = gym.make_vec("EVHeatPump-v0", num_envs=environments, threads=1)
    envs.reset(seed=0)
    for _ in range(3):
        envs.step(np.zeros(envs.action_space.shape or (), dtype=np.int64))
    gc.collect()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE"), envs
