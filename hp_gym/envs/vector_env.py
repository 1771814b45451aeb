"""The vector environment: one call steps all, in native code on several threads."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Final, Unpack

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.envs import settings
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.memory import shortage

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from hp_gym.envs.settings import Action, Name, SharedKeywords
    from hp_gym.pictures.rendering import Renderer

_LEAST_BYTES: Final = 4096
"""What an environment takes at least, spaces and observations included (`hp-gym speed` measures it)."""

_THREADS_A_CORE: Final = 4

_PARTS = tuple(_core.reward_parts())
_PART_KEYS = tuple((name, f"_{name}") for name in _PARTS)


class EVHeatPumpVectorEnv(VectorEnv[NDArray[np.float32], Any, NDArray[Any]]):
    """As many `EVHeatPump-v0` as asked for, with the same results as single ones with the same seeds.

    Args:
        num_envs: Number of environments.
        render_mode: `"rgb_array"` or None; `render()` returns a picture of each environment.
        max_episode_steps: Steps after which a trip is cut off.
        autoreset_mode: `NEXT_STEP`, `SAME_STEP` or `DISABLED`, or its value.
        threads: Number of threads; as many as there are cores by default, at most one an environment and four
            a core. Results do not depend on it.
        scenario: One for all environments, or one for each.
        distribution: One for all environments, or one for each.
        vehicle: One for all environments, or one for each; rows are those of all of them together.
        render_size: Width and height of a picture.
        **chosen: The other settings of `EVHeatPumpEnv`.

    Raises:
        ConfigurationError: A name, key or value is not accepted; the message says what is.
        TypeError: There is no such argument, or it is of a type that cannot be read.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        scenario: Name | Sequence[Name | None] | None = None,
        distribution: Name | Sequence[Name | None] | None = None,
        vehicle: Name | Sequence[Name | None] | None = None,
        render_size: tuple[int, int] = (960, 540),
        **chosen: Unpack[SharedKeywords],
    ) -> None:
        self.num_envs = _at_least_one("num_envs", num_envs)
        # Before lists of that length are made.
        lacking = shortage(self.num_envs * _LEAST_BYTES)
        if lacking is not None:
            message = f"num_envs is {self.num_envs:,}, which {lacking}"
            raise _core.ConfigurationError(message)
        if render_mode not in {None, "rgb_array"}:
            message = f"render_mode is {render_mode!r}, but must be None or rgb_array"
            raise _core.ConfigurationError(message)
        self.render_mode = render_mode
        self.autoreset_mode = _mode(autoreset_mode)
        self.metadata = {
            "render_modes": ["rgb_array"],
            "render_fps": EVHeatPumpEnv.metadata["render_fps"],
            "autoreset_mode": self.autoreset_mode,
        }
        trips = self._trips(scenario, distribution, settings.DEFAULT_DISTRIBUTION)
        limit = None if max_episode_steps is None else _at_least_one("max_episode_steps", max_episode_steps)
        cores = os.cpu_count() or 1
        wanted = cores if threads is None else _at_least_one("threads", threads)
        # More than one an environment would have nothing to do, and many more than cores only wait.
        workers = min(wanted, self.num_envs, _THREADS_A_CORE * cores)
        vehicles = [None if name is None else os.fspath(name) for name in self._each("vehicle", vehicle)]
        as_json = settings.to_json(**chosen)
        self._core = _core.Vector(as_json, *trips, vehicles, self.autoreset_mode.value, limit, workers)
        self._noisy = chosen.get("sensor_noise", 0.0) > 0.0
        self._seeded = False
        self._last: NDArray[np.float32] | None = None
        self._render_size = render_size
        self._renderers: list[Renderer] = []
        self.option_names = settings.option_names(self._core)
        self.action_names = tuple(self.option_names)
        self.single_action_space = settings.action_space(self._core)
        self.single_observation_space = settings.observation_space(self._core)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins trips.

        Args:
            seed: Environment i gets `seed + i`, or the i-th of a list.
            options: `reset_mask` says which environments are reset (all by default); `scenario` and
                `distribution`, one for all or one for each, hold for these trips only.

        Raises:
            ConfigurationError: There is no such option, scenario or distribution.
            ValueError: Seeds or mask do not fit.
        """
        mask = self._mask(options)
        trips = self._trips(*settings.once(options, ["reset_mask"]), None)
        seeds = self._seeds(seed)
        if not self._seeded:
            fresh = self.np_random.integers(2**63, size=self.num_envs)
            seeds = [int(fresh[i]) if given is None else given for i, given in enumerate(seeds)]
        self._seeded = True
        indices = np.flatnonzero(mask).tolist()
        told = self._core.reset(
            indices,
            [seeds[i] for i in indices],
            [trips[0][i] for i in indices],
            [trips[1][i] for i in indices],
        )
        infos: dict[str, Any] = {}
        self._tell(infos, indices, told)
        observations = self._observations(indices)
        self._keep(observations)
        return observations, infos

    def step(
        self, actions: Action
    ) -> tuple[
        NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]
    ]:
        """Drives all environments on for one control interval.

        Raises:
            ValueError: The actions have the wrong shape or hold a value that is not allowed; no environment
                has moved then.
            TypeError: The actions are of the wrong type.
            ResetNeeded: A trip has not begun, or has ended and there is no automatic reset.
        """
        outcomes = self._core.step(actions)
        reset = outcomes.reset
        infos: dict[str, Any] = {}
        if len(reset) < self.num_envs:
            stepped = np.ones((len(_PARTS), self.num_envs), dtype=np.bool_)
            if reset:
                stepped[:, reset] = False
            parts = outcomes.parts
            for row, (name, present) in enumerate(_PART_KEYS):
                infos[name] = parts[row]
                infos[present] = stepped[row]
        for trip in outcomes.finished:
            if trip.last_observation is not None:
                ending = {"final_obs": trip.last_observation, "final_info": trip.info}
            else:
                ending = {key: value for key, value in trip.info.items() if key not in _PARTS}
            infos = self._add_info(infos, ending, trip.index)
        if reset:
            self._tell(infos, reset, outcomes.trips)
        self._keep(outcomes.observations)
        return outcomes.observations, outcomes.rewards, outcomes.terminated, outcomes.truncated, infos

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Returns a picture of each environment if `render_mode` is `rgb_array`."""
        if self.render_mode is None:
            return None
        if not self._renderers:
            from hp_gym.pictures.rendering import Renderer

            self._renderers = [Renderer(*self._render_size) for _ in range(self.num_envs)]
        return tuple(
            renderer.render(self.signals(index), self._core.speeds_m_s(index), layout=self.layout(index))
            for index, renderer in enumerate(self._renderers)
        )

    def close_extras(self, **_: Any) -> None:
        """Ends all environments."""
        self._core.close()

    def action_masks(self) -> NDArray[np.bool_]:
        """Marks the options that the plant would grant in the coming second, one row an environment."""
        return self._core.action_masks()

    def rule_based_actions(self) -> Action:
        """Returns what the rule-based controllers would do next, one row an environment.

        Their memories move on once a step, however often they are asked.
        """
        return self._core.rule_based_actions()

    def signals(self, index: int) -> dict[str, float]:
        """Returns the present value of every signal of an environment by name."""
        return dict(zip(self._core.signal_names(index), self._core.look(index).tolist(), strict=True))

    def layout(self, index: int) -> dict[str, Any]:
        """Returns what the vehicle of an environment's trip is made of."""
        return self._core.layout(index)

    def kpis(self, index: int) -> dict[str, float]:
        """Returns the KPIs of the present trip of an environment."""
        return self._core.kpis(index)

    def summary(self, index: int) -> dict[str, float]:
        """Returns the totals of the present trip of an environment, those that `hp_gym.simulate` gives.

        They last until that environment is reset, which `SAME_STEP` does within the step that ends a trip.
        """
        return self._core.summary(index)

    def get_state(self, indices: Iterable[int] | None = None) -> list[bytes]:
        """Returns the states of environments, all by default."""
        chosen = range(self.num_envs) if indices is None else indices
        return [self._core.get_state(index) for index in chosen]

    def set_state(self, states: Sequence[bytes], indices: Sequence[int] | None = None) -> None:
        """Lets environments, all by default, go on from states that `get_state` returned.

        Raises:
            StateError: A state is not that of such an environment; nothing has changed then.
            ValueError: There are not as many states as environments.
        """
        chosen = list(range(self.num_envs) if indices is None else indices)
        if len(chosen) != len(states):
            message = f"states has {len(states)} entries, but must have {len(chosen)}"
            raise ValueError(message)
        self._core.set_states(chosen, list(states))
        self._seeded = True

    def fork(self, indices: Sequence[int]) -> None:
        """Lets environment i go on from where environment `indices[i]` is now, for planners.

        Raises:
            ValueError: There is not one index for each environment, or one is out of range.
        """
        self._core.fork(list(indices))

    def _observations(self, indices: list[int]) -> NDArray[np.float32]:
        if self._last is None or not self._noisy:
            return self._core.observe(list(range(self.num_envs)))
        # Noise is drawn once for each observation: those of the others stay as they were.
        observations = self._last.copy()
        observations[indices] = self._core.observe(indices)
        return observations

    def _keep(self, observations: NDArray[np.float32]) -> None:
        if self._noisy:
            self._last = observations

    def _tell(self, infos: dict[str, Any], indices: list[int], told: dict[str, Any]) -> None:
        """Adds what is told of trips to the infos, in the form that Gymnasium gives them."""
        for name, values in told.items():
            if isinstance(values, np.ndarray):
                infos[name] = np.zeros(self.num_envs, values.dtype)
            else:
                infos[name] = np.full(self.num_envs, None, dtype=object)
            infos[f"_{name}"] = np.zeros(self.num_envs, np.bool_)
            infos[name][indices], infos[f"_{name}"][indices] = values, True

    def _mask(self, options: dict[str, Any] | None) -> NDArray[np.bool_]:
        mask = (options or {}).get("reset_mask")
        if mask is None:
            return np.ones(self.num_envs, dtype=np.bool_)
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
            message = f"options['reset_mask'] is {mask!r}, but must be an array of bool"
            raise TypeError(message)
        if mask.shape != (self.num_envs,):
            message = f"options['reset_mask'] has the shape {mask.shape}, but must have ({self.num_envs},)"
            raise ValueError(message)
        if not mask.any():
            message = "options['reset_mask'] is all False, but must name at least one environment"
            raise ValueError(message)
        return mask

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer):
            super().reset(seed=int(seed))
            return [settings.core_seed(int(seed) + i) for i in range(self.num_envs)]
        if len(seed) != self.num_envs:
            message = f"seed has {len(seed)} entries, but must have {self.num_envs}"
            raise ValueError(message)
        return [None if each is None else settings.core_seed(each) for each in seed]

    def _trips(
        self,
        scenario: Name | Sequence[Name | None] | None,
        distribution: Name | Sequence[Name | None] | None,
        default: str | None,
    ) -> tuple[list[str | None], list[str | None]]:
        names: list[list[str | None]] = [[], []]
        for one, other in zip(
            self._each("scenario", scenario), self._each("distribution", distribution), strict=True
        ):
            trip = settings.source(one, other)
            names[0].append(trip[0])
            names[1].append(default if trip == (None, None) else trip[1])
        return names[0], names[1]

    def _each(self, what: str, names: Name | Sequence[Name | None] | None) -> Sequence[Name | None]:
        if names is None or isinstance(names, str | os.PathLike):
            return [names] * self.num_envs
        if len(names) != self.num_envs:
            message = f"{what} has {len(names)} entries, but must have {self.num_envs}"
            raise ValueError(message)
        return names

    def __getstate__(self) -> dict[str, Any]:
        """What a copy needs."""
        return {**self.__dict__, "_renderers": []}


def _at_least_one(what: str, value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 1:
        message = f"{what} is {value!r}, but must be a whole number of at least 1"
        raise _core.ConfigurationError(message)
    return int(value)


def _mode(mode: AutoresetMode | str) -> AutoresetMode:
    try:
        return AutoresetMode(mode)
    except ValueError:
        allowed = ", ".join(member.value for member in AutoresetMode)
        message = f"autoreset_mode is {mode!r}, but must be one of {allowed}"
        raise _core.ConfigurationError(message) from None
