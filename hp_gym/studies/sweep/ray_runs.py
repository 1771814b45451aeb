"""Chunks of runs on a Ray cluster, which drives them again where a node is lost."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

from hp_gym import extras
from hp_gym.build_identity import build
from hp_gym.studies.planned_runs import Planned, Totals, drive_on_same
from hp_gym.studies.sweep.sweep_plan import SweepError

with extras.needed("ray"):
    import ray

_WAITING: Final = 4
"""Chunks under way for each processor of the cluster."""


class OnRay:
    """Drives chunks on the cluster that Ray is connected to, or `RAY_ADDRESS` names, or else on this machine.

    Args:
        substeps: Steps of the plant in each second.
    """

    def __init__(self, substeps: int) -> None:
        self._substeps = substeps
        if not ray.is_initialized():
            ray.init(log_to_driver=False, configure_logging=False, include_dashboard=False)

    def drive(self, chunks: Iterable[tuple[int, Sequence[Planned]]]) -> Iterator[tuple[int, Totals]]:
        """Yields chunks with their totals as they come.

        Raises:
            SweepError: A worker has another build, or the cluster is lost.
        """
        remote = ray.remote(num_cpus=1, max_retries=-1)(drive_on_same)
        waiting: dict[Any, int] = {}
        left = iter(chunks)
        resources: dict[str, float] = ray.cluster_resources()  # type: ignore[no-untyped-call, unused-ignore]
        most = _WAITING * max(int(resources.get("CPU", 1)), 1)
        try:
            while True:
                while len(waiting) < most and (chunk := next(left, None)) is not None:
                    number, runs = chunk
                    waiting[remote.remote(_by_whole_path(runs), self._substeps, build())] = number
                if not waiting:
                    return
                done, _ = ray.wait(list(waiting), num_returns=1)
                for reference in done:
                    found, totals = ray.get(reference)
                    if totals is None:
                        message = (
                            f"a worker of the cluster has hp_gym {found}, this process has {build()}: "
                            "results of two builds are not mixed; install the same on all nodes"
                        )
                        raise SweepError(message)
                    yield waiting.pop(reference), totals
        except ray.exceptions.RayError as error:
            raise SweepError(f"Ray: {error}") from error
        finally:
            for reference in waiting:
                ray.cancel(reference)


def _by_whole_path(runs: Sequence[Planned]) -> list[Planned]:
    """Runs that name files by their whole paths, as workers have folders of their own."""
    known: dict[str | None, str | None] = {}

    def whole(name: str | None) -> str | None:
        if name not in known:
            is_file = name is not None and bool(Path(name).suffix) and Path(name).is_file()
            known[name] = str(Path(name).resolve()) if is_file and name is not None else name
        return known[name]

    return [(whole(run[0]) or run[0], whole(run[1]), whole(run[2]), run[3]) for run in runs]
