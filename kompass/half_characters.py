"""Half of a surrogate pair in JSON: no character, and no UTF-8 has it, though Python's texts do."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any, TypeAlias

Steps: TypeAlias = tuple[str | int, ...]

WHY = "the text holds half of a surrogate pair, which is no character"
REMEDY = "send characters beyond U+FFFF as both of their halves, or as UTF-8"

_IN_TEXT = re.compile(r"\\u[dD][89a-fA-F]|[\ud800-\udfff]")
_IN_BYTES = re.compile(rb"\\u[dD][89a-fA-F]|\xed[\xa0-\xbf]")


def may_hold_half(raw: str | bytes | bytearray) -> bool:
    """Whether it is worth a look: JSON of whole characters only is told at a glance, mostly."""
    found = _IN_TEXT.search(raw) if isinstance(raw, str) else _IN_BYTES.search(raw)
    return found is not None


def half_characters(data: Any) -> Iterator[tuple[Steps, str]]:
    """Texts and keys of JSON data that hold half of a surrogate pair, with the way to them."""
    waiting: list[tuple[Steps, Any]] = [((), data)]
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, str):
            if not _is_unicode(value):
                yield path, value
        elif isinstance(value, list):
            waiting += [((*path, n), value[n]) for n in reversed(range(len(value)))]
        elif isinstance(value, dict):
            for key, item in reversed(value.items()):
                if _is_unicode(key):
                    waiting.append(((*path, key), item))
                else:
                    yield path, key


def _is_unicode(text: str) -> bool:
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True
