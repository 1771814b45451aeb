"""The components of a vehicle in a row: their order, how wide each is, and what stands between them."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Final

from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.plan import ABOVE, BELOW, SIDES, Place
from hp_gym.vehicle_layout import branches_of, capitalised, loop_of, short_heater, spelled

if TYPE_CHECKING:
    from hp_gym.vehicle_layout import Layout, Member

LABEL_WIDTH: Final = 15
"""Letters in a line of a component's label."""


def in_row(layout: Layout) -> list[Member]:
    """Returns components from the left: those in series, then by their loops, so that pipes seldom cross."""
    cold = [loop["name"] for loop in layout["loops"] if loop["side"] == "cold"]
    orders = {loop["name"]: loop["series"] for loop in layout["loops"]}
    last = len(layout["members"])

    def rank(member: Member) -> tuple[bool, int, int, bool, bool]:
        reached = [branch["loop"] for branch in branches_of(layout, member)]
        air = any(each["on"] == member["name"] for each in layout["exchangers"])
        series = next(
            (orders[loop].index(member["name"]) for loop in reached if member["name"] in orders[loop]), last
        )
        last_cold = max((cold.index(loop) for loop in reached if loop in cold), default=0)
        hot = any(loop not in cold for loop in reached)
        return (
            not reached and not air,
            series,
            last_cold,
            not hot and not air,
            member["kind"] != "cabin",
        )

    return sorted(layout["members"], key=rank)


def pairs_of(layout: Layout, member: Member) -> dict[float, list[str]]:
    """Returns names of the lines, above and below, that have a pair of pipes to a component."""
    pairs: dict[float, list[str]] = {ABOVE: [], BELOW: []}
    loops = [branch["loop"] for branch in branches_of(layout, member)]
    loops += [
        cabin["exhaust_recovery"]
        for cabin in layout["cabins"]
        if cabin["member"] == member["name"] and cabin["exhaust_recovery"] is not None
    ]
    for loop in dict.fromkeys(loops):
        pairs[SIDES[loop_of(layout, loop)["side"]]].append(loop)
    for exchanger in layout["exchangers"]:
        if exchanger["side"] != "loop" and exchanger["on"] == member["name"]:
            pairs[SIDES[exchanger["level"]]].append(exchanger["name"])
    return pairs


def places_of(
    layout: Layout, members: list[Member], pairs: dict[str, dict[float, list[str]]], left: float
) -> tuple[tuple[Place, ...], dict[str, float]]:
    """Returns the components, and where the first heater of each loop stands."""
    on_loops = [heater["heats"] for heater in layout["heaters"] if heater["side"] == "loop"]
    most = max((on_loops.count(loop) for loop in on_loops), default=0)
    places: list[Place] = []
    heaters_at: dict[str, float] = {}
    pipe = at.MEMBER_HALF_WIDTH - at.LEG_OFFSET
    edge = left + 5.0 - pipe
    for number, member in enumerate(members):
        if most and not heaters_at and not any(branch["series"] for branch in branches_of(layout, member)):
            # Behind the last pipe of what is in series.
            last_pipe = places[-1].right - pipe if places else left
            first = last_pipe + at.HEATER_MARGIN + at.HEATER_HALF_WIDTH
            heaters_at = dict.fromkeys(on_loops, first)
            past = first + (most - 1) * at.HEATER_PITCH + at.HEATER_HALF_WIDTH + at.HEATER_MARGIN
            edge = past - pipe
        elif number:
            edge += _gap(layout, members[number - 1], member)
        heaters = [
            each for each in layout["heaters"] if each["heats"] == member["name"] and each["side"] == "member"
        ]
        above, below = pairs[member["name"]][ABOVE], pairs[member["name"]][BELOW]
        slots = max(1, len(above) + len(heaters), len(below))
        right = edge + 2.0 * at.MEMBER_HALF_WIDTH + (slots - 1) * at.SLOT
        standing = tuple(
            (edge + at.MEMBER_HALF_WIDTH + (len(above) + number) * at.SLOT, short_heater(each), each["power"])
            for number, each in enumerate(heaters)
        )
        temperature = "ambient_temperature_degc" if member["kind"] == "front-end" else member["temperature"]
        places.append(
            Place(member["name"], _label(member), member["kind"], temperature, edge, right, standing)
        )
        edge = right + at.SLOT - 2.0 * at.MEMBER_HALF_WIDTH
    if most and not heaters_at:
        heaters_at = dict.fromkeys(on_loops, edge + at.HEATER_MARGIN + at.HEATER_HALF_WIDTH)
    return tuple(places), heaters_at


def _gap(layout: Layout, before: Member, member: Member) -> float:
    """What two neighbours stand further apart, for the ends of loops between them."""
    if before["kind"] == "plate":
        return at.PLATE_GAP
    loops = [{branch["loop"] for branch in branches_of(layout, each)} for each in (before, member)]
    below = [{loop for loop in some if loop_of(layout, loop)["side"] == "cold"} for some in loops]
    return at.BOUNDARY if below[0] and below[1] and not below[0] & below[1] else 0.0


def _label(member: Member) -> tuple[str, ...]:
    """A component's label in one line or two; its name where the label is too long."""
    for text in (capitalised(member["label"]), capitalised(spelled(member["name"]))):
        lines = [text] if len(text) <= 12 else textwrap.wrap(text, max(LABEL_WIDTH - 3, len(text) // 2 + 1))
        if len(lines) <= 2 and max(map(len, lines)) <= LABEL_WIDTH:
            return tuple(lines)
    return tuple(textwrap.wrap(capitalised(spelled(member["name"])), LABEL_WIDTH)[:2])
