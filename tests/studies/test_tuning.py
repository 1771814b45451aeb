"""Rules tuned on training trips, written as a controller file."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import hp_gym
from hp_gym import _core, comfort_standard
from hp_gym.agents.training import configuration
from hp_gym.agents.training.trips import drive
from hp_gym.comfort_standard import Verdict
from hp_gym.envs.hpcu_policy import HpcuPolicy
from hp_gym.envs.vector_env import EVHeatPumpVectorEnv
from hp_gym.studies.optimise import search_loop
from hp_gym.studies.tuning import objective as goals
from hp_gym.studies.tuning import rule_choices, rule_families, search
from hp_gym.studies.tuning.ambient_bands import BANDS, Band, training_distribution
from hp_gym.studies.tuning.kept_trials import KeptTrials
from hp_gym.studies.tuning.objective import objective
from hp_gym.studies.tuning.rule_families import RuleFamily


def test_papers_choices_in_every_band_drive_as_the_papers_controller(tmp_path: Path) -> None:
    file = tmp_path / "paper.toml"
    rule_choices.write(file, "The paper's.", [(band, rule_choices.PAPER) for band in BANDS])
    for degc in (-15.0, -5.0, 5.0, 15.0, 30.0):
        changes = [f"scenario.climate.ambient_temperature_degc={degc}"]
        ours = hp_gym.simulate("ours/commute-minus5", str(file), changes)
        paper = hp_gym.simulate("ours/commute-minus5", "hpcu", changes)
        assert ours.summary == pytest.approx(paper.summary, rel=0.0, nan_ok=True)


def test_band_of_the_ambient_temperature_decides(tmp_path: Path) -> None:
    file = tmp_path / "two.toml"
    cold, warm = Band(-20, 0), Band(0, 40)
    rule_choices.write(
        file,
        "Two bands.",
        [(cold, rule_choices.PAPER.changed({"strategy.ptc": False})), (warm, rule_choices.PAPER)],
    )
    ptc_kwh = {
        degc: hp_gym.simulate(
            "jeffs2019/case1-1", str(file), [f"scenario.climate.ambient_temperature_degc={degc}"]
        ).summary["ptc_energy_kwh"]
        for degc in (-5.0, 5.0)
    }
    assert ptc_kwh[-5.0] == 0.0
    assert ptc_kwh[5.0] > 0.1


@pytest.mark.parametrize("family", rule_families.FAMILIES.values(), ids=rule_families.FAMILIES)
def test_search_repeats_with_its_seed_and_never_falls_behind_where_it_starts(family: RuleFamily) -> None:
    band = Band(0, 10)
    with objective(band, 4, 0) as goal:
        found = [
            search.tuned(goal, family, [rule_choices.PAPER], search.Effort(12, 4, 5), lambda: None)
            for _ in range(2)
        ]
        assert found[0] == found[1]
        assert found[0].score >= goal.score(family.start(band))
        assert goal.score(found[0].choices) == found[0].score


@pytest.mark.parametrize("family", rule_families.FAMILIES.values(), ids=rule_families.FAMILIES)
@pytest.mark.parametrize("band", BANDS, ids=lambda band: band.title)
def test_a_search_starts_at_rules_that_it_can_draw(family: RuleFamily, band: Band) -> None:
    assert search_loop.as_drawn(family.axes_in(band), family.start(band).values) is not None


def test_rules_where_a_search_starts_drive_as_their_file_does(tmp_path: Path) -> None:
    file = tmp_path / "start.toml"
    rule_choices.write(file, "Untouched.", [(band, rule_families.HPCU.start(band)) for band in BANDS])
    changes = ["scenario.strategy.battery=isolate"]
    ours = hp_gym.simulate("ours/commute-minus5", str(file), changes)
    theirs = hp_gym.simulate("ours/commute-minus5", "hpcu-modern", changes)
    assert ours.summary == pytest.approx(theirs.summary, rel=0.0, nan_ok=True)


def test_held_to_the_standard_a_cold_cabin_costs_more_than_it_can_save() -> None:
    """Pooled, a cabin 5 K colder only costs what it is less comfortable than the paper's."""
    band = Band(0, 10)
    heated = rule_families.HPCU.start(band).changed({"strategy.battery": "heat"})
    cold = heated.changed({"controller.cabin_set_point_degc": 17.0})
    with objective(band, 8, 0, comfort="standard") as goal:
        assert goal.score(heated) - goal.score(cold) > 0.4 * goals.FAILED_TRIP_POINTS


