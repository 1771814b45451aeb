"""Errors of pydantic in one line."""

from pydantic import ValidationError
from pydantic_core import ErrorDetails


def one_line(error: ValidationError, skip: str = "") -> str:
    """Returns the first error with place, value and what was allowed, and the number of further ones.

    Args:
        error: What pydantic raised.
        skip: First part of a place that is no key: the tag of a union.
    """
    details = error.errors(include_url=False)
    others = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
    return _tell(details[0], skip) + others


def _tell(error: ErrorDetails, skip: str) -> str:
    parts = [str(part) for part in error["loc"]]
    if parts and parts[0] == skip:
        parts = parts[1:]
    place = ".".join(parts)
    reason = error["msg"].removeprefix("Value error, ")
    match error["type"]:
        case "extra_forbidden":
            return f"`{place}` is unknown"
        case "missing":
            return f"`{place}` is missing"
        case "union_tag_not_found":
            return "`algorithm` is missing"
        case "union_tag_invalid":
            context = error.get("ctx", {})
            return f"`algorithm` is {context['tag']!r}, but must be one of {context['expected_tags']}"
        case "json_invalid" | "value_error":
            return f"`{place}`: {reason}" if place else reason
    allowed = reason[0].lower() + reason[1:]
    return f"`{place}` is {_short(error['input'])}, but {allowed.replace('input should', 'should')}"


def _short(value: object) -> str:
    shown = repr(value)
    return shown if len(shown) <= 60 else f"{shown[:57]}..."
