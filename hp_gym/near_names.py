"""What somebody may have meant who wrote a name that there is not."""

from collections.abc import Iterable
from difflib import get_close_matches


def suggestion(name: str, known: Iterable[str]) -> str:
    """Returns words that go after a message: the names that are near, or nothing."""
    near = get_close_matches(name, list(known), n=3, cutoff=0.6)
    return f"; did you mean {' or '.join(f'`{one}`' for one in near)}?" if near else ""


def unknown(what: str, name: str, known: Iterable[str]) -> str:
    """Returns a message: there is no such thing, and what is near or, where nothing is, what there is."""
    names = list(known)
    others = suggestion(name, names) or f"; there are {', '.join(names)}"
    return f"there is no {what} `{name}`{others}"
