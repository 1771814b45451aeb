"""The record of a run: tables and pictures."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot as plt

import hp_gym
from hp_gym import vehicle_layout
from hp_gym.files import atomic_write
from hp_gym.pictures import panels
from hp_gym.pictures.plotting import plot


def read_csv(path: Path) -> pd.DataFrame:
    # Numbers as text first: pandas 2 itself rounds their last digit.
    return pd.read_csv(path, dtype=str).astype(float)


@pytest.fixture(scope="module")
def trajectory() -> hp_gym.Trajectory:
    return hp_gym.simulate("ours/thermal-battery")


@pytest.mark.parametrize(("name", "read"), [("run.csv", read_csv), ("run.parquet", pd.read_parquet)])
def test_a_saved_table_reads_back_as_it_was(
    trajectory: hp_gym.Trajectory, tmp_path: Path, name: str, read: Callable[[Path], pd.DataFrame]
) -> None:
    path = tmp_path / name
    path.write_text("something older")
    trajectory.save(path)
    table = read(path)
    np.testing.assert_array_equal(table.to_numpy(dtype=float), trajectory.values)
    assert tuple(table.columns) == trajectory.columns
    assert [file.name for file in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("name", ["run.txt", "run", "run.csv.gz"])
def test_another_suffix_is_refused(trajectory: hp_gym.Trajectory, tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"\.csv, \.parquet"):
        trajectory.save(tmp_path / name)
    with pytest.raises(ValueError, match=r"\.png, \.svg, \.pdf"):
        plot(trajectory, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_named_and_left_alone(
    trajectory: hp_gym.Trajectory, tmp_path: Path
) -> None:
    missing = tmp_path / "missing" / "run.csv"
    with pytest.raises(FileNotFoundError) as caught:
        trajectory.save(missing)
    assert caught.value.filename == str(missing)
    file = tmp_path / "file"
    file.touch()
    with pytest.raises(NotADirectoryError):
        trajectory.save(file / "run.parquet")
    folder = tmp_path / "folder.csv"
    folder.mkdir()
    with pytest.raises(IsADirectoryError) as caught_folder:
        trajectory.save(folder)
    assert caught_folder.value.filename == str(folder)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.csv"]


def test_a_write_that_fails_keeps_the_older_file(tmp_path: Path) -> None:
    path = tmp_path / "result.txt"
    path.write_text("older")

    def write_half() -> None:
        with atomic_write(path) as temporary:
            temporary.write_text("half")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        write_half()
    assert path.read_text() == "older"
    assert list(tmp_path.iterdir()) == [path]


def test_a_trajectory_cannot_be_changed(trajectory: hp_gym.Trajectory) -> None:
    with pytest.raises(ValueError, match="read-only"):
        trajectory["soc"][0] = 0.0
    table = trajectory.to_pandas()
    table.loc[0, "soc"] = 0.0
    assert trajectory["soc"][0] == pytest.approx(1.0)
    with pytest.raises(KeyError, match="no_such_column"):
        trajectory["no_such_column"]
    assert len(trajectory) == len(table)


@pytest.mark.parametrize(("suffix", "magic"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_a_picture_is_written(
    trajectory: hp_gym.Trajectory, tmp_path: Path, suffix: str, magic: bytes
) -> None:
    path = tmp_path / f"run.{suffix}"
    plot(trajectory, path)
    assert path.read_bytes().startswith(magic)
    assert list(tmp_path.iterdir()) == [path]
    assert plt.get_fignums() == []


def test_a_picture_has_units_at_every_axis(trajectory: hp_gym.Trajectory) -> None:
    figure = plot(trajectory)
    try:
        assert plt.get_fignums() == [figure.number]
        labelled = [axes for axes in figure.axes if axes.get_title(loc="left") != "Connections"]
        assert len(labelled) == len(figure.axes) - 1
        assert all(axes.get_ylabel().startswith("[") for axes in labelled)
        assert all(axes.lines for axes in labelled)
    finally:
        plt.close(figure)


@pytest.mark.parametrize(
    "vehicle", [name for name in hp_gym.names("vehicle") if name.startswith("jeffs2019")]
)
def test_the_picture_of_a_run_shows_what_the_vehicle_has(vehicle: str) -> None:
    run = hp_gym.simulate("jeffs2019/case1-1", vehicle=vehicle)
    layout = vehicle_layout.typed(run.layout)
    shown = panels.of(layout)
    columns = {curve.column for panel in shown if isinstance(panel, panels.Panel) for curve in panel.curves}
    assert columns <= set(run.columns)
    own = {loop[side] for loop in layout["loops"] for side in ("supply", "return")}
    own |= {heater["power"] for heater in layout["heaters"]}
    own |= {each["flow"] for each in layout["exchangers"]} | {each["flow"] for each in layout["branches"]}
    own |= {member["temperature"] for member in layout["members"] if member["temperature"] is not None}
    assert own <= columns
    assert ("compressor_power_w" in columns) == layout["refrigerates"]
    limits = {name for panel in shown if isinstance(panel, panels.Panel) for name in panel.limits}
    assert {name for name in run.limits if not name.startswith("cabin_")} <= limits
    connected = [member["connection"] for member in layout["members"] if member["connection"] is not None]
    bars = [panel for panel in shown if isinstance(panel, panels.Connections)]
    assert sorted(column for panel in bars for column, _ in panel.members) == sorted(connected)
    figure = plot(run)
    try:
        assert len(figure.axes) == len(shown)
        lines = {
            (line.get_color(), line.get_linestyle(), line.get_label())
            for axes in figure.axes
            for line in axes.lines
        }
        labels = [label for _, _, label in lines if not str(label).startswith("_")]
        heat_flows = [panel for panel in shown if isinstance(panel, panels.Panel) and panel.hide_idle]
        looks = [(curve.colour, curve.style) for panel in heat_flows for curve in panel.curves]
        assert len(set(looks)) == len(looks)
        assert {
            curve.label for panel in heat_flows for curve in panel.curves if run[curve.column].any()
        } <= set(labels)
    finally:
        plt.close(figure)


def test_a_saved_table_knows_its_vehicle(tmp_path: Path) -> None:
    run = hp_gym.simulate("jeffs2019/case1-1", vehicle="jeffs2019-direct")
    run.save(tmp_path / "run.parquet")
    assert vehicle_layout.of_table(pd.read_parquet(tmp_path / "run.parquet")) == run.layout


def test_an_unknown_column_says_what_is_near(trajectory: hp_gym.Trajectory) -> None:
    with pytest.raises(KeyError, match="did you mean `cabin_temperature_degc`"):
        trajectory["cabin_temperature_c"]


def test_a_data_set_has_units_and_the_same_values(trajectory: hp_gym.Trajectory) -> None:
    data = trajectory.to_xarray()
    assert data["cabin_temperature_degc"].attrs["units"] == trajectory.units["cabin_temperature_degc"]
    assert data.sizes == {"time_s": len(trajectory)}
    assert data.attrs["energy_kwh"] == trajectory.summary["energy_kwh"]
    for name in trajectory.columns:
        np.testing.assert_array_equal(data[name].to_numpy(), trajectory[name])


def test_a_notebook_shows_totals_and_picture(trajectory: hp_gym.Trajectory) -> None:
    shown = trajectory._repr_html_()
    assert "ours/thermal-battery with" in shown
    assert f"{trajectory.summary['energy_kwh']:.6g}" in shown
    assert "data:image/png;base64," in shown
