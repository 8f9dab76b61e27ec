"""Parameters of algorithms that hold to their bounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import ClassVar

# Least and largest value of a parameter that has no bounds of its own.
USUAL_BOUNDS = (0.0, 1000.0)


@dataclass(frozen=True, kw_only=True)
class BoundedParams:
    """What is not finite or out of its bounds is a ValueError."""

    # Least and largest values by name, where they are not the usual ones.
    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {}

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            least, most = self.bounds.get(item.name, USUAL_BOUNDS)
            # Not a number is in no bounds.
            if isinstance(value, (int, float)) and not least <= value <= most:
                raise ValueError(f"{item.name}: {value}; give from {least:g} to {most:g}")
