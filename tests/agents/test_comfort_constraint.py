"""Multipliers that hold a policy's comfort at that of rules in every climate."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hp_gym.agents.training import configuration, environments
from hp_gym.agents.training.comfort import ComfortConstraint, by_climate
from hp_gym.agents.training.trips import Driven
from hp_gym.comfort_standard import TripComfort

DEGC = [-10.0, 5.0, 20.0]
CHANGES = (
    "environments={number = 4, threads = 1}",
    "environment.control_interval_s=60",
    "hyperparameters.n_steps=4",
    "hyperparameters.batch_size=16",
    f"comfort_constraint={{interval_decisions = 100, ambient_degc = {DEGC}, trips = 24, largest = 0.5}}",
)


def training(*changes: str) -> configuration.Training:
    return configuration.load("ppo", [*CHANGES, *changes])


def constraint(made: configuration.Training) -> ComfortConstraint:
    assert made.comfort_constraint is not None
    return ComfortConstraint.begin(made, made.comfort_constraint)


def trips(ambient_degc: list[float], duration_s: list[float]) -> Driven:
    nothing = np.zeros(len(ambient_degc))
    comfort = TripComfort(*[nothing] * 7)
    return Driven(np.array(ambient_degc), np.array(duration_s), nothing, nothing, nothing, nothing, comfort)


some_trips = st.lists(
    st.tuples(st.floats(-30.0, 45.0), st.floats(60.0, 2000.0)), min_size=1, max_size=30
).map(lambda rows: trips([row[0] for row in rows], [row[1] for row in rows]))


@given(some_trips, st.floats(-5.0, 5.0))
def test_what_all_trips_share_every_climate_with_trips_has(driven: Driven, value: float) -> None:
    found = by_climate(np.full(len(driven.duration_s), value), driven, DEGC)
    assert np.all(np.isclose(found, value) | (found == 0.0))
    assert np.any(np.isclose(found, value))


@given(some_trips, st.integers(0, 29), st.floats(0.1, 5.0))
def test_a_less_comfortable_trip_makes_no_climate_more_comfortable(
    driven: Driven, place: int, more_k: float
) -> None:
    before = np.arange(len(driven.duration_s), dtype=np.float64)
    after = before.copy()
    after[place % len(after)] += more_k
    change = by_climate(after, driven, DEGC) - by_climate(before, driven, DEGC)
    assert np.all(change >= -1e-12)
    assert change.max() > 0.0


def test_a_climate_is_read_from_the_trips_beside_it_alone() -> None:
    driven = trips([-20.0, 5.0, 12.5, 20.0], [100.0, 100.0, 200.0, 100.0])
    found = by_climate(np.array([7.0, 1.0, 4.0, 0.0]), driven, DEGC)
    # Half of the third trip's time counts at 5 degC and half at 20 degC.
    assert found.tolist() == [7.0, 2.5, 2.0]


def test_the_rules_themselves_are_within_the_constraint_and_idle_vehicles_are_not() -> None:
    made = training()
    rules = constraint(made)
    excess_k = rules.update(
        100, lambda observations, _: np.zeros((len(observations), 11), dtype=np.int64), masked=False
    )
    assert excess_k[0] > 5.0
    # As far as a step and the bound allow.
    assert rules.multipliers[0] == pytest.approx(0.2)
    for number in range(2, 6):
        rules.update(100 * number, lambda seen, _: np.zeros((len(seen), 11), dtype=np.int64), masked=False)
    assert rules.multipliers.max() == 0.5
    assert not rules.is_due(599)
    assert rules.is_due(600)


def test_damping_passes_with_the_violation_and_a_start_lasts() -> None:
    def after(*changes: str) -> np.ndarray:
        weighed = constraint(
            training("comfort_constraint.start=0.1", "comfort_constraint.largest=9.0", *changes)
        )
        np.testing.assert_array_equal(weighed.multipliers, 0.1)
        excess_k = weighed.update(
            100, lambda seen, _: np.zeros((len(seen), 11), dtype=np.int64), masked=False
        )
        return np.stack([np.clip(excess_k, -1.0, 1.0), weighed.multipliers, weighed.notes()["integrals"]])

    plain, damped = after(), after("comfort_constraint.damping_per_k=0.7")
    np.testing.assert_array_equal(plain[2], damped[2])
    np.testing.assert_allclose(damped[1], np.maximum(plain[2] + 0.7 * plain[0], 0.0))


def test_a_margin_asks_for_more_comfort_but_not_for_more_than_its_share() -> None:
    def allowed_k(*changes: str) -> np.ndarray:
        return np.array(constraint(training(*changes)).notes()["allowed_k"])

    plain = allowed_k()
    strict = allowed_k("comfort_constraint.margin_k=1.0", "comfort_constraint.margin_share=0.1")
    np.testing.assert_allclose(plain - strict, np.minimum(1.0, 0.1 * plain))
    assert (plain - strict)[0] == pytest.approx(1.0)


def test_notes_bring_the_multipliers_back() -> None:
    made = training()
    first = constraint(made)
    first.update(100, lambda seen, _: np.zeros((len(seen), 11), dtype=np.int64), masked=False)
    assert made.comfort_constraint is not None
    again = ComfortConstraint(made, made.comfort_constraint, first.notes())
    np.testing.assert_array_equal(again.multipliers, first.multipliers)
    assert again.notes() == first.notes()


EVEN = np.full(3, 0.25)
ALLOWED_K = np.array([16.0, 8.0, 2.0])


def factors(*changes: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Factors without and with multipliers, and distances of the cabins from comfort over what is allowed."""
    made = training(*changes)
    scale = environments.RewardScale(made)
    envs = environments.make(made)
    envs.seed(0)
    envs.reset()
    raw = envs.get_original_obs()  # type: ignore[attr-defined]
    before = scale.factors(raw)
    scale.set_multipliers(EVEN, ALLOWED_K)
    signals = [envs.env_method("signals", indices=[index])[0] for index in range(len(raw))]
    distance_k = np.array([abs(each["cabin_temperature_degc"] - 22.0) for each in signals])
    ambient_degc = [each["ambient_temperature_degc"] for each in signals]
    envs.close()
    return before, scale.factors(raw), distance_k / np.interp(ambient_degc, DEGC, ALLOWED_K)


