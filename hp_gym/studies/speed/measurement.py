"""All measurements in one run: round after round through all, so that a disturbance meets all alike."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Any

from rich.progress import Progress

from hp_gym.studies.speed import fastsim_step, processes, rates
from hp_gym.terminal import progress_console

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

THREADS = (1, 2)
"""Threads of the vector environment."""


@dataclass(frozen=True)
class Plan:
    """How much is measured.

    Attributes:
        repeats: Rounds through all measurements.
        seconds: Length of one measurement of an environment.
        environments: Sizes of vector environments.
    """

    repeats: int
    seconds: float
    environments: tuple[int, ...]


FULL = Plan(repeats=5, seconds=0.3, environments=tuple(4**power for power in range(7)))
QUICK = Plan(repeats=1, seconds=0.05, environments=(1, 64, 1024))

SCALING_ENVIRONMENTS = 1024
"""Size of the vector environment whose threads are compared with processes."""


@dataclass(frozen=True)
class Measured:
    """Results of repeated measurements."""

    values: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median."""
        return median(self.values)

    @property
    def spread(self) -> tuple[float, float]:
        """Lowest and highest."""
        return min(self.values), max(self.values)


@dataclass(frozen=True)
class Speed:
    """Everything that was measured.

    Attributes:
        plant_step_us: Plant step with the HPCU, compressor on [us].
        plant_step_random_us: The same under random actions [us].
        single: One environment [steps/s].
        vector: By environments and threads [steps/s].
        cartpole_single: One CartPole-v1 [steps/s].
        cartpole_vector: Its own vector environment, by environments [steps/s].
        fastsim_step_us: A step of FASTSim [us], where it is installed.
        processes_gain: What two processes of pure computing gain over one.
        threads_gain: What two threads of the vector environment gain over one.
        thread_scaling: The second over the first, round by round.
        bytes_per_environment: Growth of the resident set an environment.
    """

    plant_step_us: Measured
    plant_step_random_us: Measured
    single: Measured
    vector: dict[int, dict[int, Measured]]
    cartpole_single: Measured
    cartpole_vector: dict[int, Measured]
    fastsim_step_us: Measured | None
    processes_gain: Measured
    threads_gain: Measured
    thread_scaling: Measured
    bytes_per_environment: float | None


def measure(plan: Plan, advance: Callable[[float], None] = lambda _: None) -> Speed:
    """Measures everything.

    Args:
        plan: How much.
        advance: Is told the share of the work [-] that was done.
    """
    seconds = plan.seconds
    compute_gain, end_processes = processes.pure_compute_gain(2 * seconds)
    functions: dict[Any, Callable[[], float]] = {
        "plant": lambda: rates.plant_step_us(random=False),
        "plant random": lambda: rates.plant_step_us(random=True),
        "single": rates.single(rates.OURS, seconds),
        "cartpole single": rates.single(rates.OTHERS, seconds),
    }
    for count in plan.environments:
        functions["cartpole", count] = rates.vector(rates.OTHERS, count, seconds)
        for threads in THREADS:
            functions[count, threads] = rates.vector(rates.OURS, count, seconds, threads=threads)
    alone, together = (
        rates.vector(rates.OURS, SCALING_ENVIRONMENTS, 2 * seconds, threads=threads) for threads in THREADS
    )
    functions |= {"processes": compute_gain, "one thread": alone, "two threads": together}
    if (fastsim := fastsim_step.measurement()) is not None:
        functions["fastsim"] = fastsim
    found: dict[Any, list[float]] = {name: [] for name in functions}
    try:
        for _ in range(plan.repeats):
            for name, function in functions.items():
                found[name].append(function())
                advance(1.0 / (len(functions) * plan.repeats))
    finally:
        end_processes()
    results = {name: Measured(tuple(values)) for name, values in found.items()}
    gains = [two / one for one, two in zip(found["one thread"], found["two threads"], strict=True)]
    shares = [gain / most for gain, most in zip(gains, found["processes"], strict=True)]
    return Speed(
        plant_step_us=results["plant"],
        plant_step_random_us=results["plant random"],
        single=results["single"],
        vector={n: {threads: results[n, threads] for threads in THREADS} for n in plan.environments},
        cartpole_single=results["cartpole single"],
        cartpole_vector={n: results["cartpole", n] for n in plan.environments},
        fastsim_step_us=results.get("fastsim"),
        processes_gain=results["processes"],
        threads_gain=Measured(tuple(gains)),
        thread_scaling=Measured(tuple(shares)),
        bytes_per_environment=processes.bytes_per_environment(),
    )


@contextmanager
def bar() -> Generator[Callable[[float], None]]:
    """A bar on standard error that is told shares of the work."""
    with Progress(console=progress_console, transient=True) as progress:
        task = progress.add_task("measuring", total=1.0)
        yield lambda share: progress.advance(task, share)
