import json
from pathlib import Path

import numpy as np
import pytest

from hp_gym.studies.reproduction import figures, reproduction_report
from hp_gym.studies.reproduction.claims import CLAIMS
from hp_gym.studies.reproduction.conditions import above, at_least, at_most, below
from hp_gym.studies.reproduction.measures import energy_kwh, first_time_s
from hp_gym.studies.reproduction.paper import LABELS, PUBLISHED_SCENARIOS
from hp_gym.studies.reproduction.reproduction_report import Reproduction
from hp_gym.studies.reproduction.runs import simulate_all


@pytest.fixture(scope="module")
def reproduction() -> Reproduction:
    return reproduction_report.reproduce()


def test_published_tables() -> None:
    assert [scenario.energy_kwh for scenario in PUBLISHED_SCENARIOS] == [
        8.08, 8.24, 7.68, 6.45, 7.68, 7.82, 7.68, 6.05, 6.72
    ]  # fmt: skip
    assert [scenario.final_soc_pct for scenario in PUBLISHED_SCENARIOS] == [
        81.1, 78.5, 80.8, 83.9, 79.6, None, None, None, None
    ]  # fmt: skip
    assert len(set(LABELS.values())) == 9


def test_claims_are_numbered_and_worded() -> None:
    assert [claim.id for claim in CLAIMS] == list(range(1, 27))
    assert len({claim.text for claim in CLAIMS}) == 26
    assert all(claim.text and claim.criterion for claim in CLAIMS)


def test_every_claim_is_judged_with_figures(reproduction: Reproduction) -> None:
    assert len(reproduction.claims) == 26
    for _, outcome in reproduction.claims:
        assert any(character.isdigit() for character in outcome.evidence)
        assert outcome.conditions
        assert outcome.holds == all(condition.holds for condition in outcome.conditions)
        assert not outcome.holds or max(outcome.shortfalls()) == 0.0


def test_no_claim_is_true_of_runs_that_are_all_the_same(reproduction: Reproduction) -> None:
    same = dict.fromkeys(LABELS.values(), reproduction.rows[2].run)
    verdicts = {claim.id: claim.judge(same).holds for claim in CLAIMS}
    comparing = (4, 6, 7, 9, 12, 13, 14, 15, 16, 17, 18, 20, 21, 22, 23, 24)
    assert not any(verdicts[number] for number in comparing)


def test_energies_of_claims_are_those_of_the_summary(reproduction: Reproduction) -> None:
    run = reproduction.rows[0].run
    assert energy_kwh(run, "battery_power_w") == pytest.approx(run.summary["energy_kwh"], rel=1e-9)
    assert energy_kwh(run, "compressor_power_w") == pytest.approx(
        run.summary["compressor_energy_kwh"], rel=1e-9
    )


def test_first_time_is_interpolated(reproduction: Reproduction) -> None:
    run = reproduction.rows[0].run
    time_s = first_time_s(run, "battery_temperature_degc", 5.0)
    assert np.interp(time_s, run["time_s"], run["battery_temperature_degc"]) == pytest.approx(5.0)
    assert first_time_s(run, "battery_temperature_degc", 1000.0) == float("inf")


def test_conditions_are_strict_where_they_say_so() -> None:
    assert not above(1.0, 1.0, 1.0).holds
    assert not below(1.0, 1.0, 1.0).holds
    assert at_least(1.0, 1.0, 1.0).holds
    assert at_most(1.0, 1.0, 1.0).holds
    assert above(0.0, 1.0, 0.5).shortfall() == 2.0
    assert above(1.1, 1.0, 0.5).shortfall(wanted=0.3) == pytest.approx(0.1)
    assert not below(float("nan"), 1.0, 1.0).holds
    assert np.isfinite(below(float("inf"), 1.0, 1.0).shortfall())


def test_json_has_the_promised_keys(reproduction: Reproduction) -> None:
    data = json.loads(json.dumps(reproduction.to_json(), allow_nan=False))
    assert {"scenarios", "claims", "simulated_s", "wall_s"} <= set(data)
    scenario_keys = {"id", "paper_energy_kwh", "energy_kwh", "paper_final_soc_pct", "final_soc_pct"}
    assert all(set(scenario) == scenario_keys for scenario in data["scenarios"])
    assert all(set(claim) == {"id", "claim", "holds", "evidence"} for claim in data["claims"])
    assert data["simulated_s"] == 16200.0
    assert data["wall_s"] > 0.0


def test_literal_cells_end_lower(reproduction: Reproduction) -> None:
    for row in reproduction.rows:
        assert row.literal.summary["final_soc_pct"] < row.run.summary["final_soc_pct"] - 1.0


def test_substeps_reach_the_plant(reproduction: Reproduction) -> None:
    runs, _ = simulate_all(["jeffs2019/case1-1"], substeps=2)
    finer, coarse = runs[0].summary["energy_kwh"], reproduction.rows[0].run.summary["energy_kwh"]
    assert finer != coarse
    assert finer == pytest.approx(coarse, rel=0.01)


def test_figures_are_written(reproduction: Reproduction, tmp_path: Path) -> None:
    paths = figures.write_all(reproduction_report.labelled(reproduction), tmp_path / "new" / "folder")
    assert [path.name[:8] for path in paths] == ["figure12", "figure13", "figure14"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
