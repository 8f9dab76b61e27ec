"""Which components are meant to be active, remembered beyond the death of their process."""

from __future__ import annotations

import mmap
from collections.abc import Mapping


class DesiredState:
    """One flag for each component, in memory that parent and children share.

    A component that a rule or a person had stopped stays stopped when its process dies and is
    started again, and one that was started comes back active. Made before the fork.

    Parameters
    ----------
    active
        Whether each component, by name, is meant to be active at first.
    """

    def __init__(self, active: Mapping[str, bool]) -> None:
        self._index = {name: index for index, name in enumerate(active)}
        self._flags = mmap.mmap(-1, max(1, len(active)))
        for name, is_active in active.items():
            self.set(name, is_active)

    def is_active(self, name: str) -> bool:
        """Whether a component is meant to be active."""
        return bool(self._flags[self._index[name]])

    def set(self, name: str, active: bool) -> None:
        """Remember whether a component is meant to be active from now on."""
        self._flags[self._index[name]] = int(active)
