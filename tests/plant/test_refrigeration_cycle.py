"""The Rust refrigeration loop against CoolProp and TESPy at 20 points of each built-in refrigerant."""

import shutil
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("CoolProp")
pytest.importorskip("tespy")
sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))

import check_refrigeration_cycle as check

Rust = tuple[dict[str, Any], list[check.Point]]

pytestmark = [
    pytest.mark.rust,
    pytest.mark.skipif(shutil.which("cargo") is None, reason="needs cargo to run the Rust example"),
]


@pytest.fixture(scope="module", params=check.REFRIGERANTS)
def rust(request: pytest.FixtureRequest) -> Rust:
    return check.rust_points(request.param)


def test_twenty_points_take_the_power_that_is_asked_for(
    rust: Rust,
) -> None:
    _, points = rust
    assert len(points) == 20
    assert {point["status"] for point in points} == {"Converged"}


def test_cycle_agrees_with_coolprop(rust: Rust) -> None:
    parameters, points = rust
    for point in points:
        expected = check.coolprop_cycle(parameters, point)
        for name, deviation in check.deviations(point, expected).items():
            assert abs(deviation) < check.TOLERANCE, (name, deviation, point)
        for name in ("evaporating_temperature_k", "condensing_temperature_k", "discharge_temperature_k"):
            assert point[name] == pytest.approx(expected[name], abs=0.05), (name, point)
        assert point["speed_rev_s"] == pytest.approx(expected["speed_rev_s"], rel=check.TOLERANCE)


def test_cycle_agrees_with_tespy(rust: Rust) -> None:
    parameters, points = rust
    for point in points:
        for name, deviation in check.deviations(point, check.tespy_cycle(parameters, point)).items():
            assert abs(deviation) < check.TOLERANCE, (name, deviation, point)
