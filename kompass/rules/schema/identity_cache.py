"""What is worked out of something immutable, once for as long as that lives."""

from collections.abc import Callable
from typing import Generic, TypeVar
from weakref import ref

K = TypeVar("K")
V = TypeVar("V")


class IdentityCache(Generic[K, V]):
    """A function of one immutable object that works out each of its answers once.

    Objects are told apart by identity: rules are not hashable, for arguments of actions are
    dictionaries, and equality takes ``1`` for ``True``. An answer is forgotten with its object. May
    be called from any thread; two that ask at once may both work it out.

    Parameters
    ----------
    work
        Must answer the same for the same object, always.
    """

    def __init__(self, work: Callable[[K], V]) -> None:
        self._work = work
        self._known: dict[int, tuple[ref[K], V]] = {}

    def __call__(self, item: K) -> V:
        """Return the answer for an object that can be weakly referred to."""
        key = id(item)
        known = self._known.get(key)
        if known is not None and known[0]() is item:
            return known[1]
        answer = self._work(item)
        # The callback runs before the memory of the object, and with it its id, is used again.
        self._known[key] = (ref(item, lambda _: self._known.pop(key, None)), answer)
        return answer

    def __len__(self) -> int:
        """Return how many answers are kept."""
        return len(self._known)
