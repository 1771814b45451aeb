"""Trips of a controller as a Minari data set, for learning without an environment."""

from __future__ import annotations

import platform
import re
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import gymnasium as gym
import numpy as np

import hp_gym
from hp_gym import extras, transactions
from hp_gym.envs import settings
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.messages import OneLineError
from hp_gym.registration import ENV_ID

with extras.needed("data"):
    from minari.data_collector.episode_buffer import EpisodeBuffer
    from minari.dataset.minari_storage import MinariStorage

    from hp_gym.agents.controllers import Controller, ControllerError, resolve

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator

    from numpy.typing import NDArray

AUTHOR: Final = "hp_gym contributors"
LICENSE: Final = "MIT"

AT_ONCE: Final = 16
"""Trips that are driven, and held in memory, together."""

_ID: Final = re.compile(r"(?:[A-Za-z0-9_-]+/)*[A-Za-z0-9_-]+-v[0-9]+")


class RecordingError(OneLineError):
    """What was asked for cannot be recorded."""


def package() -> str:
    """Returns name and version of the package that makes the data."""
    return f"{extras.DISTRIBUTION} {hp_gym.__version__}"


@dataclass(frozen=True)
class Request:
    """What is recorded, and what is told of it.

    Attributes:
        controller: Name, file or class, as `hp_gym.agents.controllers.resolve` finds it. Where it has several
            training seeds, they drive trips in turn.
        data_set: Id of the data set: `namespace/name-v0`.
        out: Folder of data sets: what Minari calls `MINARI_DATASETS_PATH`.
        episodes: Number of trips.
        distribution: Where trips are drawn from: name or path.
        seed: Trip k is that of `reset(seed=seed + k)`.
        seeds: Training seeds of the reference policies; all by default.
        info: What infos hold beside the parts of the reward; see `EVHeatPumpEnv`.
        allow_code: Whether zip files of stable-baselines3 are loaded.
        author: For the metadata, like the following.
        license: Of the data.
        code_link: Where the code is that made them.
        overrides: Changes for all trips, `key=value`.
    """

    controller: str
    data_set: str
    out: Path
    episodes: int = 100
    distribution: str = settings.DEFAULT_DISTRIBUTION
    seed: int = 0
    seeds: Collection[int] | None = None
    info: tuple[str, ...] = ("cost",)
    allow_code: bool = False
    author: str = AUTHOR
    license: str = LICENSE
    code_link: str = field(default_factory=package)
    overrides: tuple[str, ...] = ()


@dataclass(frozen=True)
class Recorded:
    """A data set that is written.

    Attributes:
        folder: Its folder in that of the data sets.
        episodes: Number of trips.
        steps: Number of steps.
        mean_return: Mean sum of the rewards of a trip, in points.
    """

    folder: Path
    episodes: int
    steps: int
    mean_return: float


def default_id(controller: str) -> str:
    """Returns an id for the data of a controller: its name, or that of its file or class."""
    name = Path(controller).stem if Path(controller).suffix else controller
    return f"evheatpump/{re.sub(r'[^A-Za-z0-9_-]+', '-', name)}-v0"


