"""What the errors of this package have in common: one line that is short enough to read."""

from typing import Final

LONGEST_MESSAGE: Final = 500
"""Characters of a message; of a longer one the middle is left out, as its ends say what and where."""


def in_one_line(message: str) -> str:
    """Returns a message without line breaks, at most `LONGEST_MESSAGE` characters of it."""
    # Much longer texts are cut before their words are looked at.
    line = " ".join(_cut(message, 4 * LONGEST_MESSAGE).split())
    printable = "".join(
        character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in line
    )
    return _cut(printable, LONGEST_MESSAGE)


def _cut(text: str, length: int) -> str:
    if len(text) <= length:
        return text
    half = (length - 5) // 2
    return f"{text[:half]} ... {text[-half:]}"


class OneLineError(ValueError):
    """A value, file or folder that cannot be used; the message says which and why, in one line."""

    def __init__(self, message: str) -> None:
        super().__init__(in_one_line(message))


class FileError(OneLineError):
    """A file that is not read: too large, too deep, no regular file, or not what it should be."""


class InUseError(OneLineError):
    """A folder that another process writes results to."""


class UncheckedFileWarning(UserWarning):
    """A file without a checksum, older or of another maker: its values were checked one by one instead."""
