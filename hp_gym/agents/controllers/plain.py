"""Controllers that look at nothing: everything off, and anything at random."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hp_gym.agents.controllers.controller import Act, Controller

if TYPE_CHECKING:
    from hp_gym.envs.settings import Action
    from hp_gym.envs.vector_env import EVHeatPumpVectorEnv


def off() -> Controller:
    """Everything isolated and off; ambient air at the blower's lowest level, coolant at the lowest flows.

    It is what the reference trip of the attributable energy is, but with the temperatures that come of it. It
    moves every actuator, whatever the car has.
    """

    def begin(env: EVHeatPumpVectorEnv) -> Act:
        lowest = np.zeros((env.num_envs, len(env.action_names)), dtype=np.int64)
        return lambda _: lowest

    return Controller("off", begin, {"actions": "all"})


def random(seed: int) -> Controller:
    """The default actions of the car, each second all options equally likely."""

    def begin(env: EVHeatPumpVectorEnv) -> Act:
        generator = np.random.default_rng(seed)
        space: Any = env.single_action_space
        counts, shape = space.nvec, (env.num_envs, len(space.nvec))

        def act(_: object) -> Action:
            drawn: Action = generator.integers(counts, size=shape)
            return drawn

        return act

    return Controller("random", begin, seed=seed)
