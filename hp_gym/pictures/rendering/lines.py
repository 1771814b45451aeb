"""Coolant loops and lines of refrigerant: what they reach, and on which track each lies."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.plan import SIDES, Box, Leg, Line
from hp_gym.vehicle_layout import branches_of, capitalised, exchanger_label, recovery_flow, short_heater

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hp_gym.pictures.rendering.plan import Place
    from hp_gym.vehicle_layout import Exchanger, Layout, Loop


def coolant_lines(
    layout: Layout,
    places: Sequence[Place],
    pairs: Mapping[str, Mapping[float, list[str]]],
    heaters_at: Mapping[str, float],
) -> list[Line]:
    """Returns the coolant loops with what they reach, not yet on a track.

    Args:
        layout: What the vehicle is made of.
        places: Its components.
        pairs: Names of the lines, above and below, that have a pair of pipes to each component.
        heaters_at: Where the first heater of each loop stands.
    """
    return [
        Line(
            loop["name"],
            capitalised(loop["label"]),
            SIDES[loop["side"]],
            number,
            loop["supply"],
            loop["return"],
            legs=tuple(
                _leg(layout, loop, place, _slot_x(place, reached, loop["name"]))
                for place in places
                for reached in (pairs[place.name][SIDES[loop["side"]]],)
                if loop["name"] in reached
            ),
            boxes=tuple(
                _box(layout, each)
                for each in layout["exchangers"]
                if (each["side"], each["on"]) == ("loop", loop["name"])
            ),
            plates=tuple(
                place.right
                for place in places
                for member in layout["members"]
                if member["name"] == place.name and member["from"] == loop["name"]
            ),
            heaters=_heaters(layout, loop, heaters_at),
        )
        for number, loop in enumerate(layout["loops"], start=1)
    ]


def air_lines(
    layout: Layout, places: Sequence[Place], pairs: Mapping[str, Mapping[float, list[str]]]
) -> list[Line]:
    """Returns a line for each pressure level of refrigerant that reaches air, not yet on a track."""
    lines = []
    for level in ("condensing", "evaporating"):
        side = SIDES[level]
        legs = tuple(
            Leg(
                place.name,
                _slot_x(place, pairs[place.name][side], each["name"]),
                (each["flow"],),
                to_line=level == "evaporating",
                exchanger=capitalised(exchanger_label(layout, each)),
            )
            for place in places
            for each in layout["exchangers"]
            if each["level"] == level and each["name"] in pairs[place.name][side]
        )
        if legs:
            lines.append(Line("refrigerant", f"Refrigerant, {level}", side, level=level, legs=legs))
    return lines


def _heaters(
    layout: Layout, loop: Loop, heaters_at: Mapping[str, float]
) -> tuple[tuple[float, str, str], ...]:
    own = [each for each in layout["heaters"] if (each["side"], each["heats"]) == ("loop", loop["name"])]
    return tuple(
        (heaters_at[loop["name"]] + place * at.HEATER_PITCH, short_heater(each), each["power"])
        for place, each in enumerate(own)
    )


def _slot_x(place: Place, names: list[str], name: str) -> float:
    return place.left + at.MEMBER_HALF_WIDTH + names.index(name) * at.SLOT


def _box(layout: Layout, exchanger: Exchanger) -> Box:
    label = capitalised(exchanger_label(layout, exchanger))
    return Box(label, exchanger["flow"], exchanger["level"], exchanger["valve"] is not None)


def _leg(layout: Layout, loop: Loop, place: Place, x: float) -> Leg:
    member = next(each for each in layout["members"] if each["name"] == place.name)
    branch = next((each for each in branches_of(layout, member) if each["loop"] == loop["name"]), None)
    recovery = next(
        (
            recovery_flow(layout, cabin)
            for cabin in layout["cabins"]
            if cabin["member"] == place.name and cabin["exhaust_recovery"] == loop["name"]
        ),
        None,
    )
    flows = tuple(name for name in (branch["flow"] if branch else None, recovery) if name is not None)
    to_line = branch is None or branch["direction"] == "into-loop"
    series = branch is not None and branch["series"]
    return Leg(place.name, x, flows, to_line, member["connection"], recovery, series)


def on_tracks(lines: list[Line], rail_left: float) -> tuple[Line, ...]:
    """Puts each line next to the components where the place is free, or else beyond the others."""
    placed: list[Line] = []
    for line in lines:
        ends = [end for leg in line.legs for end in (leg.x - at.LEG_OFFSET, leg.x + at.LEG_OFFSET)]
        ends += [x + offset for x, _, _ in line.heaters for offset in (-30.0, 30.0)]
        pipes = [right + offset for right in line.plates for offset in at.PLATE_PIPES]
        right = max([rail_left + at.NUMBERS_WIDTH, *ends, *pipes]) + at.RAIL_OVERHANG
        left = min([end - at.RAIL_OVERHANG for end in ends] + pipes, default=rail_left)
        if line.boxes or line.level:
            left = rail_left
        track = 0
        while any(
            other.side == line.side and other.track == track and left < other.right and other.left < right
            for other in placed
        ):
            track += 1
        placed.append(replace(line, track=track, left=left, right=right))
    return tuple(
        sorted((_to_the_left(line, placed, rail_left) for line in placed), key=lambda line: line.track)
    )


def _to_the_left(line: Line, lines: list[Line], rail_left: float) -> Line:
    """Lets a line begin at the left where nothing else does."""
    alone = all(
        other.left >= line.left for other in lines if (other.side, other.track) == (line.side, line.track)
    )
    at_plate = any(abs(right + at.PLATE_PIPES[0] - line.left) < 1.0 for right in line.plates)
    from_left = alone and not at_plate
    return replace(line, left=rail_left if from_left else line.left, from_left=from_left)
