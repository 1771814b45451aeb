"""The picture of the plant."""

import numpy as np
import pytest
from numpy.typing import NDArray

from hp_gym import Experiment, names, observe, signals, vehicle_layout
from hp_gym.pictures.rendering import Renderer, canvas, colours, quantities
from hp_gym.pictures.rendering.planner import plan_of

SCENARIO = "jeffs2019/case1-1"
SIGNALS = plan_of(vehicle_layout.default()).signals()
CARS = [name for name in names("vehicle") if name.startswith("jeffs2019")]


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


@pytest.mark.parametrize("name", [name for name in SIGNALS if not name.endswith("_connection")])
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
    assert set(SIGNALS) <= set(signals.NAMES)


class Seen:
    """Texts of a picture with the boxes that they take, in pixels."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.texts: list[tuple[str, tuple[float, float, float, float]]] = []
        write = canvas.Canvas.text

        def seen(
            self_: canvas.Canvas, at: canvas.Point, text: str, size: float, *rest: object, **options: object
        ) -> None:
            write(self_, at, text, size, *rest, **options)  # type: ignore[arg-type]
            font = canvas._font(bool(options.get("bold")), size * self_.scale)
            anchor = str(options.get("anchor", "mm"))
            left, top, right, bottom = font.getbbox(text, anchor=anchor)
            x, y = self_.pixel(at)
            self.texts.append((text, (x + left, y + top, x + right, y + bottom)))

        monkeypatch.setattr(canvas.Canvas, "text", seen)

    def words(self) -> str:
        return " | ".join(text for text, _ in self.texts)

    def overlapping(self) -> list[tuple[str, str]]:
        # The drive cycle is drawn twice, as it looks before and after.
        texts = list(dict.fromkeys(self.texts))
        return [
            (one, other)
            for place, (one, a) in enumerate(texts)
            for other, b in texts[:place]
            if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
        ]


def all_open(vehicle: str, loop: int) -> dict[str, float]:
    """A moment at which as much as possible is to be seen, its numbers as wide as they come."""
    layout = Experiment(SCENARIO, vehicle=vehicle).layout()
    now = dict.fromkeys(Experiment(SCENARIO, vehicle=vehicle).signal_names, -1.0)
    for name in now:
        if name.endswith("_w"):
            now[name] = 12_345.0
        elif name.endswith("_degc"):
            now[name] = -12.3
        elif name.endswith("_connection"):
            now[name] = float(loop % (len(layout["loops"]) + 1))
    return now | {"time_s": 100.0, "speed_m_s": 35.0, "soc": 1.0, "cop": 10.0}


@pytest.mark.parametrize("loop", [0, 1, 2, 3])
@pytest.mark.parametrize("vehicle", CARS)
def test_every_vehicle_shows_what_it_has_and_nothing_overlaps(
    vehicle: str, loop: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    layout = vehicle_layout.typed(Experiment(SCENARIO, vehicle=vehicle).layout())
    seen = Seen(monkeypatch)
    picture = Renderer(1280, 720).render(all_open(vehicle, loop), [30.0] * 1800, layout=layout)
    assert picture.std() > 10.0
    words = seen.words()
    drawn = plan_of(layout)
    assert [place.name for place in drawn.places if " | ".join(place.label) not in words] == []
    assert {place.name for place in drawn.places} == {member["name"] for member in layout["members"]}
    loops_shown = [vehicle_layout.capitalised(loop["label"]) for loop in layout["loops"]]
    exchangers = [
        vehicle_layout.capitalised(vehicle_layout.exchanger_label(layout, each))
        for each in layout["exchangers"]
    ]
    heaters = [vehicle_layout.short_heater(heater) for heater in layout["heaters"]]
    texts = [text for text, _ in seen.texts]
    assert [name for name in [*loops_shown, *exchangers, *heaters] if name not in texts] == []
    assert ("Compressor" in texts) == layout["refrigerates"]
    pairs = {(leg.member, line.name) for line in drawn.lines for leg in line.legs if line.level is None}
    assert {(branch["member"], branch["loop"]) for branch in layout["branches"]} <= pairs
    assert seen.overlapping() == []


@pytest.mark.parametrize("loop", [0.0, 1.0, 2.0, 3.0])
def test_a_vehicle_that_needs_more_room_is_drawn_smaller(
    loop: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    layout = Experiment(SCENARIO, vehicle="jeffs2019-three-loops").layout()
    branch = {"series": False, "direction": "into-loop", "flow": "battery_chiller_heat_flow_w"}
    layout["branches"].append({"member": "battery", "loop": "chiller", **branch})
    seat = {
        "name": "pad",
        "label": "Pad heater",
        "side": "member",
        "heats": "battery",
        "power": "pad_power_w",
    }
    second = {
        "name": "second",
        "label": "Second heater",
        "side": "loop",
        "heats": "htc",
        "power": "second_power_w",
    }
    layout["heaters"] += [seat, second]
    air = {"side": "cabin", "on": "cabin", "flow": "cabin_condenser_heat_flow_w", "valve": None}
    layout["exchangers"].append({"name": "cabin_condenser", "level": "condensing", **air})
    drawn = plan_of(vehicle_layout.typed(layout))
    assert drawn.scale < 0.8
    assert max(line.track for line in drawn.lines) == 1
    now = {
        name: loop if name.endswith("_connection") else -12.3 if name.endswith("_degc") else 3210.0
        for name in drawn.signals()
    }
    seen = Seen(monkeypatch)
    Renderer(1280, 720).render(
        now
        | {
            "soc": 1.0,
            "cop": 3.0,
            "speed_m_s": 30.0,
            "condensing_pressure_bar": 12.3,
            "evaporating_pressure_bar": 1.2,
        },
        [30.0] * 1800,
        layout=layout,
    )
    texts = {text for text, _ in seen.texts}
    assert {"Pad", "Second", "PTC", "Cabin condenser", "Chiller loop", "Battery loop", "HTC"} <= texts
    assert seen.overlapping() == []


def test_no_vehicle_shows_what_only_others_have(monkeypatch: pytest.MonkeyPatch) -> None:
    layouts = {car: vehicle_layout.typed(Experiment(SCENARIO, vehicle=car).layout()) for car in CARS}
    own = {
        car: {vehicle_layout.capitalised(loop["label"]) for loop in layout["loops"]}
        | {
            vehicle_layout.capitalised(vehicle_layout.exchanger_label(layout, e))
            for e in layout["exchangers"]
        }
        | {" | ".join(place.label) for place in plan_of(layout).places}
        for car, layout in layouts.items()
    }
    every = set().union(*own.values())
    for car, layout in layouts.items():
        with monkeypatch.context() as patch:
            seen = Seen(patch)
            Renderer().render(all_open(car, 1), [0.0, 1.0], layout=layout)
            texts = {text for text, _ in seen.texts}
            words = seen.words()
        lacked = every - own[car]
        assert {name for name in lacked if (name in texts if " | " not in name else name in words)} == set()


def test_one_renderer_draws_one_vehicle_after_another() -> None:
    renderer = Renderer()
    for car in (*CARS, *CARS):
        experiment = Experiment(SCENARIO, vehicle=car)
        now = observe(experiment.start())
        picture = renderer.render(now, [0.0, 1.0], layout=experiment.layout())
        assert np.array_equal(picture, Renderer().render(now, [0.0, 1.0], layout=experiment.layout()))


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
