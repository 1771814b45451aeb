"""What a replay is made of: samples at full seconds, figures, and traces that are refused."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hp_gym.studies import csv_columns
from hp_gym.studies.csv_columns import ColumnError
from hp_gym.studies.replay import measured_trace, trip_figures
from hp_gym.studies.replay.full_seconds import at_full_seconds
from hp_gym.studies.replay.measured_trace import TraceError
from hp_gym.studies.replay.series_errors import series_errors

numbers = st.floats(-1e5, 1e5)


@given(st.lists(numbers, min_size=2, max_size=50))
def test_values_of_every_second_stay_as_they_are(values: list[float]) -> None:
    assert at_full_seconds(np.arange(len(values), dtype=float), np.array(values)).tolist() == values


@given(st.lists(st.tuples(st.floats(0.05, 0.85), numbers), min_size=4, max_size=60))
def test_means_of_fast_samples_keep_their_integral(samples: list[tuple[float, float]]) -> None:
    times_s = np.cumsum([0.0, *(step for step, _ in samples[1:])])
    values = np.array([value for _, value in samples])
    # A last second that is missed by the round-off of a clock is filled up.
    assume(abs(times_s[-1] - round(times_s[-1])) > 2e-3)
    seconds = at_full_seconds(times_s, values)
    last_s = np.floor(times_s[-1])
    inside = times_s < last_s
    ends = np.append(times_s[inside], last_s)
    line = np.append(values[inside], np.interp(last_s, times_s, values))
    integral = float(np.sum(0.5 * (line[1:] + line[:-1]) * np.diff(ends)))
    assert len(seconds) == last_s + 1
    assert seconds[0] == values[0]
    assert seconds[1:].sum() == pytest.approx(integral, abs=1e-9 * max(1.0, np.abs(values).max()))


def test_a_last_second_that_a_clock_misses_by_round_off_counts() -> None:
    times_s = np.array([0.0, 1.0, 1.9999])
    assert at_full_seconds(times_s, np.array([1.0, 2.0, 3.0])).tolist() == [1.0, 2.0, 3.0]
    fast_s = np.append(np.arange(20) / 10.0, 1.9999)
    assert at_full_seconds(fast_s, np.full(21, 7.0)) == pytest.approx([7.0, 7.0, 7.0])


def test_ten_samples_a_second_count_as_their_mean() -> None:
    times_s = np.arange(41) / 10.0
    # A sine of 5 Hz has no mean; a ramp has that of half a second before.
    seconds = at_full_seconds(times_s, 100.0 * np.sin(10.0 * np.pi * times_s + 0.3) + 20.0 * times_s)
    assert seconds[1:] == pytest.approx([10.0, 30.0, 50.0, 70.0], abs=1e-9)


def test_slow_samples_are_joined_by_lines() -> None:
    seconds = at_full_seconds(np.array([0.0, 4.0, 6.5]), np.array([0.0, 8.0, 3.0]))
    assert seconds.tolist() == [0.0, 2.0, 4.0, 6.0, 8.0, 6.0, 4.0]


def test_figures_of_a_trip_that_can_be_reckoned_by_hand() -> None:
    seconds = np.arange(601.0)
    measured = {
        "battery_power_w": np.full(601, 7200.0),
        "heater_power_w": np.where(seconds <= 300.0, 3600.0, 1200.0),
        "cabin_temperature_degc": seconds / 20.0,
        "battery_temperature_degc": 5.0 + seconds / 300.0,
    }
    figures = trip_figures.figures(measured, {})
    assert {name: pair.model for name, pair in figures.items()} == dict.fromkeys(figures)
    assert figures["energy_kwh"].measured == pytest.approx(1.2)
    # 300 s, half the step down, 299 s.
    heating_kwh = (300.0 * 3600.0 + 2400.0 + 299.0 * 1200.0) / 3.6e6
    assert figures["heating_energy_kwh"].measured == pytest.approx(heating_kwh)
    assert figures["drive_energy_kwh"].measured == pytest.approx(1.2 - heating_kwh)
    assert figures["heater_last_300_s_w"].measured == pytest.approx(1200.0)
    assert figures["battery_rise_k"].measured == pytest.approx(2.0)
    # 18 degC after 360 s, above it at the end of each of the 240 s that follow.
    assert figures["cabin_above_18_degc_s"].measured == 240.0


def test_a_heater_is_averaged_over_a_trip_that_is_shorter_than_300_s() -> None:
    power_w = np.append(0.0, np.arange(1.0, 101.0))
    pair = trip_figures.figures({"heater_power_w": power_w}, {})["heater_last_300_s_w"]
    assert pair.measured == pytest.approx(50.5)


def test_what_was_not_measured_is_none() -> None:
    figures = trip_figures.figures(
        {"battery_power_w": np.ones(10)},
        {"battery_power_w": np.ones(10), "heater_power_w": np.zeros(10)},
    )
    assert figures["energy_kwh"].deviation == 0.0
    for name in ("drive_energy_kwh", "heating_energy_kwh", "heater_last_300_s_w"):
        assert figures[name].measured is None
        assert figures[name].model is not None
        assert figures[name].deviation is None
    assert figures["battery_rise_k"] == trip_figures.Pair(None, None)


def test_errors_second_by_second() -> None:
    measured = {"cabin_temperature_degc": np.array([0.0, 1.0, 2.0, 3.0])}
    model = {"cabin_temperature_degc": np.array([0.0, 2.0, 4.0, 2.0]), "heater_power_w": np.zeros(4)}
    (error,) = series_errors(measured, model)
    assert error.quantity.name == "cabin_temperature_degc"
    assert (error.bias, error.rmse, error.largest) == (0.5, pytest.approx(np.sqrt(6.0 / 4.0)), 2.0)


def trace(folder: Path, *rows: str, head: str = "time_s,speed_km_h,measured_heater_power_w") -> Path:
    path = folder / "trip.csv"
    path.write_text("\n".join([" # a comment", head, *rows, ""]), encoding="utf-8")
    return path


def test_measured_columns_are_read_from_a_trace_that_starts_anywhere(tmp_path: Path) -> None:
    path = trace(tmp_path, "100.5,0,5", "", "101.5,3,7", "102.5,4,8", "103.2,4,9")
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().removeprefix(b" # a comment\n"))
    found = measured_trace.of(csv_columns.read(path))
    assert found.columns == ("time_s", "speed_km_h", "measured_heater_power_w")
    assert found.first == {"heater_power_w": 5.0}
    assert found.channels["heater_power_w"].tolist() == [5.0, 7.0, 8.0]


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (["0,0,1", "1,1,", "2,1,1"], ["line 4", "`measured_heater_power_w` is empty", "finite number"]),
        (["0,0,1", "1,1,nan"], ["line 4", "`measured_heater_power_w` is `nan`", "finite number"]),
        (["0,0,1", "1,1,warm"], ["line 4", "is `warm`"]),
        (["0,0,1", "1,1"], ["line 4", "no cell for column `measured_heater_power_w`"]),
        (["0,0,1", "1,1,2,3"], ["line 4", "has 4 cells", "must have 3"]),
    ],
)
def test_cells_that_are_no_numbers_are_refused(rows: list[str], words: list[str], tmp_path: Path) -> None:
    path = trace(tmp_path, *rows)
    with pytest.raises(ColumnError) as caught:
        csv_columns.read(path).numbers("measured_heater_power_w")
    for word in (str(path), *words):
        assert word in str(caught.value)


def test_names_that_are_doubtful_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ColumnError, match="column `time_s` is there twice"):
        csv_columns.read(trace(tmp_path, "0,0", head="time_s,time_s"))
    columns = csv_columns.read(trace(tmp_path, "0,0,1"))
    with pytest.raises(ColumnError, match="no column `speed_m_h`; did you mean `speed_km_h`"):
        columns.numbers("speed_m_h")


def test_a_battery_whose_power_is_in_kilowatts_is_refused(tmp_path: Path) -> None:
    path = trace(tmp_path, "0,4.5", "1,12", "2,-20.1", head="time_s,measured_battery_power_w")
    with pytest.raises(TraceError, match=r"beyond 20\.1 W, .* is it in kW\?"):
        measured_trace.of(csv_columns.read(path))


def test_cells_may_be_empty_where_gaps_are_asked_for(tmp_path: Path) -> None:
    columns = csv_columns.read(trace(tmp_path, "0,0,1", "1,,nan", "2,5,inf"))
    assert np.isnan(columns.numbers("speed_km_h", gaps=True)).tolist() == [False, True, False]
    with pytest.raises(ColumnError, match="`inf`"):
        columns.numbers("measured_heater_power_w", gaps=True)
    (tmp_path / "trip.csv").write_bytes(b"\n# nothing\n")
    with pytest.raises(ColumnError, match="is empty"):
        csv_columns.read(tmp_path / "trip.csv")
