"""What was measured, as JSON and as tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.table import Table

if TYPE_CHECKING:
    from hp_gym.studies.speed.measurement import Measured, Speed

_REAL_TIME_US = 1e6
"""A step is a second."""


def to_json(speed: Speed) -> dict[str, Any]:
    """Returns medians by name, and lowest and highest values under `spread`."""
    told: dict[str, Any] = {
        "plant_step_us": speed.plant_step_us,
        "plant_step_random_us": speed.plant_step_random_us,
        "single_env_steps_per_s": speed.single,
        "vector_steps_per_s": {
            str(count): {str(threads): rate for threads, rate in by_threads.items()}
            for count, by_threads in speed.vector.items()
        },
        "cartpole_single_steps_per_s": speed.cartpole_single,
        "cartpole_vector_steps_per_s": {str(count): rate for count, rate in speed.cartpole_vector.items()},
        "fastsim_step_us": speed.fastsim_step_us,
        "thread_scaling": {
            "two_processes_gain": speed.processes_gain,
            "two_threads_gain": speed.threads_gain,
            "share_of_processes": speed.thread_scaling,
        },
    }
    medians: dict[str, Any] = {name: _each(value, lambda one: one.median) for name, value in told.items()}
    medians["bytes_per_environment"] = speed.bytes_per_environment
    medians["spread"] = {name: _each(value, lambda one: list(one.spread)) for name, value in told.items()}
    return medians


def single_table(speed: Speed) -> Table:
    """Returns one plant, one environment, and others beside them."""
    table = _table("", "Median", "Lowest to highest", "Beside it")
    plant_us = speed.plant_step_us.median
    for name, step in (
        ("Plant step with the HPCU, compressor on", speed.plant_step_us),
        ("Plant step under random actions, compressor on", speed.plant_step_random_us),
    ):
        table.add_row(
            name,
            f"{step.median:.2f} us",
            _range(step, ".2f", "us"),
            f"{_REAL_TIME_US / step.median:,.0f} times real time",
        )
    if speed.fastsim_step_us is None:
        table.add_row("FASTSim 3", "not installed", "", "uv run --extra speed")
    else:
        step = speed.fastsim_step_us
        ratio = f"plant step {step.median / plant_us:.1f} times as fast"
        table.add_row(
            "FASTSim 3, same cycle, cold soak", f"{step.median:.1f} us", _range(step, ".1f", "us"), ratio
        )
    table.add_row(
        "EVHeatPump-v0 through gym.make",
        f"{speed.single.median:,.0f} steps/s",
        _range(speed.single, ",.0f", "steps/s"),
        f"{speed.single.median / speed.cartpole_single.median:.2f} of CartPole-v1",
    )
    table.add_row(
        "CartPole-v1 through gym.make",
        f"{speed.cartpole_single.median:,.0f} steps/s",
        _range(speed.cartpole_single, ",.0f", "steps/s"),
        "",
    )
    return table


def vector_table(speed: Speed) -> Table:
    """Returns rates of vector environments by their size."""
    threads = list(next(iter(speed.vector.values())))
    heads = [f"{count} thread{'s' if count > 1 else ''} [steps/s]" for count in threads]
    table = _table("Environments", *heads, "CartPole-v1 [steps/s]", "Ratio", "Cost of one, 1 thread")
    for count, rates in speed.vector.items():
        other = speed.cartpole_vector[count]
        best = max(rate.median for rate in rates.values())
        table.add_row(
            f"{count:,}",
            *(_with_spread(rates[number]) for number in threads),
            _with_spread(other),
            f"{best / other.median:.2f}",
            f"{_REAL_TIME_US / rates[threads[0]].median:.2f} us",
        )
    return table


def remarks(speed: Speed) -> list[str]:
    """Returns scaling and memory in a sentence each."""
    scaling = (
        f"Two threads gain {speed.threads_gain.median:.2f} over one, two processes of pure computing "
        f"{speed.processes_gain.median:.2f} over one: a share of {speed.thread_scaling.median:.2f} "
        f"({_range(speed.thread_scaling, '.2f', '')})."
    )
    lines = [scaling]
    if speed.bytes_per_environment is not None:
        lines.append(f"An environment takes {speed.bytes_per_environment:,.0f} bytes.")
    return lines


def _each(value: Any, read: Any) -> Any:
    if value is None:
        return None
    return {key: _each(one, read) for key, one in value.items()} if isinstance(value, dict) else read(value)


def _table(*heads: str) -> Table:
    table = Table(box=None, header_style="bold", pad_edge=False)
    for place, head in enumerate(heads):
        table.add_column(head, justify="left" if place == 0 else "right", no_wrap=place == 0)
    return table


def _range(measured: Measured, form: str, unit: str) -> str:
    lowest, highest = measured.spread
    return f"{lowest:{form}} to {highest:{form}} {unit}".strip()


def _with_spread(rate: Measured) -> str:
    lowest, highest = rate.spread
    return f"{rate.median:,.0f} ± {50.0 * (highest - lowest) / rate.median:.0f} %"
