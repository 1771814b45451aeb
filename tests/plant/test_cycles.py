"""The drive cycles against the figures known of them."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

CYCLES = Path(__file__).resolve().parents[2] / "configs" / "cycles"
KM_H_PER_MPH = 1.609344
KM_PER_MILE = 1.609344


@dataclass(frozen=True)
class Figures:
    points: int
    distance_km: float
    max_speed_km_h: float
    tolerance_km: float = 0.003


# WLTC: GTR 15. NEDC: R83; its 11.007 km rounds the ECE 15 cycle to 1.013 km before taking it four times.
# UDDS, HWFET, US06: EPA, to 0.01 mile. Artemis, WMTC: not published but read from the files, so that a change
# shows.
FIGURES = {
    "wltc-class3b": Figures(1801, 23.266, 131.3),
    "wltc-class2": Figures(1801, 22.649, 123.1),
    "nedc": Figures(1181, 11.007, 120.0, tolerance_km=0.01),
    "udds": Figures(1370, 7.45 * KM_PER_MILE, 56.7 * KM_H_PER_MPH, tolerance_km=0.01),
    "hwfet": Figures(766, 10.26 * KM_PER_MILE, 59.9 * KM_H_PER_MPH, tolerance_km=0.01),
    "us06": Figures(601, 8.01 * KM_PER_MILE, 80.3 * KM_H_PER_MPH, tolerance_km=0.01),
    "wmtc-class3": Figures(1801, 28.915, 125.3),
    "wmtc-part3-twice": Figures(1201, 31.474, 125.3),
    "artemis-urban": Figures(994, 4.870, 57.7),
    "artemis-road": Figures(1082, 17.272, 111.5),
    "artemis-motorway-130": Figures(1068, 28.736, 131.8),
    "artemis-motorway-150": Figures(1068, 29.545, 150.4),
}


def speed_column(cycle: str) -> list[str]:
    lines = (CYCLES / f"{cycle}.csv").read_text(encoding="utf-8").splitlines()
    names, *rows = [line for line in lines if not line.startswith("# ")]
    assert names == "time_s,speed_km_h"
    times, speeds = zip(*(row.split(",") for row in rows), strict=True)
    assert list(times) == [str(second) for second in range(len(rows))]
    return list(speeds)


def sha256_of_lines(lines: list[str]) -> str:
    return hashlib.sha256("".join(f"{line}\n" for line in lines).encode()).hexdigest()


def distance_km(speed_km_h: np.ndarray) -> float:
    return float((speed_km_h[1:] + speed_km_h[:-1]).sum()) / 2 / 3600


def test_every_cycle_is_checked() -> None:
    assert {path.stem for path in CYCLES.glob("*.csv")} == set(FIGURES)


@pytest.mark.parametrize("cycle", FIGURES)
def test_cycle_has_its_length_distance_and_top_speed(cycle: str) -> None:
    figures = FIGURES[cycle]
    speed_km_h = np.array(speed_column(cycle), dtype=np.float64)

    assert len(speed_km_h) == figures.points
    assert distance_km(speed_km_h) == pytest.approx(figures.distance_km, abs=figures.tolerance_km)
    assert speed_km_h.max() == pytest.approx(figures.max_speed_km_h, abs=1e-3)
    assert speed_km_h.min() == 0.0
    assert speed_km_h[0] == 0.0
    assert speed_km_h[-1] == 0.0


@pytest.mark.parametrize("cycle", FIGURES)
def test_header_tells_source_and_checksum_of_the_speeds(cycle: str) -> None:
    text = (CYCLES / f"{cycle}.csv").read_text(encoding="utf-8")

    for field in ("published in", "taken from", "licence"):
        assert f"\n# {field}: " in text
    assert f": {sha256_of_lines(speed_column(cycle))}\n" in text


def test_wltc_is_the_regulations_own_speed_trace() -> None:
    speeds = speed_column("wltc-class3b")
    expected = "d0c488566907763fc8a8f73b94ffd5ee9b59a4849bbb907b4e0b4d7151832a74"

    assert sha256_of_lines(speeds) == expected
    # GTR 15 publishes the sum of the speeds as the trace's checksum.
    assert sum(round(float(speed) * 10) for speed in speeds) == 837_586


@pytest.mark.parametrize(
    ("first_s", "last_s", "phase_km"),
    [(0, 589, 3.095), (589, 1022, 4.756), (1022, 1477, 7.162), (1477, 1800, 8.254)],
    ids=["low", "medium", "high", "extra-high"],
)
def test_wltc_phases_have_their_published_distances(first_s: int, last_s: int, phase_km: float) -> None:
    speed_km_h = np.array(speed_column("wltc-class3b"), dtype=np.float64)

    assert distance_km(speed_km_h[first_s : last_s + 1]) == pytest.approx(phase_km, abs=5e-4)


def test_nedc_operations_start_when_the_regulation_says() -> None:
    speed_km_h = np.array(speed_column("nedc"), dtype=np.float64)

    assert np.flatnonzero(speed_km_h)[0] == 12  # first start at 11 s
    assert speed_km_h[15] == 15.0
    assert np.flatnonzero(speed_km_h[780:])[0] == 21  # EUDC starts after 20 s
    np.testing.assert_array_equal(speed_km_h[1:196], speed_km_h[196:391])


def test_us_cycles_are_in_tenths_of_mph() -> None:
    for cycle in ("udds", "hwfet", "us06"):
        tenths = np.array(speed_column(cycle), dtype=np.float64) / KM_H_PER_MPH * 10
        np.testing.assert_allclose(tenths, np.round(tenths), atol=0.005)
