"""The vector environment: one call steps all, in native code on several threads."""

from __future__ import annotations

import logging
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, Unpack

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.envs import rewards, settings
from hp_gym.envs.env import EVHeatPumpEnv
from hp_gym.memory import shortage

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from hp_gym.envs.rewards import Reward
    from hp_gym.envs.settings import Action, Name, SharedKeywords
    from hp_gym.pictures.rendering import Renderer

_LEAST_BYTES: Final = 4096
"""What an environment takes at least, spaces and observations included (`hp-gym speed` measures it)."""

_THREADS_A_CORE: Final = 4

_LOG: Final = logging.getLogger(__name__)


class EVHeatPumpVectorEnv(VectorEnv[NDArray[np.float32], Any, NDArray[Any]]):
    """As many `EVHeatPump-v0` as asked for, with the same results as single ones with the same seeds.

    Args:
        num_envs: Number of environments.
        render_mode: `"rgb_array"` or None; `render()` returns a picture of each environment.
        max_episode_steps: Steps after which a trip is cut off; none by default, or for -1.
        autoreset_mode: `NEXT_STEP`, `SAME_STEP` or `DISABLED`, or its value.
        threads: Number of threads; as many as there are cores by default, at most one an environment and four
            a core. Results do not depend on it.
        scenario: One for all environments, or one for each.
        distribution: One for all environments, or one for each.
        vehicle: One for all environments, or one for each; rows are those of all of them together.
        render_size: Width and height of a picture.
        **chosen: The other settings of `EVHeatPumpEnv`.

    Attributes:
        finished: Trips that ended in the last step, each with its environment's `index`, its `end_reason`
            (None where it was cut off), `trip`, `kpis` and `summary`; none after a reset or a restored state.

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
        unlimited = max_episode_steps is None or max_episode_steps == -1
        limit = None if unlimited else _at_least_one("max_episode_steps", max_episode_steps)
        cores = os.cpu_count() or 1
        wanted = cores if threads is None else _at_least_one("threads", threads)
        # More than one an environment would have nothing to do, and many more than cores only wait.
        workers = min(wanted, self.num_envs, _THREADS_A_CORE * cores)
        if threads is not None and workers < wanted:
            _LOG.info("threads is %d, but %d are enough for %d environments", wanted, workers, self.num_envs)
        vehicles = [None if name is None else os.fspath(name) for name in self._each("vehicle", vehicle)]
        as_json = settings.to_json(**chosen)
        self._core = _core.Vector(as_json, *trips, vehicles, self.autoreset_mode.value, limit, workers)
        self._noisy = chosen.get("sensor_noise", 0.0) > 0.0
        reward = chosen.get("reward")
        self._reward: Reward | None = reward if callable(reward) else None
        self._told = settings.told(chosen)
        self.finished: list[_core.FinishedTrip] = []
        self._seeded = np.zeros(self.num_envs, dtype=np.bool_)
        self._last: NDArray[np.float32] | None = None
        self._render_size = render_size
        self._renderers: list[Renderer] = []
        settings.tell_of_narrow_rows(self._core)
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
        new = mask & ~self._seeded
        if new.any():
            fresh = self.np_random.integers(2**63, size=self.num_envs)
            seeds = [int(fresh[i]) if new[i] and seed is None else seed for i, seed in enumerate(seeds)]
        indices = np.flatnonzero(mask).tolist()
        self._core.reset(
            indices,
            [seeds[i] for i in indices],
            [trips[0][i] for i in indices],
            [trips[1][i] for i in indices],
        )
        self._seeded |= mask
        observations = self._observations(mask)
        self._keep(observations)
        self.finished = []
        return observations, self._infos_of_reset(mask)

    def step(
        self, actions: Action
    ) -> tuple[
        NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]
    ]:
        """Drives all environments on for one control interval.

        Raises:
            ValueError: The actions have the wrong shape or hold a value that is not allowed; no environment
                has moved then. Or the reward that was given as a function is not a finite number for each.
            TypeError: The actions are of the wrong type.
            ResetNeeded: A trip has not begun, or has ended and there is no automatic reset.
        """
        outcomes = self._core.step(actions)
        infos: dict[str, Any] = {}
        marks = np.ones((len(settings.PARTS), self.num_envs), dtype=np.bool_)
        for name, values, mark in zip(settings.PARTS, outcomes.parts, marks, strict=True):
            infos[name], infos[f"_{name}"] = values, mark
        if self._told:
            for name, values in self._extras(outcomes):
                infos[name], infos[f"_{name}"] = values, np.ones(self.num_envs, dtype=np.bool_)
        self.finished = outcomes.finished
        paid = outcomes.rewards if self._reward is None else self._rewards(self._reward, outcomes)
        for trip in self.finished:
            if trip.last_observation is not None:
                ending = {"final_obs": trip.last_observation.copy(), "final_info": self._last_info(trip)}
                infos = self._add_info(infos, ending, trip.index)
        self._keep(outcomes.observations)
        return outcomes.observations, paid, outcomes.terminated, outcomes.truncated, infos

    def _extras(self, outcomes: _core.Outcomes) -> Iterator[tuple[str, NDArray[Any]]]:
        """What infos hold beside the parts of the rewards."""
        if "cost" in self._told and outcomes.costs is not None:
            yield "cost", outcomes.costs
        if "action_mask" in self._told and outcomes.masks is not None:
            yield "action_mask", self._options(outcomes.masks.view(np.int8))
        if "terms" in self._told and outcomes.terms is not None:
            yield from zip(settings.TERMS, outcomes.terms, strict=True)

    def _options(self, masks: NDArray[Any]) -> NDArray[Any]:
        """Masks of the options of an action as this environment has them."""
        return masks

    def _last_info(self, trip: _core.FinishedTrip) -> dict[str, Any]:
        """Info of the last step of a trip."""
        info = dict(trip.info)
        if "terms" not in self._told:
            for name in settings.TERMS:
                info.pop(name, None)
        if "action_mask" in info:
            info["action_mask"] = self._options(info["action_mask"].copy())
        return info

    def _rewards(self, reward: Reward, outcomes: _core.Outcomes) -> NDArray[np.float64]:
        """What a function of named parts pays; nothing for the step that begins a trip."""
        assert outcomes.terms is not None
        parts = dict(zip(settings.PARTS, outcomes.parts.copy(), strict=True))
        parts |= zip(settings.TERMS, outcomes.terms.copy(), strict=True)
        # Where a trip was reset within the step, its last parts are told apart from the columns.
        for trip in outcomes.finished:
            for name, values in parts.items():
                values[trip.index] = trip.info[name]
        driven = np.ones(self.num_envs, dtype=np.bool_)
        driven[outcomes.reset] = False
        driven |= outcomes.terminated | outcomes.truncated
        paid = np.zeros(self.num_envs)
        if driven.all():
            paid[:] = rewards.many(reward, parts, self.num_envs)
        elif driven.any():
            of_driven = {name: values[driven] for name, values in parts.items()}
            paid[driven] = rewards.many(reward, of_driven, int(driven.sum()))
        return paid

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

    def decode(self, observations: NDArray[np.float32]) -> dict[str, NDArray[np.float64]]:
        """Returns observations in the units of their rows, by name: one value an environment.

        Raises:
            ValueError: They have the wrong shape.
        """
        return settings.decode(self._core, observations)

    def trip(self, index: int) -> dict[str, Any]:
        """Returns what the present trip of an environment is; see `EVHeatPumpEnv.trip`."""
        return self._core.trip(index)

    def end_reason(self, index: int) -> str | None:
        """Returns why the present trip of an environment is over; None while it is not.

        Of trips that `SAME_STEP` has reset within the step `finished` tells.
        """
        return self._core.end_reason(index)

    def clipped_shares(self, index: int) -> dict[str, float]:
        """Returns how often each row of an environment's observations was beyond its bounds on this trip."""
        return self._core.clipped_shares(index)

    def kpis(self, index: int) -> dict[str, float]:
        """Returns the KPIs of the present trip of an environment."""
        return self._core.kpis(index)

    def summary(self, index: int) -> dict[str, float]:
        """Returns the totals of the present trip of an environment; see `EVHeatPumpEnv.summary`.

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
        self._seeded[chosen] = True
        self._last = None
        self.finished = []

    def fork(self, indices: Sequence[int]) -> None:
        """Lets environment i go on from where environment `indices[i]` is now, for planners.

        Raises:
            ValueError: There is not one index for each environment, or one is out of range.
        """
        self._core.fork(list(indices))
        self._seeded = self._seeded[list(indices)]
        self._last = None
        self.finished = []

    def _observations(self, mask: NDArray[np.bool_]) -> NDArray[np.float32]:
        """Observations after a reset of the marked environments."""
        indices = np.flatnonzero(mask).tolist()
        others = np.flatnonzero(~mask).tolist()
        if not others:
            return self._core.observe(indices)
        # Noise is drawn once for each observation: those of the others stay as they were.
        observations = np.empty(self.observation_space.shape or (), dtype=np.float32)
        observations[others] = (
            self._last[others]
            if self._noisy and self._last is not None
            else self._core.observe(others, again=True)
        )
        observations[indices] = self._core.observe(indices)
        return observations

    def _keep(self, observations: NDArray[np.float32]) -> None:
        if self._noisy:
            self._last = observations.copy()

    def _infos_of_reset(self, mask: NDArray[np.bool_]) -> dict[str, Any]:
        """Infos of a reset of the marked environments: nothing is paid yet."""
        names = settings.PARTS
        if "cost" in self._told:
            names = (*names, "cost")
        if "terms" in self._told:
            names = (*names, *settings.TERMS)
        infos: dict[str, Any] = {}
        for name in names:
            infos[name], infos[f"_{name}"] = np.zeros(self.num_envs), mask.copy()
        if "action_mask" in self._told:
            masks = self._options(self._core.masks().view(np.int8))
            masks[~mask] = 0
            infos["action_mask"], infos["_action_mask"] = masks, mask.copy()
        return infos

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
        if not isinstance(seed, Sequence | np.ndarray) or getattr(seed, "ndim", 1) == 0:
            first = settings.whole_seed(seed)
            super().reset(seed=first)
            return [settings.core_seed(first + i) for i in range(self.num_envs)]
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
        return {**self.__dict__, "_renderers": [], "finished": []}


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
