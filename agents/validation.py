"""Errors of pydantic in one line."""

from pydantic import ValidationError
from pydantic_core import ErrorDetails


def one_line(error: ValidationError) -> str:
    """Returns the first error with place, value and what was allowed, and the number of further ones."""
    details = error.errors(include_url=False)
    others = f" (and {len(details) - 1} more)" if len(details) > 1 else ""
    return _tell(details[0]) + others


def _tell(error: ErrorDetails) -> str:
    place = ".".join(str(part) for part in error["loc"]) or "as a whole"
    if error["type"] == "extra_forbidden":
        return f"`{place}` is unknown"
    if error["type"] == "missing":
        return f"`{place}` is missing"
    reason = error["msg"].removeprefix("Value error, ")
    reason = reason[0].lower() + reason[1:]
    if error["type"] in {"json_invalid", "value_error"}:
        return f"`{place}`: {reason}"
    return f"`{place}` is {_short(error['input'])}, but {reason.replace('input should', 'should')}"


def _short(value: object) -> str:
    shown = repr(value)
    return shown if len(shown) <= 60 else f"{shown[:57]}..."
