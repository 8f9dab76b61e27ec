"""Text from outside, made fit to be logged and shown: short, and of one line."""

from __future__ import annotations

LONGEST_NAME = 40  # characters of a person's name
LONGEST_TEXT = 500  # of a reason, a message, the name of a rule

_CUT = "…"


def plain(text: object, longest: int = LONGEST_TEXT) -> str:
    """`text` without control characters and line ends, and at most `longest` characters long.

    What is taken out are also marks that turn the direction of writing round, and those that no
    eye sees: with them a name could look like another one.
    """
    # A text of megabytes is not looked at as a whole.
    head = str(text)[: 4 * longest]
    line = " ".join("".join(c if c.isprintable() else " " for c in head).split())
    return line if len(line) <= longest else line[: longest - 1] + _CUT
