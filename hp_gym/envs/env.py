"""The single environment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Unpack

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from hp_gym import _core
from hp_gym.envs import rewards, settings

if TYPE_CHECKING:
    from hp_gym.envs.rewards import Reward
    from hp_gym.envs.settings import Action, Keywords, Name
    from hp_gym.pictures.rendering import Renderer
    from hp_gym.pictures.window import Window


class EVHeatPumpEnv(gym.Env[NDArray[np.float32], Any]):
    """The thermal system of an electric vehicle, driven from start to arrival.

    ## Description

    An electric vehicle after Jeffs et al. 2019 drives a cycle second by second. A refrigerant loop moves heat
    between two coolant loops, the chiller (cold) and the high temperature circuit (HTC, hot). The agent
    decides which components are connected to which loop, how hard the compressor works, whether the PTC
    heater may help, and how much air of which kind the cabin gets. It is paid for a comfortable cabin without
    fog and stale air, and for little energy.

    The plant protects itself whatever the agent asks: a connection is only granted while there is a
    temperature difference in the right direction, and pressure, coolant temperatures, compressor envelope,
    battery power and frost on the front-end exchanger have limits of their own. `previous_...` observations
    show what was asked, `..._on_htc` and `..._on_chiller` what was granted.

    ## Action Space

    `MultiDiscrete([3 2 2 3 3 3 2 11 11 11 11])`:

    | Num | Action           | Options                         |
    |-----|------------------|---------------------------------|
    | 0   | battery          | isolated, htc, chiller          |
    | 1   | motor            | isolated, chiller               |
    | 2   | transmission     | isolated, chiller               |
    | 3   | ambient          | isolated, chiller, htc          |
    | 4   | thermal_battery  | isolated, htc, chiller          |
    | 5   | cabin            | isolated, htc, chiller          |
    | 6   | ptc              | off, allowed                    |
    | 7   | compressor_power | off, 10 levels                  |
    | 8   | recirculation    | 11 levels                       |
    | 9   | blower_level     | 11 levels                       |
    | 10  | windscreen_share | 11 levels                       |

    The levels of the compressor run evenly in the logarithm from its lowest to its full power, those of the
    air evenly from none to all: share of recirculated air, blower, share blown at the windscreen. An action
    is held for `control_interval_s`, 1 s by default; the reference policies decide every 10 s. Other ids have
    other spaces for the same plant:

    - `EVHeatPumpContinuous-v0`: a `Box` in [-1, 1] with the same rows. Options are equal parts of the range,
      the compressor is off below -0.9; values beyond are held at its ends.
    - `EVHeatPumpFlat-v0`: `Discrete`, one choice among modes (`hp_gym.envs.modes.MODES`, or `modes=`).
    - `EVHeatPumpMO-v0`: as the default, its reward a vector.
    - `EVHeatPump/train-v2`, `EVHeatPump/test-v1`, ...: as the default, on the trips of one distribution.

    Other rows of the actuator table (`hp_gym.command.ACTUATORS`: coolant flows, requested heat flows, valves,
    set point of the PTC) can be added by name; as levels they have 11. A row that the agent does not control
    does what scenario and rule-based controller give it; `actions="heat"` leaves them the air.

    `action_masks()` marks the options that the plant would grant in the coming second, flat, as MaskablePPO
    of sb3-contrib expects.

    ## Observation Space

    A `Box` in [-1, 1] of float32. Low is shown as -1, high as 1; values beyond are held there.

    | Num | Observation                     | Unit | Low     | High   |
    |-----|---------------------------------|------|---------|--------|
    | 0   | time_s                          | s    | 0       | 7200   |
    | 1   | speed_m_s                       | m/s  | 0       | 50     |
    | 2   | traction_power_w                | W    | -200000 | 200000 |
    | 3   | ambient_temperature_degc        | degC | -40     | 50     |
    | 4   | cabin_temperature_degc          | degC | -40     | 80     |
    | 5   | ambient_humidity_ratio          | kg/kg | 0       | 0.04   |
    | 6   | cabin_humidity_ratio            | kg/kg | 0       | 0.04   |
    | 7   | cabin_co2_ppm                   | ppm  | 400     | 5000   |
    | 8   | windscreen_fog_margin_k         | K    | -40     | 60     |
    | 9   | battery_temperature_degc        | degC | -40     | 60     |
    | 10  | motor_temperature_degc          | degC | -40     | 120    |
    | 11  | transmission_temperature_degc   | degC | -40     | 120    |
    | 12  | thermal_battery_temperature_degc | degC | -40     | 100    |
    | 13  | htc_supply_temperature_degc     | degC | -40     | 100    |
    | 14  | htc_return_temperature_degc     | degC | -40     | 100    |
    | 15  | chiller_supply_temperature_degc | degC | -40     | 60     |
    | 16  | chiller_return_temperature_degc | degC | -40     | 60     |
    | 17  | htc_flow_kg_s                   | kg/s | 0       | 0.5    |
    | 18  | chiller_flow_kg_s               | kg/s | 0       | 0.5    |
    | 19  | condensing_pressure_bar         | bar  | 0       | 32     |
    | 20  | evaporating_pressure_bar        | bar  | 0       | 16     |
    | 21  | discharge_temperature_degc      | degC | -40     | 160    |
    | 22  | compressor_speed_rev_s          | rev/s | 0       | 150    |
    | 23  | soc                             | -    | 0       | 1      |
    | 24  | battery_charge_limit_w          | W    | 0       | 150000 |
    | 25  | battery_discharge_limit_w       | W    | 0       | 250000 |
    | 26  | battery_power_w                 | W    | -200000 | 200000 |
    | 27  | compressor_power_w              | W    | 0       | 8000   |
    | 28  | ptc_power_w                     | W    | 0       | 8000   |
    | 29  | auxiliary_power_w               | W    | 0       | 2000   |
    | 30  | condenser_heat_flow_w           | W    | 0       | 20000  |
    | 31  | evaporator_heat_flow_w          | W    | 0       | 20000  |
    | 32  | cabin_htc_heat_flow_w           | W    | -10000  | 10000  |
    | 33  | cabin_chiller_heat_flow_w       | W    | -10000  | 10000  |
    | 34  | battery_htc_heat_flow_w         | W    | -10000  | 10000  |
    | 35  | battery_chiller_heat_flow_w     | W    | -10000  | 10000  |
    | 36  | ambient_htc_heat_flow_w         | W    | -30000  | 30000  |
    | 37  | ambient_chiller_heat_flow_w     | W    | -30000  | 30000  |
    | 38  | motor_chiller_heat_flow_w       | W    | -10000  | 10000  |
    | 39  | transmission_chiller_heat_flow_w | W    | -10000  | 10000  |
    | 40  | solar_gain_w                    | W    | 0       | 1500   |
    | 41  | occupants                       | -    | 0       | 5      |
    | 42  | cabin_on_htc                    | -    | 0       | 1      |
    | 43  | battery_on_htc                  | -    | 0       | 1      |
    | 44  | ambient_on_htc                  | -    | 0       | 1      |
    | 45  | motor_on_chiller                | -    | 0       | 1      |
    | 46  | transmission_on_chiller         | -    | 0       | 1      |
    | 47  | battery_on_chiller              | -    | 0       | 1      |
    | 48  | ambient_on_chiller              | -    | 0       | 1      |
    | 49  | cabin_on_chiller                | -    | 0       | 1      |
    | 50  | thermal_battery_on_htc          | -    | 0       | 1      |
    | 51  | thermal_battery_on_chiller      | -    | 0       | 1      |
    | 52  | previous_battery                | -    | -1      | 1      |
    | 53  | previous_motor                  | -    | -1      | 1      |
    | 54  | previous_transmission           | -    | -1      | 1      |
    | 55  | previous_ambient                | -    | -1      | 1      |
    | 56  | previous_thermal_battery        | -    | -1      | 1      |
    | 57  | previous_cabin                  | -    | -1      | 1      |
    | 58  | previous_ptc                    | -    | -1      | 1      |
    | 59  | previous_compressor_power       | -    | -1      | 1      |
    | 60  | previous_recirculation          | -    | -1      | 1      |
    | 61  | previous_blower_level           | -    | -1      | 1      |
    | 62  | previous_windscreen_share       | -    | -1      | 1      |

    Bounds hold for every built-in car with the default actions. `decode(observation)` gives plain units,
    `clipped_shares()` says how often a value was beyond its bounds.

    This is what a car without navigation can know, sensors for windscreen and air quality included. Further
    rows by name: `preview` (the speed 2 to 80 s ahead), `time_left_s`, `distance_behind_m`, and every other
    signal of the plant (`hp_gym._core.observation_table()`).

    ## Rewards

    In points, four parts that `info` tells apart; each is the same expression as the KPI of a benchmark:

    - `reward_energy`: minus 10 points for a kWh of attributable energy, the chemical energy drawn from the
      cells minus that of a reference trip (the same cycle with battery, motor and oil at 25 degC, without
      heating and cooling). Losses and lost recuperation of a cold battery count; the reference never depends
      on the agent.
    - `reward_discomfort`: minus 5 points for an hour at 1 K between cabin and 22 degC while somebody is in
      the car. There is no dead band.
    - `reward_heat_left`: at arrival, a credit for the heat stored since the start in cabin, battery (up to 20
      degC), coolant loops and thermal battery. 0 by default. In a climate hotter than 22 degC it is the heat
      that is gone from cabin, loops and thermal battery.
    - `reward_penalties`: 60 points for an hour of fog on the windscreen and 20 for an hour of fog 1 K deep,
      0.02 for an hour of 1 ppm of carbon dioxide above 1000, while somebody is in the car; 1000 points for an
      hour that a trip takes beyond its cycle, more than slower driving saves; 500 points for a trip that ends
      before arrival; optional prices for a battery outside its window and for stops of the compressor that a
      protection forced.

    `reward` chooses among `balanced`, `energy`, `comfort`, `stored-heat` and `durable`, a file, or single
    weights (`{"base": "balanced", "discomfort_per_k_h": 8.0}`). A Python function of named parts is a reward
    too (`hp_gym.envs.rewards.Reward`); in `EVHeatPumpMO-v0` the reward is the vector of the four parts.

    ## Info

    Numbers, the same keys at every reset and step: the four parts of the reward (0 at a reset). On request
    (`info=["cost", "action_mask", "terms"]`) also

    - `cost`, for agents that are held to a limit: K h between cabin and 22 degC while somebody is in the car,
      K h of the battery outside its window, and 1 for each stop of the compressor that a protection forced
      and for a trip that ends before arrival;
    - `action_mask`: `action_masks()` as int8;
    - the terms in physical units that reward and KPIs are counted from.

    What trip it is, why it ended, its KPIs and totals: `trip()`, `end_reason()`, `kpis()`, `summary()`.

    ## Starting State

    A car parked for long, everything at the same temperature except where the scenario says otherwise. Trips
    come from a scenario (always the same) or are drawn from a distribution: `train-v2` (-20 to 40 degC, city,
    mixed and motorway cycles, whole or in parts) by default, `test-v1` (other cycles, other climates) for a
    held-out test.

    ## Episode End

    1. Termination: arrival where the cycle's way ends, with the credit for heat left. `end_reason()` is
       `arrived`, `kpis()` are the KPIs of the trip. A car that cannot follow its cycle falls behind, drives
       the missing distance after it, and arrives late (`kpis()["delay_s"]`).
    2. Termination: `battery_empty`, the usable state of charge is 0.
    3. Termination: `immobile`, the car stood for 300 s although its driver wanted to move.
    4. Termination: `late`, the car had not arrived 900 s after the end of its cycle.

    The environment itself never truncates; `max_episode_steps` of `gymnasium.make` and `make_vec` does. Its
    registered value is that of the longest cycle there can be, which cuts no trip.

    ## Arguments

    ```python
    import gymnasium as gym
    import hp_gym

    env = gym.make("EVHeatPump-v0", scenario="jeffs2019/case1-1")
    ```

    | Argument             | Default      | Meaning                                                          |
    |----------------------|--------------|------------------------------------------------------------------|
    | `render_mode`        | `None`       | `"rgb_array"` or `"human"`                                       |
    | `scenario`           | `None`       | id or path of a scenario, always driven                          |
    | `distribution`       | `"train-v2"` | name or path of a distribution that trips are drawn from         |
    | `render_size`        | `(960, 540)` | width and height of the picture                                  |
    | `vehicle`            | `None`       | name or path of a vehicle; that of the scenario by default       |
    | `continuous`         | `False`      | `Box` instead of `MultiDiscrete` (`EVHeatPumpContinuous-v0`)     |
    | `actions`            | `"default"`  | `"default"`, `"heat"`, `"hpcu"`, `"all"` or names of actuators   |
    | `action_options`     | `None`       | options of choices by name, in an order of one's own             |
    | `observations`       | `"default"`  | names of rows or groups (`"default"`, `"preview"`)               |
    | `observation_bounds` | `None`       | lowest and highest value of rows by name, for a wider car        |
    | `info`               | `[]`         | what infos also hold: `cost`, `action_mask`, `terms`             |
    | `reward`             | `"balanced"` | name or path of a reward, a mapping of weights, or a function    |
    | `control_interval_s` | `1`          | seconds for which an action is held                              |
    | `sensor_noise`       | `0.0`        | standard deviation on measured rows, in units of half the range  |
    | `overrides`          | `None`       | single values of vehicle, controller and scenario to change      |

    `reset(options={"scenario": ...})` and `reset(options={"distribution": ...})` choose another trip once.

    ## Vectorized environment

    `gymnasium.make_vec("EVHeatPump-v0", num_envs=64)` steps all environments in one call of native code on
    several threads, with the same results as as many single environments with the same seeds. Its own
    arguments are `autoreset_mode`, `threads` and `max_episode_steps`, and `scenario`, `distribution` and
    `vehicle` may be lists.

    Cars of different architectures share the rows of all of them, by name. Of what a car lacks, actions are
    ignored (an option acts as the first of its row: isolated, closed, off) and masked but for the first
    option of a row, and an observation reads as 0 in its own unit, held within its bounds, without noise.

    A trip that ends within a step of a vector stands in `finished` until the next step: environment, reason,
    KPIs, totals, what it was.

    ## Version History

    * v0: see `docs/versions.md` for what an id's number means, and for what changed
    """

    # Gymnasium declares it so.
    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 30}  # noqa: RUF012

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        scenario: Name | None = None,
        distribution: Name | None = None,
        render_size: tuple[int, int] = (960, 540),
        **chosen: Unpack[Keywords],
    ) -> None:
        """Makes an environment; see the class for the arguments.

        Raises:
            ConfigurationError: A name, key or value is not accepted; the message says what is.
            TypeError: There is no such argument, or it is of a type that cannot be read.
        """
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            allowed = ", ".join(self.metadata["render_modes"])
            message = f"render_mode is {render_mode!r}, but must be None or one of {allowed}"
            raise _core.ConfigurationError(message)
        self.render_mode = render_mode
        trips = settings.source(scenario, distribution)
        if trips == (None, None):
            trips = (None, settings.DEFAULT_DISTRIBUTION)
        self._episode = _core.Episode(settings.to_json(**chosen), *trips)
        reward = chosen.get("reward")
        self._reward: Reward | None = reward if callable(reward) else None
        # Nothing to do after a step, which is as quick as a call.
        self._plain = self._reward is None and render_mode != "human"
        self._told = settings.told(chosen)
        settings.tell_of_narrow_rows(self._episode)
        self.option_names = settings.option_names(self._episode)
        self.action_names = tuple(self.option_names)
        self._seeded = False
        self._render_size = render_size
        self._renderer: Renderer | None = None
        self._window: Window | None = None
        self.action_space = settings.action_space(self._episode)
        self.observation_space = settings.observation_space(self._episode)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins a trip.

        Args:
            seed: Starts the random numbers anew.
            options: `scenario` or `distribution` of this trip only.

        Raises:
            ConfigurationError: There is no such option, scenario or distribution.
        """
        seed = None if seed is None else settings.whole_seed(seed)
        super().reset(seed=seed)
        trips = settings.source(*settings.once(options))
        fresh = None
        if seed is not None:
            fresh = settings.core_seed(seed)
        elif not self._seeded:
            fresh = int(self.np_random.integers(2**63))
        observation, info = self._episode.reset(*trips, fresh)
        self._seeded = True
        if self._reward is not None:
            self._hide_terms(info)
        if self.render_mode == "human":
            self.render()
        return observation, info

    def step(self, action: Action) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Drives on for one control interval.

        Raises:
            ValueError: The action has the wrong shape or holds a value that is not allowed, or the reward
                that was given as a function is not one finite number.
            TypeError: The action is of the wrong type.
            ResetNeeded: No trip has begun, or it has ended.
        """
        result = self._episode.step(action)
        if self._plain:
            return result
        if self._reward is not None:
            observation, _, terminated, truncated, info = result
            parts = {name: info[name] for name in (*settings.PARTS, *settings.TERMS)}
            result = observation, rewards.one(self._reward, parts), terminated, truncated, info
            self._hide_terms(info)
        if self.render_mode == "human":
            self.render()
        return result

    def _hide_terms(self, info: dict[str, Any]) -> None:
        """Takes out of an info what only the reward needed."""
        if "terms" not in self._told:
            for name in settings.TERMS:
                del info[name]

    def render(self) -> NDArray[np.uint8] | None:
        """Draws the plant as it is now; returns the picture if `render_mode` is `rgb_array`."""
        if self.render_mode is None:
            gym.logger.warn(
                "render() was called without a render mode; choose one, "
                'e.g. gym.make("EVHeatPump-v0", render_mode="rgb_array")'
            )
            return None
        if self._renderer is None:
            from hp_gym.pictures.rendering import Renderer

            self._renderer = Renderer(*self._render_size)
        picture = self._renderer.render(self.signals(), self._episode.speeds_m_s(), layout=self.layout())
        if self.render_mode == "rgb_array":
            return picture
        if self._window is None:
            from hp_gym.pictures.window import Window

            self._window = Window()
        self._window.show(picture)
        return None

    def close(self) -> None:
        """Ends the environment; it cannot be used any more."""
        self._episode.close()
        if self._window is not None:
            self._window.close()
            self._window = None

    def action_masks(self) -> NDArray[np.bool_]:
        """Marks the options that the plant would grant in the coming second, action by action.

        Everything that is no connection is always granted. Where the agent also controls recirculation, a
        connection of the cabin counts as granted if some share of it makes it so.
        """
        return self._episode.action_masks()

    def rule_based_action(self) -> Action:
        """Returns what the rule-based controller would do next; in `MultiDiscrete` the nearest levels.

        Its memory moves on once a step, however often it is asked.
        """
        return self._episode.rule_based_action()

    def layout(self) -> dict[str, Any]:
        """Returns what the vehicle of the trip is made of: loops, members, branches, exchangers, columns."""
        return self._episode.layout()

    def signals(self) -> dict[str, float]:
        """Returns the present value of every signal of the plant by name."""
        return dict(zip(self._episode.signal_names(), self._episode.look().tolist(), strict=True))

    def decode(self, observation: NDArray[np.float32]) -> dict[str, NDArray[np.float64]]:
        """Returns an observation, or many, in the units of its rows, by name.

        Args:
            observation: As `reset` and `step` give it; the last axis holds the rows.

        Raises:
            ValueError: It has the wrong shape.
        """
        return settings.decode(self._episode, observation)

    def trip(self) -> dict[str, Any]:
        """Returns what the trip is.

        `scenario` (for drawn trips that of the distribution), `vehicle`, `cycle`, `window_s` (the part of the
        cycle that is driven, None for the whole), `duration_s`, `ambient_temperature_degc`.
        """
        return self._episode.trip()

    def end_reason(self) -> str | None:
        """Returns `arrived`, `battery_empty`, `immobile` or `late` once the trip is over, None before."""
        return self._episode.end_reason()

    def clipped_shares(self) -> dict[str, float]:
        """Returns the share of this trip's observations in which each row was beyond its bounds."""
        return self._episode.clipped_shares()

    def kpis(self) -> dict[str, float]:
        """Returns the KPIs of the trip so far; the score is the sum of all rewards.

        Where the reward is a function, the score is that of the default reward.
        """
        return self._episode.kpis()

    def summary(self) -> dict[str, float]:
        """Returns the totals of the trip so far, those that `hp_gym.simulate` gives.

        And `clipped_share`, the share of observations in which a value was beyond its bounds.
        """
        return self._episode.summary()

    def get_state(self) -> bytes:
        """Returns everything that the future depends on: plant, controller, trip, random numbers."""
        return self._episode.get_state()

    def set_state(self, state: bytes) -> None:
        """Goes on from where `get_state` was called, in this or another environment with the same settings.

        Raises:
            StateError: These are not bytes of such an environment; nothing has changed then.
        """
        self._episode.set_state(state)
        self._seeded = True

    def __getstate__(self) -> dict[str, Any]:
        """What a copy needs; it opens its own window."""
        return {**self.__dict__, "_renderer": None, "_window": None}
