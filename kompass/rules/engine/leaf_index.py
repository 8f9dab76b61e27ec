"""Which leaves of one signal a new value can change, without asking each of them.

A thousand rules may look at one field. Their leaves change only where the value crosses a bound or
meets a literal of theirs: candidates come from a hash table of literals and a sorted list of
bounds, and for bands from a table of what lies between two neighbouring bounds. The candidates are
conservative and are evaluated exactly afterwards.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence
from typing import Any

from kompass.rules.schema.conditions import Compare, Leaf
from kompass.rules.schema.values import kind_of

# Below this many leaves, evaluating all of them is cheaper than looking candidates up.
_FEW = 6
# Entries per band, beyond which bands are looked up by their bounds instead.
_OVERLAP = 64
_ORDER = frozenset({"<", "<=", ">", ">="})


class _Bands:
    """Closed intervals, by the bounds and gaps of the line that they cover.

    Between two neighbouring bounds all values lie in the same bands, so these are listed once. The
    lists of bands that overlap much would grow with the square of their number; ``fits`` tells.
    """

    def __init__(self, bands: list[tuple[float, float, int]]) -> None:
        self._bounds = sorted({bound for low, high, _ in bands for bound in (low, high)})
        spans = [(self._place(low), self._place(high), leaf) for low, high, leaf in bands]
        self.fits = sum(last - first + 1 for first, last, _ in spans) <= _OVERLAP * len(bands)
        self._within: list[list[int]] = []
        if self.fits:
            self._within = [[] for _ in range(2 * len(self._bounds) + 1)]
            for first, last, leaf in spans:
                for place in range(first, last + 1):
                    self._within[place].append(leaf)

    def at(self, value: float) -> list[int]:
        """Return the leaves whose bands hold a value."""
        return self._within[self._place(value)]

    def _place(self, value: float) -> int:
        """Odd numbers are bounds, even ones the gaps before them."""
        index = bisect_left(self._bounds, value)
        exact = index < len(self._bounds) and self._bounds[index] == value
        return 2 * index + exact


class LeafIndex:
    """The comparisons of one signal, by what their literals are.

    Parameters
    ----------
    comparisons
        Index of each leaf, and its condition.
    """

    def __init__(self, comparisons: Iterable[tuple[int, Leaf]]) -> None:
        pairs = list(comparisons)
        self.all: tuple[int, ...] = tuple(leaf for leaf, _ in pairs)
        self._literals: dict[float | str, list[int]] = {}
        self._elements: dict[float | str, list[int]] = {}
        # Those that no table serves, by the kind of value for which they may hold.
        self._unindexed: dict[str, list[int]] = {"bool": [], "text": [], "list": [], "other": []}
        cuts: list[tuple[float, int]] = []
        bands: list[tuple[float, float, int]] = []
        self._bare: list[int] = []  # leaves that are no comparison
        for leaf, condition in pairs:
            if isinstance(condition, Compare):
                self._add(leaf, condition, cuts, bands)
            else:
                self._bare.append(leaf)
        self._bands = _Bands(bands)
        if not self._bands.fits:
            cuts.extend((bound, leaf) for low, high, leaf in bands for bound in (low, high))
        cuts.sort()
        self._cuts = [bound for bound, _ in cuts]
        self._cut_leaves = [leaf for _, leaf in cuts]

    def candidates(self, old: Any, new: Any) -> Sequence[int] | set[int]:
        """Return at least the leaves whose verdicts differ between two values."""
        if len(self.all) <= _FEW:
            return self.all
        kind = kind_of(new)
        if self._bare or kind != kind_of(old):
            return self.all
        if kind == "number":
            return self._numbers(old, new)
        if kind == "none":
            return ()
        found = set(self._unindexed[kind])
        if kind == "text":
            found.update(self._literals.get(old, ()), self._literals.get(new, ()))
        elif kind == "list" and self._elements:
            for item in (*old, *new):
                if isinstance(item, (int, float, str)):
                    found.update(self._elements.get(item, ()))
        return found

    def _numbers(self, old: float, new: float) -> set[int]:
        low, high = (old, new) if old < new else (new, old)
        found = set(self._cut_leaves[bisect_left(self._cuts, low) : bisect_right(self._cuts, high)])
        if self._literals:
            found.update(self._literals.get(old, ()), self._literals.get(new, ()))
        if self._bands.fits:
            found.update(self._bands.at(old), self._bands.at(new))
        return found

    def _add(
        self,
        leaf: int,
        condition: Compare,
        cuts: list[tuple[float, int]],
        bands: list[tuple[float, float, int]],
    ) -> None:
        operator, value = condition.operator, condition.value
        literals = value if isinstance(value, tuple) else (value,)
        numbers = [v for v in literals if kind_of(v) == "number" and not isinstance(v, str)]
        if operator == "between":
            bands.append((numbers[0], numbers[1], leaf))
        elif operator in _ORDER and numbers:
            cuts.append((numbers[0], leaf))
        elif operator in ("==", "!=") and not isinstance(value, tuple):
            if numbers and condition.tolerance:
                low, high = numbers[0] - condition.tolerance, numbers[0] + condition.tolerance
                bands.append((low, high, leaf))
            else:
                self._register(self._literals, leaf, (value,))
        elif operator in ("in", "not_in") and isinstance(value, tuple):
            self._register(self._literals, leaf, value)
        elif "contains" in operator:
            # A part of a text can be anywhere in it: only elements of lists are indexed.
            self._register(self._elements, leaf, literals)
            if any(isinstance(v, str) for v in literals):
                self._unindexed["text"].append(leaf)
        else:
            self._unindexed["text"].append(leaf)
            self._unindexed["list"].append(leaf)

    def _register(
        self, table: dict[float | str, list[int]], leaf: int, literals: Iterable[Any]
    ) -> None:
        for value in literals:
            if isinstance(value, bool) and table is self._literals:
                if leaf not in self._unindexed["bool"]:
                    self._unindexed["bool"].append(leaf)
            else:
                # True and 1 share a key: one candidate too many is evaluated and found unchanged.
                entry = table.setdefault(value, [])
                if leaf not in entry:
                    entry.append(leaf)
