"""A message as data, short enough for a journal."""

from __future__ import annotations

import array
import itertools
import math
from typing import Any

import numpy as np
from pydantic import JsonValue

ITEMS = 16  # of a list
TEXT = 500  # characters


def brief(value: Any) -> JsonValue:
    """A message as JSON data; long lists and texts are cut, and say so.

    The work does not grow with the message: a map costs no more than a pose.
    """
    fields = getattr(value, "get_fields_and_field_types", None)
    if fields is not None:
        return {name: brief(getattr(value, name)) for name in fields()}
    if isinstance(value, list | tuple | array.array | np.ndarray | bytes):
        made = [brief(item) for item in itertools.islice(value, ITEMS)]
        if len(value) > ITEMS:
            made.append(f"… {len(value)} items")
        return made
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if value is None or isinstance(value, bool | int | float):
        return value
    text = str(value)
    return text if len(text) <= TEXT else text[: TEXT - 1] + "…"