def test_a_multiplier_weighs_the_discomfort_of_trips_in_its_climate() -> None:
    before, after, _ = factors()
    np.testing.assert_array_equal(after[0], before[0])
    np.testing.assert_allclose(after[1] - before[1], 0.25)


def test_a_convex_multiplier_weighs_in_proportion_up_to_the_allowed_distance_and_twice_at_most() -> None:
    before, after, ratio = factors("comfort_constraint.convex=true", "environments.number=16")
    np.testing.assert_array_equal(after[0], before[0])
    added = (after[1] - before[1]) / 0.25
    near = ratio <= 1.0
    assert near.any()
    assert not near.all()
    np.testing.assert_allclose(added[near], ratio[near], rtol=1e-4)
    np.testing.assert_allclose(added[~near], 2.0 - 1.0 / ratio[~near], rtol=1e-4)


@given(st.lists(st.floats(0.0, 50.0), min_size=3, max_size=30))
def test_what_a_convex_weight_makes_of_discomfort_is_convex(ratios: list[float]) -> None:
    ratio = np.unique(ratios)
    assume(len(ratio) > 2)
    assume(np.diff(ratio).min() > 1e-6)
    cost = ratio * environments._convex(ratio)
    slopes = np.diff(cost) / np.diff(ratio)
    assert np.all(np.diff(slopes) > -1e-6)
    assert np.all(slopes <= 2.0 + 1e-6)


def test_a_convex_weight_needs_to_see_the_cabin() -> None:
    made = training("comfort_constraint.convex=true", 'environment.observations=["ambient_temperature_degc"]')
    with pytest.raises(configuration.TrainingConfigurationError, match="need cabin_temperature_degc among"):
        environments.RewardScale(made)
