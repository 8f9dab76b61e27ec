"""Names of scenarios, in the order in which a person counts."""

from __future__ import annotations

import re


def natural(name: str) -> tuple[tuple[int, str], ...]:
    """A key to sort by: ``7-9`` comes before ``7-10``."""
    parts = re.findall(r"[0-9]+|[^0-9]+", name)
    return (*((int(part), "") if part.isdecimal() else (-1, part) for part in parts), (-2, name))
