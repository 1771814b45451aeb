"""Where a vehicle's values come from, as their comments say: published, derived, assumed or fitted.

A comment behind a value of a TOML file begins with its status:

    mass_kg = 1636.0             # published, SOURCE
    cell_capacity_ah = 41.66     # derived, FROM WHAT
    ua_w_k = 900.0               # assumed, 500..1500: REASON
    proportional_loss = 0.08     # fitted, 0.03..0.12: REASON FOR THE RANGE

Ranges are in the value's unit; `times 0.8..1.25` is a range of factors on it. In a list that has a line for
each element, each may have a comment of its own; one behind the key, or where the list opens, is for all. One
behind a `[section]` is for all values of it and of its parts that have none. Any other comment is for people.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, Literal, cast, get_args

Status = Literal["published", "derived", "assumed", "fitted"]
"""What a value rests on; `fitted` is the result of a calibration."""

Path = tuple[str | int, ...]
"""Keys and positions from the outermost section to a value."""

_NUMBER: Final = r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?"
_STATUS: Final = re.compile(
    rf"(?P<status>{'|'.join(get_args(Status))})"
    rf"(?:, (?P<times>times )?(?P<low>{_NUMBER})\.\.(?P<high>{_NUMBER}))?(?:[,:;]\s*(?P<source>.*))?"
)
_STRING_OR_COMMENT: Final = re.compile(r'"(?:\\.|[^"\\])*"|\'[^\']*\'|(#.*)')
_KEY: Final = re.compile(
    r'\s*((?:[\w-]+|"[^"]*"|\'[^\']*\')(?:\s*\.\s*(?:[\w-]+|"[^"]*"|\'[^\']*\'))*)\s*=(.*)'
)
_HEADER: Final = re.compile(r"\s*\[([^\[\]]+)\]\s*")


@dataclass(frozen=True)
class Provenance:
    """What a comment says of a value.

    Attributes:
        status: What the value rests on.
        source: Who published it, what it is derived from, or why it and its range were assumed; may be empty.
        low: Lower end of its range, in the value's unit or as a factor; None without one.
        high: Upper end of its range.
        factors: Whether the range is one of factors.
    """

    status: Status
    source: str
    low: float | None = None
    high: float | None = None
    factors: bool = False

    def holds(self, value: object) -> bool:
        """Whether every number of a value is in the range; true for one that has no numbers."""
        if self.low is None or self.high is None:
            return True
        low, high = self.low, self.high
        found = [1.0] if self.factors else list(numbers(value))
        return all(low <= number <= high for number in found)


def numbers(value: object) -> Iterator[float]:
    """Yields all numbers of a value, those of lists within lists too."""
    if isinstance(value, list):
        for inner in value:
            yield from numbers(inner)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)


def parsed(comment: str) -> Provenance | None:
    """Returns what a comment says; None if it does not begin with a status."""
    found = _STATUS.fullmatch(comment.lstrip("#").strip())
    if found is None:
        return None
    low, high = (None if end is None else float(end) for end in (found["low"], found["high"]))
    return Provenance(cast("Status", found["status"]), found["source"] or "", low, high, bool(found["times"]))


def comments(text: str) -> dict[Path, Provenance]:
    """Returns what the comments of a TOML file say of its values, lists and sections, by their paths."""
    told: dict[Path, Provenance] = {}
    section: Path = ()
    key: Path = ()
    depth = element = 0
    for line in text.splitlines():
        code, said = _split(line)
        if depth == 0:
            header, assignment = _HEADER.fullmatch(code), _KEY.fullmatch(code)
            if header is not None:
                section = key = _keys(header[1])
            elif assignment is not None:
                key, code, element = section + _keys(assignment[1]), assignment[2], 0
            else:
                continue
            places = [key]
            depth, element = _scan(code, depth, element) if assignment is not None else (0, 0)
        else:
            first = element
            depth, element = _scan(code, depth, element)
            places = [(*key, place) for place in range(first, element)]
        if said is not None:
            told.update(dict.fromkeys(places, said))
    return told


def of(told: dict[Path, Provenance], path: Path) -> Provenance | None:
    """Returns what is said of a value: behind it, or behind the innermost list or section around it."""
    around = (told.get(path[:length]) for length in range(len(path), 0, -1))
    return next((said for said in around if said is not None), None)


def _split(line: str) -> tuple[str, Provenance | None]:
    """A line without its texts and comment, and what that says."""
    said = None
    kept, end = [], 0
    for found in _STRING_OR_COMMENT.finditer(line):
        kept.append(line[end : found.start()])
        end = found.end()
        if found[1] is not None:
            said = parsed(found[1])
        else:
            # A quoted key stays one; brackets and commas of other texts do not count.
            kept.append(re.sub(r"[\[\],={}]", "_", found[0]))
    kept.append(line[end:])
    return "".join(kept), said


def _keys(dotted: str) -> Path:
    return tuple(key.strip().strip("\"'") for key in dotted.split("."))


def _scan(code: str, depth: int, element: int) -> tuple[int, int]:
    """Depth of lists behind a piece of a value, and elements of the outermost list that have begun."""
    begun = False
    for letter in code:
        if letter == "]":
            depth -= 1
        elif letter == "," and depth == 1:
            begun = False
        elif not letter.isspace() and letter != ",":
            if depth == 1 and not begun:
                element, begun = element + 1, True
            if letter == "[":
                depth += 1
    return depth, element


def leaves(table: dict[str, Any], path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Yields path and value of everything in a table that is not a table itself."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from leaves(value, (*path, key))
        else:
            yield (*path, key), value
