"""Text from outside, made fit to be logged and shown: short, and of one line."""

from __future__ import annotations

from pydantic import JsonValue

LONGEST_NAME = 40  # characters of a person's name
LONGEST_LABEL = 200  # of what something on the robot is called
LONGEST_TEXT = 500  # of a reason, a message, the name of a rule

_CUT = "…"
_MOST_ITEMS = 200  # of a list
_DEEPEST = 20
_LONGEST_LINES = 2000  # characters of a text of several lines
_MOST_LINES = 60


def plain(text: object, longest: int = LONGEST_TEXT) -> str:
    """`text` without control characters and line ends, and at most `longest` characters long.

    What is taken out are also marks that turn the direction of writing round, and those that no
    eye sees: with them a name could look like another one.
    """
    # A text of megabytes is not looked at as a whole.
    head = str(text)[: 4 * longest]
    line = " ".join("".join(c if c.isprintable() else " " for c in head).split())
    return line if len(line) <= longest else line[: longest - 1] + _CUT


def plain_lines(text: str, longest: int = _LONGEST_LINES) -> str:
    """As :func:`plain`, of a text whose lines and indentation say something, as a traceback's do.

    Lines that are too many are cut off, as letters are.
    """
    lines = text[: 4 * longest].splitlines()
    kept = []
    for line in lines[:_MOST_LINES]:
        bare = line.lstrip(" \t")
        indent = len(line) - len(bare)
        kept.append(" " * min(indent, _DEEPEST) + plain(bare, longest))
    if len(lines) > _MOST_LINES:
        kept.append(_CUT)
    whole = "\n".join(kept).strip("\n")
    return whole if len(whole) <= longest else whole[: longest - 1] + _CUT


def plain_json(value: JsonValue, depth: int = 0) -> JsonValue:
    """`value` with all its texts plain, its lists and its depth bounded."""
    if isinstance(value, str):
        return plain(value)
    if depth > _DEEPEST:
        return None
    if isinstance(value, list):
        return [plain_json(each, depth + 1) for each in value[:_MOST_ITEMS]]
    if isinstance(value, dict):
        some = list(value.items())[:_MOST_ITEMS]
        return {plain(name): plain_json(each, depth + 1) for name, each in some}
    return value
