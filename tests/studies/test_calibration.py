import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from hp_gym import _core
from hp_gym.studies.calibration import calibrated_files, calibration_report
from hp_gym.studies.calibration.calibrated_files import current_values
from hp_gym.studies.calibration.calibration_file import Parameter
from hp_gym.studies.calibration.fit import Options, fit
from hp_gym.studies.calibration.held_out import leave_out, subset
from hp_gym.studies.calibration.problem import CalibrationError, Problem, Target, load, parse
from hp_gym.studies.calibration.residuals import Residuals, overrides

SCENARIOS = ("jeffs2019/case1-3", "jeffs2019/case1-4")
DRAG = Parameter(("vehicle.body.drag_area_m2",), 0.6, 0.95, 0.8, "test")
AUXILIARY = Parameter(("vehicle.controls.auxiliary_power_w",), 50.0, 600.0, 300.0, "test")
TRUTH = (0.7, 420.0)


def problem_of(targets: tuple[Target, ...], parameters: tuple[Parameter, ...] = (DRAG, AUXILIARY)) -> Problem:
    return Problem(
        description="test",
        vehicle="jeffs2019",
        controller="hpcu",
        parameters=parameters,
        targets=targets,
        soft_claims={},
        energy_sigma_share=0.001,
        final_soc_sigma_pct=0.05,
        prior_sigma_share=1000.0,
        maximum_evaluations=60,
    )


def synthetic_targets(parameters: tuple[Parameter, ...], truth: tuple[float, ...]) -> tuple[Target, ...]:
    results = _core.totals(SCENARIOS, overrides(parameters, truth))
    return tuple(
        Target(scenario, summary["energy_kwh"], summary["final_soc_pct"])
        for scenario, (summary, _) in zip(SCENARIOS, results, strict=True)
    )


def priors(problem: Problem) -> dict[str, float]:
    return {parameter.name: parameter.prior for parameter in problem.parameters}


def test_recovers_a_known_value() -> None:
    problem = problem_of(synthetic_targets((DRAG,), TRUTH[:1]), (DRAG,))
    result = fit(problem, priors(problem))
    assert result.values[0] == pytest.approx(TRUTH[0], abs=0.002)
    assert result.at_bound == (False,)
    assert result.evaluations <= problem.maximum_evaluations


def test_two_values_meet_their_targets() -> None:
    problem = problem_of(synthetic_targets((DRAG, AUXILIARY), TRUTH))
    result = fit(problem, priors(problem))
    for error in calibration_report.errors(problem, result):
        assert error.energy_pct == pytest.approx(0.0, abs=0.05)
        assert error.final_soc_pct == pytest.approx(0.0, abs=0.05)


def test_bounds_hold_and_are_flagged() -> None:
    narrow = replace(DRAG, low=0.75, high=0.9)
    problem = problem_of(synthetic_targets((DRAG,), TRUTH[:1]), (narrow,))
    result = fit(problem, priors(problem))
    assert narrow.low <= result.values[0] <= narrow.high
    assert result.at_bound == (True,)
    assert "(!)" in calibration_report.to_toml(result)


def test_result_is_a_file_of_keys_and_values() -> None:
    shared = replace(DRAG, keys=("vehicle.body.drag_area_m2", "vehicle.body.rotating_mass_share"))
    problem = problem_of(synthetic_targets((DRAG,), TRUTH[:1]), (DRAG,))
    result = fit(problem, priors(problem), Options(maximum_evaluations=1))
    assert tomllib.loads(calibration_report.to_toml(result)) == result.by_key()
    assert set(replace(result, problem=replace(problem, parameters=(shared,))).by_key()) == set(shared.keys)


def test_a_held_out_scenario_is_not_seen() -> None:
    targets = synthetic_targets((DRAG,), TRUTH[:1])
    wrong = (replace(targets[0], energy_kwh=20.0), targets[1])
    problem = replace(problem_of(wrong, (DRAG,)), subset_energy=SCENARIOS[1:])
    for part in (leave_out(problem, SCENARIOS[0], priors(problem), Options()),
                 subset(problem, priors(problem), Options())):  # fmt: skip
        assert [error.scenario for error in part.errors] == [SCENARIOS[0]]
        expected_pct = 100.0 * (targets[0].energy_kwh / 20.0 - 1.0)
        assert part.errors[0].energy_pct == pytest.approx(expected_pct, abs=0.3)


