"""Energy at matched comfort, gains and their intervals."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hp_gym.studies.benchmark import gains, matched, statistics
from hp_gym.studies.benchmark.statistics import Trips

SCENARIOS, SETTINGS = 12, 6
STRATA = [scenario % 3 for scenario in range(SCENARIOS)]
RESAMPLES = statistics.resample(STRATA, 200, seed=1)
SEEDS = st.integers(0, 2**32 - 1)


def some_trips(seed: int, runs: int = 1) -> Trips:
    generator = np.random.default_rng(seed)
    shape = (runs, SCENARIOS)
    return Trips(
        energy_kwh=generator.uniform(1.0, 3.0, shape),
        heat_left_kwh=generator.uniform(0.0, 0.5, shape),
        discomfort_k_h=generator.uniform(0.5, 2.0, shape),
        occupied_h=np.full(shape, 0.3),
        stranded=np.zeros(shape),
    )


def falling_front(seed: int) -> Trips:
    """The same trips, each setting a little less comfortable and a little cheaper than the one before."""
    base = some_trips(seed)
    steps = np.arange(SETTINGS)[:, None]
    return Trips(
        energy_kwh=base.energy_kwh * (1.5 - 0.2 * steps + 0.02 * steps**2),
        heat_left_kwh=base.heat_left_kwh * np.ones_like(steps),
        discomfort_k_h=base.discomfort_k_h * (1.0 + 0.3 * steps),
        occupied_h=base.occupied_h * np.ones_like(steps),
        stranded=np.zeros((SETTINGS, SCENARIOS)),
    )


def gain_of(agent: Trips, front: Trips, place: int = 0) -> dict[str, Any]:
    rules = front.runs(np.array([place]))
    return gains.gain(agent, rules, front, RESAMPLES, list(range(len(agent.energy_kwh))))


@given(seed=SEEDS, setting=st.integers(0, SETTINGS - 1))
def test_a_setting_of_a_convex_front_gains_nothing_over_it(seed: int, setting: int) -> None:
    front = falling_front(seed)
    found = gain_of(front.runs(np.array([setting])), front)
    assert found["attributable_energy_pct"] == pytest.approx(0.0, abs=1e-9)
    assert found["ci95"] == pytest.approx([0.0, 0.0], abs=1e-9)


@given(seed=SEEDS, setting=st.integers(0, SETTINGS - 1), share=st.floats(0.5, 1.5))
def test_uniformly_cheaper_is_a_gain_of_that_share(seed: int, setting: int, share: float) -> None:
    front = falling_front(seed)
    agent = front.runs(np.array([setting]))
    agent = replace(agent, energy_kwh=share * agent.energy_kwh, heat_left_kwh=share * agent.heat_left_kwh)
    found = gain_of(agent, front)
    for credit in ("0", "0.5"):
        change_pct = found["by_credit"][credit]["attributable_energy_pct"]
        assert change_pct == pytest.approx(100.0 * (share - 1.0), abs=1e-6)
    assert found["ci95"] == pytest.approx([100.0 * (share - 1.0)] * 2, abs=1e-6)


@given(seed=SEEDS, share=st.floats(0.0, 1.0), setting=st.integers(0, SETTINGS - 2))
def test_a_mixture_of_two_neighbouring_settings_gains_nothing(seed: int, share: float, setting: int) -> None:
    front = falling_front(seed)
    one, other = front.runs(np.array([setting])), front.runs(np.array([setting + 1]))
    names = Trips.__dataclass_fields__
    mixed = Trips(*((1.0 - share) * getattr(one, name) + share * getattr(other, name) for name in names))
    assert gain_of(mixed, front)["attributable_energy_pct"] == pytest.approx(0.0, abs=1e-6)


@given(seed=SEEDS, discomfort_k=st.floats(0.0, 10.0), other_k=st.floats(0.0, 10.0))
def test_front_is_below_its_settings_falls_and_ends_where_they_do(
    seed: int, discomfort_k: float, other_k: float
) -> None:
    generator = np.random.default_rng(seed)
    front_k, front_kwh = generator.uniform(1.0, 9.0, (1, 8)), generator.uniform(1.0, 3.0, (1, 8))

    def needed(at_k: float) -> float:
        return float(matched.front_energy_kwh(np.array([at_k]), front_k, front_kwh)[0])

    for setting_k, setting_kwh in zip(front_k[0], front_kwh[0], strict=True):
        assert needed(setting_k) <= setting_kwh + 1e-12
    low_k, high_k = sorted((discomfort_k, other_k))
    if high_k > front_k.max():
        assert np.isnan(needed(high_k))
    else:
        assert needed(high_k) <= needed(low_k) + 1e-12
        # Convex where there are settings on both sides.
        if low_k >= front_k.min():
            middle_kwh = needed(0.5 * (low_k + high_k))
            assert middle_kwh <= 0.5 * (needed(low_k) + needed(high_k)) + 1e-9
    if low_k < front_k.min():
        assert needed(low_k) == front_kwh[0, front_k[0].argmin()]


def test_more_comfortable_than_every_setting_is_compared_with_the_most_comfortable_and_told() -> None:
    front = falling_front(3)
    agent = front.runs(np.array([0]))
    agent = replace(agent, discomfort_k_h=0.5 * agent.discomfort_k_h, energy_kwh=1.1 * agent.energy_kwh)
    found = gain_of(agent, front)
    assert found["matched"] == matched.MOST_COMFORTABLE
    assert found["by_credit"]["0"]["attributable_energy_pct"] == pytest.approx(10.0)
    assert found["discomfort_k"] < 0.0


def test_less_comfortable_than_every_setting_has_no_matched_energy() -> None:
    front = falling_front(3)
    agent = front.runs(np.array([SETTINGS - 1]))
    found = gain_of(replace(agent, discomfort_k_h=2.0 * agent.discomfort_k_h), front)
    assert found["matched"] == matched.UNMATCHED
    assert found["attributable_energy_pct"] is None
    assert found["ci95"] == [None, None]


def test_the_worse_of_both_credits_counts() -> None:
    front = falling_front(5)
    agent = front.runs(np.array([2]))
    wasteful = replace(agent, heat_left_kwh=0.0 * agent.heat_left_kwh)
    found = gain_of(wasteful, front)
    assert found["credit"] == 0.5
    assert found["attributable_energy_pct"] > found["by_credit"]["0"]["attributable_energy_pct"]


def test_a_stranded_trip_of_the_controller_leaves_no_gain_and_is_counted() -> None:
    front = falling_front(5)
    agent = front.runs(np.array([2]))
    stranded = agent.stranded.copy()
    stranded[0, 4] = 1.0
    found = gain_of(replace(agent, stranded=stranded), front)
    assert found["attributable_energy_pct"] is None
    assert found["stranded_trips"] == {"controller": 1, "rules": 0}


def test_a_stranded_setting_is_no_part_of_the_front() -> None:
    front = falling_front(5)
    cheap = replace(
        front, energy_kwh=front.energy_kwh * np.where(np.arange(SETTINGS) == 3, 0.1, 1.0)[:, None]
    )
    stranded = cheap.stranded.copy()
    stranded[3, 0] = 1.0
    agent = front.runs(np.array([2]))
    assert gain_of(agent, replace(cheap, stranded=stranded))["attributable_energy_pct"] < 5.0
    assert gain_of(agent, cheap)["attributable_energy_pct"] > 100.0


def test_seeds_that_differ_widen_the_interval() -> None:
    front = falling_front(8)
    agent = front.runs(np.array([1, 1, 1, 1, 1]))
    factors = np.array([0.7, 0.85, 1.0, 1.15, 1.3])[:, None]
    same, spread = (
        gain_of(agent, front),
        gain_of(replace(agent, energy_kwh=factors * agent.energy_kwh), front),
    )
    width = [found["ci95"][1] - found["ci95"][0] for found in (same, spread)]
    assert width[0] < 1e-6
    assert width[1] > 5.0
    assert spread["by_credit"]["0"]["attributable_energy_pct"] == pytest.approx(0.0, abs=1e-6)


@given(seed=SEEDS, count=st.integers(1, 7))
def test_resamples_keep_every_stratum_and_begin_with_the_trips_as_they_are(seed: int, count: int) -> None:
    drawn = statistics.resample(STRATA, 20, seed)
    for stratum in set(STRATA):
        places = [place for place, item in enumerate(STRATA) if item == stratum]
        assert np.all(drawn.scenarios[:, places].sum(axis=1) == len(places))
    assert np.all(drawn.scenarios[0] == 1.0)
    shares = drawn.seeds(count)
    assert shares.sum(axis=1) == pytest.approx(np.ones(21))
    assert shares[0] == pytest.approx(np.full(count, 1.0 / count))


def test_interval_of_a_known_distribution() -> None:
    # The mean of many equal draws: the bootstrap's spread is the standard error.
    generator = np.random.default_rng(0)
    values = generator.normal(10.0, 2.0, (1, 400))
    means = statistics.resample([0] * 400, 4000, seed=2).mean_over_runs(values)[1:] / 400.0
    low, high = statistics.interval(means)
    assert low is not None
    assert high is not None
    standard_error = values.std() / 20.0
    assert high - low == pytest.approx(2.0 * 1.96 * standard_error, rel=0.06)
    assert low < 10.2
    assert high > 9.8


def test_interval_counts_what_is_no_number_as_worst() -> None:
    values = np.concatenate([np.linspace(-10.0, -5.0, 90), np.full(10, np.nan)])
    low, high = statistics.interval(values)
    assert low == pytest.approx(-10.0, abs=0.2)
    assert high is None


def test_paired_difference_of_equal_trips_is_nothing() -> None:
    trips = some_trips(4)
    found = gains.paired(trips, trips, RESAMPLES)
    assert found["energy_difference_pct"] == 0.0
    assert found["discomfort_difference_upper95_k"] == 0.0