@given(st.lists(st.floats(-1.0, 5.0), min_size=1, max_size=20))
def test_a_failed_trip_counts_half_to_whole_and_one_that_passes_not_at_all(lateness: list[float]) -> None:
    nothing = np.zeros(len(lateness))
    verdict = Verdict(np.array(lateness), nothing, nothing, nothing, nothing)
    failed = float(np.mean(~verdict.passes))
    assert 0.5 * failed <= goals.failed_share(verdict) <= failed


@pytest.mark.parametrize("name", ["hpcu-best-mode", "hpcu-tuned"])
def test_shipped_rules_are_no_worse_than_the_papers_on_training_trips_of_other_seeds(name: str) -> None:
    tables = tomllib.loads(_core.config_text("controller", name))
    for band, row in zip(BANDS, tables["ambient_bands"], strict=True):
        values = dict(_flat("", {key: row[key] for key in ("strategy", "controller") if key in row}))
        choices = rule_choices.Choices(tables["base"], values)
        with objective(band, 64, 50_000) as goal:
            assert goal.score(choices) >= goal.score(rule_choices.PAPER)


def test_rules_held_to_the_standard_pass_training_trips_of_other_seeds() -> None:
    passed = []
    for band in BANDS:
        with training_distribution(band) as distribution:
            of_strict, of_reference = (
                _trips(distribution, name) for name in ("hpcu-tuned-strict", comfort_standard.REFERENCE)
            )
        passed += list(comfort_standard.judge(of_strict, of_reference).passes)
    assert np.mean(passed) >= 0.95


def _trips(distribution: Path, controller: str) -> comfort_standard.TripComfort:
    env = EVHeatPumpVectorEnv(
        64,
        distribution=distribution,
        continuous=True,
        actions=HpcuPolicy.ACTIONS,
        overrides={"scenario.controller": controller},
    )
    return drive(env, range(50_000, 50_064), lambda *_: env.rule_based_actions()).comfort


def _flat(prefix: str, table: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _flat(f"{prefix}{key}.", value)
        else:
            yield f"{prefix}{key}", value


def test_rules_are_held_to_the_comfort_that_policies_are_held_to() -> None:
    constraint = configuration.load("ppo", []).comfort_constraint
    assert constraint is not None
    assert (constraint.margin_k, constraint.margin_share) == (goals.MARGIN_K, goals.MARGIN_SHARE)
    assert configuration.load("ppo", []).environment.reward == goals.REWARD


def test_trials_are_kept_for_the_same_command_and_car_only(tmp_path: Path) -> None:
    out, band = tmp_path / "out", BANDS[1]
    other = rule_families.HPCU.start(band).changed({"controller.htc_set_point_degc": 47.123456789012345})
    kept = KeptTrials(out, "tune")
    assert not kept
    kept.add(band, other, (-1.0 / 3.0, 0.1))
    again = KeptTrials(out, "tune")
    assert again.get(band, other) == (-1.0 / 3.0, 0.1)
    assert again.get(BANDS[2], other) is again.get(band, rule_choices.PAPER) is None
    assert not KeptTrials(out, "tune", ["vehicle.body.mass_kg=2000.0"])
    assert not KeptTrials(out, "tune")
    kept = KeptTrials(out, "tune")
    kept.add(band, other, (1.0, 2.0))
    (file,) = tmp_path.rglob("optimise.db")
    for path in file.parent.iterdir():
        path.write_bytes(b"damaged")
    kept = KeptTrials(out, "tune")
    assert not kept
    kept.remove()
    assert list(tmp_path.iterdir()) == []