def test_unknown_key_is_named() -> None:
    wrong = replace(DRAG, keys=("vehicle.body.drag_aera_m2",))
    problem = problem_of((Target(SCENARIOS[0], 7.0, None),), (wrong,))
    with pytest.raises(CalibrationError, match="drag_aera_m2"):
        current_values(problem)
    with pytest.raises(_core.ConfigurationError, match="drag_aera_m2"):
        fit(problem, priors(problem))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"parameter": [{"key": "vehicle.a", "low": 1.0, "high": 2.0, "prior": 3.0, "source": ""}]}, "prior"),
        ({"parameter": [{"key": "vehicle.a", "low": 1.0, "high": 2.0, "prior": 1.5}]}, "source"),
        ({"parameter": [{"low": 1.0, "high": 2.0, "prior": 1.5, "source": ""}]}, "`key` or `keys`"),
        ({"target": []}, "target"),
        ({"goal": []}, "goal"),
        ({"soft_claim": [{"id": 3}]}, "weight"),
    ],
)
def test_wrong_file_is_explained(change: dict[str, object], message: str) -> None:
    tables = tomllib.loads(_core.config_text("calibration", "jeffs2019")) | change
    with pytest.raises(CalibrationError, match=message):
        parse(tables)


def test_soft_claims_add_residuals_and_need_all_scenarios() -> None:
    problem = replace(load("jeffs2019"), soft_claims={})
    with_claims = replace(problem, soft_claims={8: 1.0, 17: 1.0})
    shares = Residuals(problem).shares(current_values(problem))
    assert Residuals(with_claims)(shares).size == Residuals(problem)(shares).size + 2
    with pytest.raises(CalibrationError, match="soft claims"):
        Residuals(replace(with_claims, targets=with_claims.targets[:3]))
    with pytest.raises(CalibrationError, match="1 to 26"):
        Residuals(replace(problem, soft_claims={27: 1.0}))


def test_shares_and_values_are_inverse() -> None:
    for parameter in load("jeffs2019").parameters:
        for share in (0.0, 0.3, 1.0):
            assert parameter.to_share(parameter.from_share(share)) == pytest.approx(share, abs=1e-9)


def test_values_are_written_back_in_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    originals = {}
    for word, folder, name in (
        ("vehicle", "vehicles", "jeffs2019"),
        ("controller", "controllers", "hpcu"),
        ("scenario", "scenarios", "jeffs2019/case1-1"),
    ):
        path = tmp_path / "configs" / folder / f"{name}.toml"
        path.parent.mkdir(parents=True, exist_ok=True)
        originals[path] = _core.config_text(word, name)
        path.write_text(originals[path], encoding="utf-8")
    monkeypatch.setattr(calibrated_files, "checkout", lambda: tmp_path)
    new = {
        "vehicle.body.drag_area_m2": 0.7123,
        "vehicle.battery.usable_capacity.share[2]": 0.9321,
        "scenario.heat_demand.cabin_w": 5001.0,
        "controller.cabin_pid.integral": 1.25,
    }
    assert set(calibrated_files.write_back(load("jeffs2019"), new)) == set(originals)
    changed = 0
    for path, original in originals.items():
        for old, now in zip(
            original.splitlines(), path.read_text(encoding="utf-8").splitlines(), strict=True
        ):
            changed += old != now
            assert old.partition("#")[2] == now.partition("#")[2]
            assert old == now or "#" not in old or old.index("#") == now.index("#")
    assert changed == len(new)
    vehicle = tomllib.loads((tmp_path / "configs/vehicles/jeffs2019.toml").read_text(encoding="utf-8"))
    assert vehicle["body"]["drag_area_m2"] == 0.7123
    assert vehicle["battery"]["usable_capacity"]["share"][2] == 0.9321


def test_files_that_differ_from_what_is_compiled_in_are_left_alone(
    tmp_path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "configs" / "vehicles" / "jeffs2019.toml"
    path.parent.mkdir(parents=True)
    path.write_text(_core.config_text("vehicle", "jeffs2019") + "\n# edited\n", encoding="utf-8")
    monkeypatch.setattr(calibrated_files, "checkout", lambda: tmp_path)
    with pytest.raises(CalibrationError, match="build first"):
        calibrated_files.write_back(load("jeffs2019"), {"vehicle.body.drag_area_m2": 0.7})


def test_writing_back_needs_a_checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibrated_files.hp_gym, "__file__", str(tmp_path / "hp_gym" / "__init__.py"))
    with pytest.raises(CalibrationError, match="checkout"):
        calibrated_files.checkout()
