"""What a vehicle is made of, as pictures and studies need it: loops, members, branches, exchangers."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final, Literal, TypedDict, cast

from hp_gym import _core

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    import pandas as pd

ATTRIBUTE: Final = "layout"
"""Attribute of a table of signals that holds the layout of its vehicle, as JSON."""


# Keys that are words of Python.
_Return = TypedDict("_Return", {"return": str})
_From = TypedDict("_From", {"from": str | None})


class Loop(_Return):
    """A coolant loop; `return` and what follows `supply` are columns or names."""

    name: str
    label: str
    side: Literal["hot", "cold"]
    supply: str
    series: list[str]
    exchanger: str | None
    pump_power: str


class Member(_From):
    """Something that is tempered, or that tempers."""

    name: str
    label: str
    kind: Literal["battery", "motor", "transmission", "front-end", "store", "cabin", "plate"]
    temperature: str | None
    connection: str | None
    options: list[str]


class Branch(TypedDict):
    """Coolant of a loop that passes a member."""

    member: str
    loop: str
    series: bool
    direction: Literal["out-of-loop", "into-loop"]
    flow: str


class Exchanger(TypedDict):
    """A condenser or an evaporator."""

    name: str
    level: Literal["condensing", "evaporating"]
    side: Literal["loop", "cabin", "front-end"]
    on: str
    flow: str
    valve: str | None


class Heater(TypedDict):
    """An electrical heater."""

    name: str
    label: str
    side: Literal["loop", "member"]
    heats: str
    power: str


class Cabin(TypedDict):
    """Air of a cabin and what is around it."""

    member: str
    comfort: bool
    air: str
    exhaust: str
    soft_furnishings: str
    hard_furnishings: str
    exhaust_recovery: str | None
    blower_power: str
    solar: str
    solar_soft_furnishings: str
    solar_hard_furnishings: str
    occupants: str
    latent: str | None


class Link(TypedDict):
    """A heat flow between two nodes, or between a node and ambient."""

    flow: str
    loses: str | None
    gains: str | None


class Source(TypedDict):
    """Heat that is set free in a node, or taken from it."""

    flow: str
    node: str
    out: bool


class FlowRow(TypedDict):
    """A column of powers."""

    flow: str
    crossing: Literal["enters", "leaves", "inside"]


class Layout(TypedDict):
    """What a vehicle is made of, by the names of its columns; see `Experiment.layout`."""

    architecture: str
    refrigerates: bool
    sections: list[str]
    loops: list[Loop]
    members: list[Member]
    branches: list[Branch]
    exchangers: list[Exchanger]
    heaters: list[Heater]
    cabins: list[Cabin]
    flows: list[FlowRow]
    links: list[Link]
    sources: list[Source]


def default() -> Layout:
    """Returns the layout of the default architecture."""
    return cast("Layout", _core.architecture_layout("jeffs2019"))


def typed(told: Mapping[str, Any]) -> Layout:
    """Returns what `Experiment.layout()` told, or the layout of the default architecture in its place."""
    return cast("Layout", told) if told else default()


def keep(table: pd.DataFrame, layout: Mapping[str, Any]) -> pd.DataFrame:
    """Returns a table of signals that knows its vehicle; .parquet files keep that."""
    # As text, since pandas copies attributes at every access to a column.
    table.attrs[ATTRIBUTE] = json.dumps(layout)
    return table


def of_table(table: pd.DataFrame) -> Layout:
    """Returns the layout of the vehicle of a table of signals; the default one where it does not know."""
    return typed(json.loads(table.attrs.get(ATTRIBUTE, "{}")))


def spelled(name: str) -> str:
    """Returns a name as it is written in pictures."""
    return name.replace("_", " ")


def capitalised(text: str) -> str:
    """Returns a text with a large first letter, the rest as it was."""
    return text[:1].upper() + text[1:]


def short_loop(layout: Layout, loop: Loop) -> str:
    """Returns the shortest label of a loop that is not that of a member."""
    short = loop["label"].removesuffix(" loop")
    return loop["label"] if short in {member["label"] for member in layout["members"]} else short


def short_heater(heater: Heater) -> str:
    """Returns the label of a heater without the word `heater`."""
    return heater["label"].removesuffix(" heater")


def exchanger_label(layout: Layout, exchanger: Exchanger) -> str:
    """Returns the name of an exchanger as it is written in pictures, the names of loops as their labels."""
    labels = {loop["name"]: short_loop(layout, loop) for loop in layout["loops"]}
    return " ".join(labels.get(word, word) for word in exchanger["name"].split("_"))


def loop_of(layout: Layout, name: str) -> Loop:
    """Returns a loop by name."""
    return next(loop for loop in layout["loops"] if loop["name"] == name)


def branches_of(layout: Layout, member: Member) -> list[Branch]:
    """Returns the branches that pass a member."""
    return [branch for branch in layout["branches"] if branch["member"] == member["name"]]


def recovery_flow(layout: Layout, cabin: Cabin) -> str | None:
    """Returns the heat flow from a cabin's exhaust air to a loop; none where nothing recovers it."""
    return next(
        (link["flow"] for link in layout["links"] if link["loses"] == cabin["exhaust"] and link["gains"]),
        None,
    )


def in_order(layout: Layout) -> list[Member]:
    """Returns the members as pictures list them: cabins first."""
    return sorted(layout["members"], key=lambda member: member["kind"] != "cabin")
