"""Finds where everything of a vehicle stands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hp_gym.pictures.rendering import positions as at
from hp_gym.pictures.rendering.component_row import in_row, pairs_of, places_of
from hp_gym.pictures.rendering.lines import air_lines, coolant_lines, on_tracks
from hp_gym.pictures.rendering.plan import Plan

if TYPE_CHECKING:
    from hp_gym.vehicle_layout import Layout


def plan_of(layout: Layout) -> Plan:
    """Returns where everything of a vehicle stands."""
    rail_left = at.EXCHANGER_RIGHT if layout["refrigerates"] else at.RAIL_LEFT_ALONE
    members = in_row(layout)
    pairs = {member["name"]: pairs_of(layout, member) for member in members}
    places, heaters_at = places_of(layout, members, pairs, rail_left + at.NUMBERS_WIDTH)
    lines = [*coolant_lines(layout, places, pairs, heaters_at), *air_lines(layout, places, pairs)]
    in_series = {branch["member"] for branch in layout["branches"] if branch["series"]}
    marked = tuple(place.name for place in places if place.name not in in_series)
    return Plan(layout, places, on_tracks(lines, rail_left), rail_left, marked)
