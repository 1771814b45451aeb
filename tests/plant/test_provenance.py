"""What the comments of a vehicle's file say of its values."""

import pytest

from hp_gym.provenance import Provenance, comments, numbers, of, parsed


@pytest.mark.parametrize(
    ("comment", "expected"),
    [
        ("# published, Nissan 2016: 1516 kg", Provenance("published", "Nissan 2016: 1516 kg")),
        ("# derived, 30 kWh over 192 cells", Provenance("derived", "30 kWh over 192 cells")),
        ("# assumed, 0.6..0.95: sun meets seats", Provenance("assumed", "sun meets seats", 0.6, 0.95)),
        ("# assumed, -20..0; as in winter", Provenance("assumed", "as in winter", -20.0, 0.0)),
        ("# assumed, 1e-5..6e-5: damp", Provenance("assumed", "damp", 1e-5, 6e-5)),
        ("# assumed, times 0.8..1.25: scatter", Provenance("assumed", "scatter", 0.8, 1.25, factors=True)),
        ("# assumed: the usual one", Provenance("assumed", "the usual one")),
        ("# fitted, 600..1500: plates", Provenance("fitted", "plates", 600.0, 1500.0)),
        ("# assumed, 1..5", Provenance("assumed", "", 1.0, 5.0)),
    ],
)
def test_a_status_is_read_with_range_and_source(comment: str, expected: Provenance) -> None:
    assert parsed(comment) == expected


@pytest.mark.parametrize(
    "comment", ["# -40 degC", "# in the cabin's air", "# assumedly, 1..2: x", "#", "# ours, 1..2"]
)
def test_any_other_comment_says_nothing(comment: str) -> None:
    assert parsed(comment) is None


FILE = """
# published, a line of its own is for people
name = "a # of, [things]"  # assumed: a text
[body]
mass_kg = 1600.0 # published, A
drag.area_m2 = 0.7 # derived, B
"odd key" = 1 # derived, quoted
silent = 1.0
[battery.circuit] # assumed, times 0.5..2: the whole section
axis = [0.0, 1.0] # derived, C
rows = [ # published, D
    [1.0, 2.0], # -40 degC
    [3.0, 4.0], # assumed, 2..5: the second row
]
flat = [
    1.0, # fitted, 0..2: first
    2.0, 3.0, # derived, both
    4.0,
]
after = 5.0
[battery.circuit.part]
inner = 6.0
"""


def test_comments_are_found_at_values_elements_and_sections() -> None:
    told = comments(FILE)
    section = ("battery", "circuit")

    def source(*path: str | int) -> str | None:
        said = of(told, path)
        return said and said.source

    assert source("name") == "a text"
    assert source("body", "mass_kg") == "A"
    assert source("body", "drag", "area_m2") == "B"
    assert source("body", "odd key") == "quoted"
    assert source("body", "silent") is None
    assert source(*section, "axis") == "C"
    assert (source(*section, "rows", 0), source(*section, "rows", 1)) == ("D", "the second row")
    assert [source(*section, "flat", place) for place in range(4)] == [
        "first",
        "both",
        "both",
        "the whole section",
    ]
    assert source(*section, "after") == "the whole section"
    assert source(*section, "part", "inner") == "the whole section"


def test_a_range_holds_every_number_of_a_list_and_factors_hold_one() -> None:
    assert list(numbers([[1.0, 2], 3.0, "x", True])) == [1.0, 2.0, 3.0]
    assert Provenance("assumed", "", 1.0, 3.0).holds([[1.0], [3.0]])
    assert not Provenance("assumed", "", 1.0, 3.0).holds([[1.0], [3.1]])
    assert Provenance("assumed", "", 0.8, 1.2, factors=True).holds([100.0])
    assert not Provenance("assumed", "", 1.1, 1.2, factors=True).holds([1.15])
    assert Provenance("published", "x").holds(1.0)
