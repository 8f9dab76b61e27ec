"""A cache by identity, for functions of immutable objects."""

from collections.abc import Callable
from typing import Generic, TypeVar
from weakref import ref

K = TypeVar("K")
V = TypeVar("V")


class IdentityCache(Generic[K, V]):
    """A function of one immutable object that computes each result once.

    The key is the identity of the object: rules are not hashable, for arguments of actions are
    dictionaries, and equality takes ``1`` for ``True``. A result is dropped when its object is
    collected. May be called from any thread; two that ask at once may both compute it.

    Parameters
    ----------
    work
        The function; must always return the same for the same object.
    """

    def __init__(self, work: Callable[[K], V]) -> None:
        self._work = work
        self._known: dict[int, tuple[ref[K], V]] = {}

    def __call__(self, item: K) -> V:
        """Return the result for an object that can be weakly referenced."""
        key = id(item)
        known = self._known.get(key)
        if known is not None and known[0]() is item:
            return known[1]
        answer = self._work(item)
        # The callback runs before the memory of the object, and with it its id, is used again.
        self._known[key] = (ref(item, lambda _: self._known.pop(key, None)), answer)
        return answer

    def __len__(self) -> int:
        """Return how many results are kept."""
        return len(self._known)
