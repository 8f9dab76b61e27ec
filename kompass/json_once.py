"""JSON in which no key may be given twice: the second would silently win."""

from __future__ import annotations

import json
from typing import Any


class GivenTwice(ValueError):
    """A key of an object is given twice; the message says which, and what to do."""


def read_json(text: str) -> Any:
    """What a text of JSON says.

    Raises
    ------
    GivenTwice
        A key is given twice.
    json.JSONDecodeError
        It is no JSON.
    """
    return json.loads(text, object_pairs_hook=_once)


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise GivenTwice(f"'{twice}' is given twice; keep one")
    return found
