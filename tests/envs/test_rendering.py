"""The picture of the plant."""

import numpy as np
import pytest
from numpy.typing import NDArray

from hp_gym import Experiment, observe, signals
from hp_gym.pictures.rendering import Renderer, colours, quantities

SCENARIO = "jeffs2019/case1-1"


@pytest.fixture(scope="module")
def run() -> NDArray[np.float64]:
    values, _, _ = Experiment(SCENARIO).simulate()
    return values


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    return Renderer()


def at(run: NDArray[np.float64], time_s: int) -> dict[str, float]:
    return dict(zip(signals.NAMES, run[time_s].tolist(), strict=True))


def speeds(run: NDArray[np.float64]) -> NDArray[np.float64]:
    return run[:, signals.COLUMNS["speed_m_s"]]


@pytest.mark.parametrize("size", [(960, 540), (480, 270), (1281, 721), (600, 900)])
def test_a_picture_has_the_size_asked_for(run: NDArray[np.float64], size: tuple[int, int]) -> None:
    width, height = size
    picture = Renderer(width, height).render(at(run, 600), speeds(run))
    assert picture.shape == (height, width, 3)
    assert picture.dtype == np.uint8
    assert picture.flags.writeable
    assert picture.std() > 10.0


def test_the_same_moment_gives_the_same_picture(run: NDArray[np.float64], renderer: Renderer) -> None:
    first = renderer.render(at(run, 600), speeds(run))
    other = renderer.render(at(run, 900), speeds(run))
    again = renderer.render(at(run, 600), speeds(run).tolist())
    assert not np.shares_memory(first, again)
    assert np.array_equal(first, again)
    assert np.array_equal(first, Renderer().render(at(run, 600), list(speeds(run))))
    assert not np.array_equal(first, other)


@pytest.mark.parametrize(
    ("name", "loop"),
    [
        ("battery_connection", 2.0),
        ("cabin_connection", 0.0),
        ("ambient_connection", 1.0),
        ("motor_connection", 0.0),
        ("transmission_connection", 2.0),
        ("thermal_battery_connection", 1.0),
        ("thermal_battery_connection", 2.0),
    ],
)
def test_a_connection_shows(run: NDArray[np.float64], renderer: Renderer, name: str, loop: float) -> None:
    now = at(run, 600)
    before = renderer.render(now, speeds(run))
    after = renderer.render({**now, name: loop}, speeds(run))
    assert not np.array_equal(before, after)


@pytest.mark.parametrize("name", [name for name in quantities.SIGNALS if not name.endswith("_connection")])
def test_every_signal_shows(run: NDArray[np.float64], renderer: Renderer, name: str) -> None:
    now = {**at(run, 600), "thermal_battery_connection": 1.0, "transmission_connection": 2.0}
    if name.endswith("_chiller_heat_flow_w"):
        now[name.replace("chiller_heat_flow_w", "connection")] = 2.0
    elif name.endswith("_htc_heat_flow_w"):
        now[name.replace("htc_heat_flow_w", "connection")] = 1.0
    changed = {**now, name: 0.5 * now[name] + 500.0}
    assert not np.array_equal(renderer.render(now, speeds(run)), renderer.render(changed, speeds(run)))


def test_targets_show(run: NDArray[np.float64], renderer: Renderer) -> None:
    now = at(run, 600)
    pictures = [
        renderer.render(now, speeds(run)),
        renderer.render(now, speeds(run), 18.0),
        renderer.render(now, speeds(run), 22.0, 30.0),
    ]
    assert len({picture.tobytes() for picture in pictures}) == 3


def test_the_cursor_moves_over_its_own_strip_only(run: NDArray[np.float64], renderer: Renderer) -> None:
    now = at(run, 600)
    later = renderer.render({**now, "time_s": 1200.0}, speeds(run))
    rows = np.flatnonzero((renderer.render(now, speeds(run)) != later).any(axis=(1, 2)))
    # The clock is in the header.
    assert not ((rows > 40) & (rows < 428)).any()
    assert (rows > 428).any()


def test_a_vehicle_before_its_first_step_can_be_drawn(renderer: Renderer) -> None:
    experiment = Experiment(SCENARIO)
    assert renderer.render(observe(experiment.start()), [0.0]).std() > 10.0


@pytest.mark.parametrize("value", [0.0, float("nan"), float("inf"), -float("inf"), 1e12, -1e12])
@pytest.mark.parametrize("loop", [0.0, 1.0, 2.0])
def test_any_number_can_be_drawn(renderer: Renderer, value: float, loop: float) -> None:
    now = {name: loop if name.endswith("_connection") else value for name in signals.NAMES}
    assert renderer.render(now, [0.0, 1.0, 2.0]).std() > 10.0


def test_a_missing_signal_is_named(run: NDArray[np.float64], renderer: Renderer) -> None:
    now = at(run, 600)
    del now["cop"]
    with pytest.raises(KeyError, match="lacks: cop"):
        renderer.render(now, speeds(run))


def test_only_known_signals_are_asked_for() -> None:
    assert set(quantities.SIGNALS) <= set(signals.NAMES)


@pytest.mark.parametrize("wrong", [[], [[0.0, 1.0]], [0.0, float("nan")], [0.0, -1.0]])
def test_a_drive_cycle_that_is_none_is_refused(
    run: NDArray[np.float64], renderer: Renderer, wrong: list[float]
) -> None:
    with pytest.raises(ValueError, match="speeds_m_s"):
        renderer.render(at(run, 600), wrong)


@pytest.mark.parametrize(
    ("size", "message"),
    [((0, 540), "width is 0 pixels; 480 to 2560"), ((960, 10_000), "height is 10000 pixels; 270 to 1440")],
)
def test_a_size_out_of_range_is_refused(size: tuple[int, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Renderer(*size)


def test_a_size_that_is_no_whole_number_is_refused() -> None:
    with pytest.raises(TypeError, match=r"width is a whole number of pixels, not 960\.5"):
        Renderer(960.5)  # type: ignore[arg-type]


def test_warmer_is_redder() -> None:
    redness = [of[0] - of[2] for of in map(colours.of_temperature, [-10.0, 0.0, 10.0, 22.0, 40.0, 60.0])]
    assert redness == sorted(redness)
    assert len({*redness}) == len(redness)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (-0.04, "0.0"),
        (-3.26, "\N{MINUS SIGN}3.3"),
        (float("nan"), quantities.UNKNOWN),
        (float("inf"), quantities.UNKNOWN),
    ],
)
def test_a_number_reads_well(value: float, text: str) -> None:
    assert quantities.number(value) == text