def record(request: Request, progress: Callable[[int], None] = lambda _: None) -> Recorded:
    """Drives trips and writes them, all or nothing; a data set of that id is replaced.

    Args:
        request: What to record.
        progress: Told of trips that are written.

    Raises:
        ControllerError: The controller is not there, cannot be used, or does not fit the environment.
        RecordingError: The id does not read `namespace/name-v0`.
        ConfigurationError: The distribution or an info is not known.
        OSError: The folder cannot be written to.
    """
    if not _ID.fullmatch(request.data_set):
        message = f"the id of the data set is `{request.data_set}`, but must read namespace/name-v0"
        raise RecordingError(message)
    drivers = _controllers(request, request.seed)
    environment = _environment(drivers[0], request)
    folder = request.out / request.data_set
    returns: list[float] = []
    with transactions.new_contents(folder) as staged:
        storage = MinariStorage.new(
            staged / "data", environment.observation_space, environment.action_space, environment.spec
        )
        for first in range(0, request.episodes, AT_ONCE):
            count = min(AT_ONCE, request.episodes - first)
            drivers = drivers if drivers[0].name != "random" else _controllers(request, request.seed + first)
            trips = list(_trips(drivers[(first // AT_ONCE) % len(drivers)], request, first, count))
            storage.update_episodes(trips)
            returns += [float(np.sum(trip.rewards)) for trip in trips]
            progress(count)
        storage.update_metadata(_metadata(request, drivers))
        steps = int(storage.total_steps)
    return Recorded(folder, request.episodes, steps, float(np.mean(returns)))


def _controllers(request: Request, seed: int) -> list[Controller]:
    found = resolve(request.controller, seed=seed, seeds=request.seeds, allow_code=request.allow_code)
    return [controller.with_overrides(request.overrides) for controller in found]


def _arguments(controller: Controller, request: Request) -> dict[str, Any]:
    return {**controller.environment, "distribution": request.distribution, "info": list(request.info)}


def _environment(controller: Controller, request: Request) -> gym.Env[Any, Any]:
    """The environment that a reader of the data set gets back."""
    return gym.make(ENV_ID, **_arguments(controller, request))


def _trips(controller: Controller, request: Request, first: int, count: int) -> Iterator[EpisodeBuffer]:
    """Drives trips together; one that has ended drives on unseen until all have."""
    envs = EVHeatPumpVectorEnv(count, **_arguments(controller, request))
    try:
        observations, infos = envs.reset(seed=[request.seed + first + place for place in range(count)])
        act = controller.begin(envs)
        seen, told, asked, paid = [observations], [_values(infos)], [], []
        lengths, arrived = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.bool_)
        while not lengths.all():
            actions: Any = np.array(act(observations))
            observations, rewards, terminated, truncated, infos = envs.step(actions)
            seen.append(observations)
            told.append(_values(infos))
            asked.append(actions)
            paid.append(rewards)
            over = (terminated | truncated) & (lengths == 0)
            lengths[over] = len(paid)
            arrived[over] = terminated[over]
    except (ValueError, TypeError) as error:
        raise ControllerError(f"controller `{controller.name}`: {error}") from error
    finally:
        envs.close()
    for place in range(count):
        steps = int(lengths[place])
        ends = np.arange(1, steps + 1) == steps
        yield EpisodeBuffer(
            id=first + place,
            seed=request.seed + first + place,
            observations=_column(seen[: steps + 1], place),
            actions=_column(asked[:steps], place),
            rewards=list(_column(paid[:steps], place)),
            terminations=list(ends & arrived[place]),
            truncations=list(ends & ~arrived[place]),
            infos={name: _column([info[name] for info in told[: steps + 1]], place) for name in told[0]},
        )


def _values(infos: dict[str, Any]) -> dict[str, NDArray[Any]]:
    """What infos hold at every step, without marks and ends."""
    return {name: values for name, values in infos.items() if f"_{name}" in infos and name[:6] != "final_"}


def _column(rows: list[NDArray[Any]], place: int) -> NDArray[Any]:
    return np.stack([row[place] for row in rows])


def _metadata(request: Request, drivers: list[Controller]) -> dict[str, Any]:
    """What is told of the data set, in Minari's terms and ours."""
    driver = drivers[0]
    return {
        "dataset_id": request.data_set,
        "minari_version": version("minari"),
        "author": {request.author},
        "license": request.license,
        "code_permalink": request.code_link,
        "algorithm_name": driver.name,
        "description": f"{request.episodes} trips of the distribution `{request.distribution}` driven by "
        f"`{request.controller}` in {ENV_ID}",
        "requirements": [f"{extras.DISTRIBUTION}=={hp_gym.__version__}"],
        "hp_gym_version": hp_gym.__version__,
        "python_version": platform.python_version(),
        "controller": request.controller,
        "controller_seeds": sorted({one.seed for one in drivers}),
        "distribution": request.distribution,
        "seed": request.seed,
        "overrides": list(request.overrides),
    }
