"""Places that heat passes on its way through a vehicle, and how its flows join them.

Inner places are the coolant loops and the air of each cabin: what they take in, they give away. Everything
else is an end. Something that both gives and takes, such as a battery, is two ends (`Battery`, `To battery`),
and so is a cabin whose heat goes back to a loop: otherwise heat would run in circles, which no diagram can
show.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from hp_gym.vehicle_layout import capitalised, short_loop

if TYPE_CHECKING:
    from hp_gym.vehicle_layout import Cabin, Exchanger, Layout, Link, Loop, Source

Row = tuple[str, str, str, tuple[str, str] | None]
"""Column, source, target, and both where the net flow is negative; see `energy_flows.Flow`."""

AMBIENT: Final = ("Ambient air", "To ambient air")
"""Ambient as a source and as a sink."""


class HeatPlaces:
    """Places of one vehicle.

    Args:
        layout: What the vehicle is made of.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._loops: dict[str, Loop] = {
            node: loop for loop in layout["loops"] for node in (loop["supply"], loop["return"])
        }
        self._cabins: dict[str, Cabin] = {cabin["air"]: cabin for cabin in layout["cabins"]}
        self._labels = {each["name"]: each["label"] for each in layout["members"]}
        self._ends = self._two_ends()
        self._branches = {branch["flow"] for branch in layout["branches"]}
        self._powers = {heater["power"]: heater["label"] for heater in layout["heaters"]}
        self._powers |= {loop["pump_power"]: "Pumps" for loop in layout["loops"]}
        for cabin in layout["cabins"]:
            self._powers[cabin["blower_power"]] = "Blower"
            self._powers[cabin["solar"]] = "Sun"
            self._powers[cabin["solar_soft_furnishings"]] = "Sun"
            self._powers[cabin["solar_hard_furnishings"]] = "Sun"
            self._powers[cabin["occupants"]] = "Occupants"
            if cabin["latent"] is not None:
                self._powers[cabin["latent"]] = "Condensing water"

    def links(self) -> list[Link]:
        """Returns the links of the network that touch an inner place, each column once."""
        seen: dict[str, Link] = {}
        for link in self._layout["links"]:
            ends = {self._inner(link["loses"]), self._inner(link["gains"])}
            if ends - {None} and len(ends) == 2:
                seen.setdefault(link["flow"], link)
        return list(seen.values())

    def of_link(self, link: Link) -> list[Row]:
        """Returns a link of the network as links of a diagram."""
        column, loses, gains = link["flow"], link["loses"], link["gains"]
        source, target = self._inner(loses), self._inner(gains)
        if source is not None and target is not None:
            if self._runs_in_circles(loses, gains):
                return self._split(column, source, target)
            return [(column, source, target, (target, source))]
        if source is not None:
            comes, goes = self._outer(gains, column, loses)
            return [(column, source, goes, (comes, source))]
        assert target is not None, "links() gives links of inner places only"
        comes, goes = self._outer(loses, column, gains)
        return [(column, comes, target, (target, goes))]

    def of_source(self, source: Source) -> list[Row]:
        """Returns heat that is set free in an inner place; nothing for other places."""
        place = self._inner(source["node"])
        name = self._powers.get(source["flow"])
        if name is None:
            return []
        return [(source["flow"], name, place or self._ends[source["node"]][1], None)]

    def of_exchanger(self, exchanger: Exchanger, refrigerant: str) -> list[Row]:
        """Returns the heat between refrigerant and what an exchanger is in."""
        column, condenses = exchanger["flow"], exchanger["level"] == "condensing"
        if exchanger["side"] == "front-end":
            return [
                (column, refrigerant, AMBIENT[1], None)
                if condenses
                else (column, AMBIENT[0], refrigerant, None)
            ]
        if exchanger["side"] == "loop":
            loop = next(each for each in self._layout["loops"] if each["name"] == exchanger["on"])
            place = capitalised(loop["label"])
        else:
            place = self._air(
                next(each for each in self._layout["cabins"] if each["member"] == exchanger["on"])
            )
        if condenses:
            return [(column, refrigerant, place, None)]
        if exchanger["side"] == "cabin":
            return self._split(column, place, refrigerant, returns=False)
        return [(column, place, refrigerant, None)]

    def stores(self) -> list[tuple[str, str, str]]:
        """Returns the inner places, with the name of the heat that they kept and of that which they gave."""
        stores = []
        for loop in self._layout["loops"]:
            name = f"{capitalised(short_loop(self._layout, loop))} coolant"
            stores.append((capitalised(loop["label"]), f"{name}, warmed", f"{name}, cooled"))
        for cabin in self._layout["cabins"]:
            name = "Air" if len(self._layout["cabins"]) == 1 else self._air(cabin)
            stores.append((self._air(cabin), f"{name}, warmed", f"{name}, cooled"))
        return stores

    def _air(self, cabin: Cabin) -> str:
        return f"{capitalised(self._labels[cabin['member']])} air"

    def _inner(self, node: str | None) -> str | None:
        """Name of the inner place that a node belongs to."""
        if node in self._loops:
            return capitalised(self._loops[node]["label"])
        return self._air(self._cabins[node]) if node in self._cabins else None

    def _two_ends(self) -> dict[str, tuple[str, str]]:
        """Names of the outer nodes as a source and as a sink."""
        ends = {}
        for member in self._layout["members"]:
            if member["temperature"] is not None:
                ends[member["temperature"]] = capitalised(member["label"]), f"To {member['label']}"
        for cabin in self._layout["cabins"]:
            ends[cabin["soft_furnishings"]] = ends[cabin["hard_furnishings"]] = (
                "Warm furnishings",
                "Furnishings",
            )
        return ends

    def _outer(self, node: str | None, column: str, inner: str | None) -> tuple[str, str]:
        """Names of the end of a link to an inner place, as a source and as a sink."""
        exhaust = {cabin["exhaust"]: cabin for cabin in self._layout["cabins"]}
        if node in exhaust:
            from_cabin = inner in self._cabins
            return ("Warm fresh air", "Ventilation") if from_cabin else ("Exhaust air", "To exhaust air")
        if node is not None:
            return self._ends[node]
        if inner in self._cabins:
            return "Warm panels", "Cabin panels"
        loop = self._loops.get(str(inner))
        if loop is not None and loop["side"] == "hot" and column not in self._branches:
            return AMBIENT[0], f"{loop['label']} hoses"
        return AMBIENT

    def _runs_in_circles(self, loses: str | None, gains: str | None) -> bool:
        """Whether heat could come back that goes this way: from a cabin to a loop, between hot and cold."""
        if loses in self._cabins:
            return True
        source, target = self._loops.get(str(loses)), self._loops.get(str(gains))
        return source is not None and target is not None and source["side"] != target["side"]

    @staticmethod
    def _split(column: str, source: str, target: str, *, returns: bool = True) -> list[Row]:
        """A flow that ends in one place and begins anew in the next."""
        begin, end = source.removesuffix(" air"), f"To {_inside(target)}"
        back = f"From {_inside(target)}"
        begun = f"From {_inside(source)}" if begin == source else begin
        return [
            (column, begun, target, (target, f"To {_inside(begin)}") if returns else None),
            (column, source, end, (back, source) if returns else None),
        ]


def _inside(name: str) -> str:
    """A name within a sentence: abbreviations stay as they are."""
    return name if name[1:2].isupper() else name[:1].lower() + name[1:]
