"""The gain over trips that both pass, the best rule, and when there is no headline."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hp_gym import comfort_standard
from hp_gym.studies.benchmark import grid, statistics, verdicts
from hp_gym.studies.benchmark.headline_claim import CLAIMED, Claims
from hp_gym.studies.benchmark.paired_gain import dearest_kwh

TABLES: dict[str, Any] = {
    "description": "Two climates, three cycles",
    "scenario": "ours/commute-minus5",
    "cycles": [{"name": "hwfet"}, {"name": "nedc"}, {"name": "udds"}],
    "ambient_temperatures_degc": [-10, -5, 5, 10],
    "variants": [
        {"name": "dark", "occupants": 1, "state_of_charge_pct": 90.0},
        {"name": "full", "occupants": 4, "state_of_charge_pct": 80.0},
    ],
    "bands": [
        {"name": "cold", "low_degc": -20.0, "headline": True},
        {"name": "mild", "low_degc": 0.0, "headline": True},
    ],
}
GRID = grid.parse("small", TABLES)
NAMES = [scenario.name for scenario in GRID.scenarios]
SEEDS = st.integers(0, 2**32 - 1)
FEW = settings(max_examples=20)
"""A comparison with all its resamples takes a while."""
GOOD = {
    **dict.fromkeys(comfort_standard.FIGURES, 0.0),
    "time_to_near_comfort_s": 300.0,
    "equivalent_time_to_near_comfort_s": 300.0,
    "duration_s": 1000.0,
}


def driven(
    name: str,
    energy_kwh: Sequence[float] | float,
    *,
    seed: int = -1,
    fails: Sequence[int] = (),
    heat_left_kwh: float = 0.0,
) -> pd.DataFrame:
    """Trips of a controller: energy, and the places of those that are too cold to pass."""
    rows = []
    for place, scenario in enumerate(GRID.scenarios):
        energy = energy_kwh if isinstance(energy_kwh, (int, float)) else energy_kwh[place]
        rows.append(
            {
                **GOOD,
                "controller": name,
                "seed": seed,
                "scenario": scenario.name,
                "band": scenario.band.name,
                "attributable_energy_kwh": energy,
                "heat_left_kwh": heat_left_kwh,
                "discomfort_k": 1.0,
                "discomfort_afterwards_k": 3.0 if place in fails else 1.0,
                "equivalent_discomfort_afterwards_k": 1.0,
                "stranded": 0.0,
            }
        )
    return pd.DataFrame(rows)


def figures(
    *runs: pd.DataFrame, rules: Sequence[str] = ("hpcu", "hpcu-modern"), learned: Sequence[str] = ("ppo",)
) -> dict[str, Any]:
    resamples = statistics.resample_clusters(
        [(scenario.cycle.name, scenario.ambient_temperature_degc) for scenario in GRID.scenarios],
        [scenario.band.name for scenario in GRID.scenarios],
        200,
        seed=3,
    )
    judged = verdicts.judged(pd.concat(runs, ignore_index=True))
    return Claims(GRID, judged, resamples, rules, learned, shipped="ppo", paper="hpcu").figures()


def some_energies(seed: int) -> list[float]:
    return list(np.random.default_rng(seed).uniform(1.0, 3.0, len(NAMES)))


@FEW
@given(seed=SEEDS)
def test_a_controller_against_itself_takes_as_much_and_passes_everywhere(seed: int) -> None:
    energies = some_energies(seed)
    found = figures(*(driven(name, energies) for name in ("hpcu", "hpcu-modern", "ppo")))
    for name in ("hpcu", "hpcu-modern", "ppo"):
        rates = found["comfort"]["controllers"][name]
        assert {band["passed_pct"] for band in rates["bands"].values()} == {100.0}
    gain = found["paired_gains"][f"ppo_vs_{found['headline']['best_rule']}"]
    assert gain["attributable_energy_pct"] == gain["charged_pct"] == 0.0
    assert gain["ci95"] == gain["charged_ci95"] == [0.0, 0.0]
    assert gain["pairs"] == len(NAMES)
    assert gain["objections"] == []


@FEW
@given(seed=SEEDS, share=st.floats(0.5, 0.99))
def test_uniformly_cheaper_is_a_headline_of_that_share(seed: int, share: float) -> None:
    energies = some_energies(seed)
    cheaper = [share * energy for energy in energies]
    found = figures(driven("hpcu", energies), driven("hpcu-modern", energies), driven("ppo", cheaper))
    claim = found["headline"]["learned_vs_best_rule"]
    assert set(claim) == set(CLAIMED)
    assert claim["attributable_energy_pct"] == pytest.approx(100.0 * (share - 1.0))
    assert claim["ci95"] == pytest.approx([100.0 * (share - 1.0)] * 2)
    assert claim["passed_pct"] == 100.0


@FEW
@given(seed=SEEDS)
def test_the_order_of_runs_does_not_matter(seed: int) -> None:
    both = [
        driven("hpcu", 3.0),
        driven("hpcu-modern", some_energies(seed)),
        driven("ppo", some_energies(seed + 1)),
    ]
    shuffled = pd.concat(both).sample(frac=1.0, random_state=seed % 2**31)
    told, again = figures(*both), figures(shuffled)
    assert again["paired_gains"] == told["paired_gains"]
    assert again["headline"] == told["headline"]


def test_a_trip_that_one_of_both_fails_does_not_count_and_is_charged_in_the_second_figure() -> None:
    energies = [2.0] * len(NAMES)
    learned = [1.0, *[1.5] * (len(NAMES) - 1)]
    found = figures(driven("hpcu", 4.0), driven("hpcu-modern", energies), driven("ppo", learned, fails=[0]))
    gain = found["paired_gains"]["ppo_vs_hpcu-modern"]
    assert gain["pairs"] == len(NAMES) - 1
    assert gain["attributable_energy_pct"] == pytest.approx(-25.0)
    charged_kwh = 4.0 + 1.5 * (len(NAMES) - 1)
    assert gain["charged_pct"] == pytest.approx(100.0 * (charged_kwh / (2.0 * len(NAMES)) - 1.0))


def test_seeds_are_paired_each_with_its_own_failures() -> None:
    first, second = driven("ppo", 1.0, seed=0, fails=range(12)), driven("ppo", 3.0, seed=1)
    found = figures(driven("hpcu", 2.2), driven("hpcu-modern", 2.0), first, second)
    gain = found["paired_gains"]["ppo_vs_hpcu-modern"]
    assert gain["pairs"] == 12 + 24
    assert gain["attributable_energy_pct"] == pytest.approx(
        100.0 * ((12 * 1.0 + 24 * 3.0) / (36 * 2.0) - 1.0)
    )
    assert gain["passed_pct"] == 75.0
    assert gain["ci95"][0] < gain["attributable_energy_pct"] < gain["ci95"][1]


def test_less_than_95_pct_in_one_band_is_no_headline_however_much_is_saved() -> None:
    """A rule that is colder below 0 degC: most of all trips pass, but not those."""
    cold = [place for place, scenario in enumerate(GRID.scenarios) if scenario.band.name == "cold"]
    found = figures(driven("hpcu", 2.2), driven("hpcu-modern", 2.0), driven("ppo", 1.0, fails=cold[:1]))
    headline = found["headline"]
    assert found["comfort"]["controllers"]["ppo"]["passed_pct"] > 95.0
    assert headline["learned_vs_best_rule"] is None
    assert "92 % in cold" in headline["reasons"]["learned_vs_best_rule"]
    assert "mild" not in headline["reasons"]["learned_vs_best_rule"]
    assert found["paired_gains"]["ppo_vs_hpcu-modern"]["attributable_energy_pct"] == pytest.approx(-50.0)


def test_more_energy_in_one_band_is_no_headline_however_much_is_saved_in_others() -> None:
    energies = [2.1 if scenario.band.name == "mild" else 1.0 for scenario in GRID.scenarios]
    found = figures(driven("hpcu", 2.2), driven("hpcu-modern", 2.0), driven("ppo", energies))
    assert found["headline"]["learned_vs_best_rule"] is None
    assert found["headline"]["reasons"]["learned_vs_best_rule"].endswith("in mild")
    bands = found["paired_gains"]["ppo_vs_hpcu-modern"]["bands"]
    assert bands["mild"]["difference_kwh"] == pytest.approx(0.1)
    assert bands["mild"]["attributable_energy_pct"] == pytest.approx(5.0)
    assert bands["cold"]["difference_ci95"] == pytest.approx([-1.0, -1.0])


def test_the_worse_credit_counts() -> None:
    found = figures(driven("hpcu", 2.2), driven("hpcu-modern", 2.0, heat_left_kwh=1.0), driven("ppo", 1.8))
    gain = found["paired_gains"]["ppo_vs_hpcu-modern"]
    assert gain["credit"] == 0.5
    assert gain["attributable_energy_pct"] == pytest.approx(20.0)
    assert gain["by_credit"]["0"]["attributable_energy_pct"] == pytest.approx(-10.0)


def test_the_best_rule_is_the_cheapest_of_those_that_pass_in_every_band() -> None:
    runs = [
        driven("hpcu", 3.0),
        driven("hpcu-modern", 2.5),
        driven("mine", 2.0),
        driven("cold", 1.0, fails=range(3)),
        driven("ppo", 1.5),
    ]
    rules = ("hpcu", "hpcu-modern", "mine", "cold")
    headline = figures(*runs, rules=rules)["headline"]
    assert headline["best_rule"] == "mine"
    assert headline["best_rule_vs_hpcu"]["attributable_energy_pct"] == pytest.approx(-100.0 / 3.0)
    assert headline["learned_vs_best_rule"]["attributable_energy_pct"] == pytest.approx(-25.0)
    assert headline["rests_on"]["learned_vs_best_rule"] == {"pairs": 24, "bands_without_pairs": []}


def test_a_headline_names_the_bands_that_it_says_nothing_of() -> None:
    cold = [place for place, scenario in enumerate(GRID.scenarios) if scenario.band.name == "cold"]
    runs = [driven("hpcu", 3.0, fails=cold), driven("hpcu-modern", 2.0), driven("ppo", 2.1)]
    headline = figures(*runs)["headline"]
    assert headline["best_rule_vs_hpcu"]["passed_pct"] == 100.0
    assert headline["rests_on"]["best_rule_vs_hpcu"] == {"pairs": 12, "bands_without_pairs": ["cold"]}
    assert headline["rests_on"]["learned_vs_best_rule"] is None


def test_without_rules_that_pass_there_is_no_best_rule_and_it_says_why() -> None:
    headline = figures(
        driven("hpcu", 3.0, fails=range(24)), driven("hpcu-modern", 2.5), driven("ppo", 1.5), rules=("hpcu",)
    )["headline"]
    assert headline["best_rule"] is headline["learned_vs_best_rule"] is headline["best_rule_vs_hpcu"] is None
    for reason in headline["reasons"].values():
        assert "`hpcu` passes 0 % in cold, 0 % in mild" in reason


@pytest.mark.parametrize(
    ("learned", "claimed", "words"),
    [
        ((), None, "no learned"),
        (("mine",), "mine", ""),
        (("mine", "ppo"), "ppo", ""),
        (("mine", "other"), None, "validation"),
    ],
)
def test_who_is_claimed_for_is_not_chosen_on_held_out_trips(
    learned: Sequence[str], claimed: str | None, words: str
) -> None:
    runs = [driven(name, 2.0 - 0.1 * place) for place, name in enumerate(("hpcu", "hpcu-modern", *learned))]
    headline = figures(*runs, learned=learned)["headline"]
    assert headline["learned"] == claimed
    assert words in (headline["reasons"]["learned_vs_best_rule"] or "")
    assert (headline["learned_vs_best_rule"] is None) == bool(words)


def test_the_best_rule_that_is_the_hpcu_has_no_gain_over_itself() -> None:
    headline = figures(driven("hpcu", 1.0), driven("hpcu-modern", 2.0), driven("ppo", 0.9))["headline"]
    assert headline["best_rule"] == "hpcu"
    assert headline["best_rule_vs_hpcu"] is None
    assert "itself" in headline["reasons"]["best_rule_vs_hpcu"]


def test_dearest_is_of_those_that_pass() -> None:
    runs = verdicts.judged(
        pd.concat(
            [
                driven("hpcu-modern", 2.0),
                driven("dear", 9.0, fails=range(23)),
                driven("ppo", 3.0, fails=[23]),
            ],
            ignore_index=True,
        )
    )
    found = dearest_kwh(runs, NAMES, 0.0)
    assert found.tolist() == [3.0] * 23 + [9.0]


@given(seed=SEEDS)
def test_scenarios_of_a_cluster_come_and_go_together_and_strata_keep_their_weight(seed: int) -> None:
    clusters = [place // 3 for place in range(18)]
    strata = [place // 9 for place in range(18)]
    drawn = statistics.resample_clusters(clusters, strata, 50, seed).scenarios
    assert np.all(drawn[0] == 1.0)
    by_cluster = drawn.reshape(51, 6, 3)
    assert np.all(by_cluster == by_cluster[:, :, :1])
    assert np.all(drawn.reshape(51, 2, 9).sum(axis=2) == 9.0)


def test_trips_of_a_cluster_that_are_alike_widen_the_interval() -> None:
    """What trips of one cycle share is no evidence three times over."""
    generator = np.random.default_rng(1)
    values = np.repeat(generator.normal(10.0, 2.0, 30), 4)[None, :]
    clusters, one = [place // 4 for place in range(120)], [0] * 120
    alone = statistics.interval(statistics.resample(one, 2000, 2).mean_over_runs(values)[1:])
    together = statistics.interval(
        statistics.resample_clusters(clusters, one, 2000, 2).mean_over_runs(values)[1:]
    )
    width = [high - low for low, high in (alone, together) if low is not None and high is not None]
    assert width[1] == pytest.approx(2.0 * width[0], rel=0.15)
