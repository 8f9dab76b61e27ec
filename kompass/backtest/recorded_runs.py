"""The firings of a recording and how long their actions ran, for a back-test to compare with."""

from bisect import bisect_left
from collections.abc import Iterable, Iterator, Sequence
from statistics import median

from kompass.backtest.event_log import Began, Ended, Fired, LoggedEvent, Resumed, Swapped
from kompass.rules.schema.actions import Action

# s by which two firings may differ that are one. The times of both are the engine's own: what is
# more is the next message of a fast topic.
TOLERANCE = 1e-6


class RecordedRuns:
    """Indexed by session of the monitor, rule and time; each firing is given out once."""

    def __init__(self, events: Iterable[LoggedEvent]) -> None:
        self._firings: dict[tuple[str, str], list[Fired]] = {}
        self._taken: dict[tuple[str, str], list[bool]] = {}
        self._actions: dict[tuple[str, int], tuple[Action, ...]] = {}
        self._by_rule: dict[str, list[float]] = {}
        self._by_actions: dict[str, list[float]] = {}
        self._read(events)
        for key, firings in self._firings.items():
            firings.sort(key=lambda firing: (firing.now, firing.run_id))
            self._taken[key] = [False] * len(firings)

    def _read(self, events: Iterable[LoggedEvent]) -> None:
        epoch = ""
        actions: dict[str, tuple[Action, ...]] = {}
        open_runs: dict[int, Fired] = {}
        seen: set[tuple[str, int]] = set()
        for event in events:
            if isinstance(event, (Began, Resumed, Swapped)):
                actions = {rule.id: rule.actions for rule in event.table.rules}
                if not isinstance(event, Swapped) and event.epoch != epoch:
                    epoch = event.epoch
                    open_runs.clear()
            elif isinstance(event, Fired) and (epoch, event.run_id) not in seen:
                seen.add((epoch, event.run_id))
                self._firings.setdefault((epoch, event.rule_id), []).append(event)
                self._actions[epoch, event.run_id] = actions.get(event.rule_id, ())
                open_runs[event.run_id] = event
            elif isinstance(event, Ended):
                began = open_runs.pop(event.run_id, None)
                if began is not None:
                    seconds = event.now - began.now
                    self._by_rule.setdefault(event.rule_id, []).append(seconds)
                    key = _key(self._actions[epoch, event.run_id])
                    self._by_actions.setdefault(key, []).append(seconds)

    def match(self, epoch: str, rule_id: str, at: float) -> Fired | None:
        """Return the recorded firing that a firing at ``at`` is, if there is one."""
        key = (epoch, rule_id)
        firings = self._firings.get(key, ())
        index = bisect_left(firings, at - TOLERANCE, key=lambda firing: firing.now)
        while index < len(firings) and firings[index].now <= at + TOLERANCE:
            if not self._taken[key][index]:
                self._taken[key][index] = True
                return firings[index]
            index += 1
        return None

    def matched(self, epoch: str, firing: Fired) -> bool:
        """Whether a recorded firing was given out."""
        key = (epoch, firing.rule_id)
        firings = self._firings.get(key, ())
        index = bisect_left(firings, firing.now, key=lambda one: one.now)
        while index < len(firings) and firings[index].now == firing.now:
            if firings[index].run_id == firing.run_id:
                return self._taken[key][index]
            index += 1
        return False

    def unmatched(self, epoch: str) -> Iterator[tuple[str, Fired]]:
        """Yield the firings of a session that nothing was matched with."""
        for key, taken in self._taken.items():
            if key[0] != epoch:
                continue
            for index, firing in enumerate(self._firings[key]):
                if not taken[index]:
                    taken[index] = True
                    yield key[1], firing

    def did(self, epoch: str, firing: Fired, actions: Sequence[Action]) -> bool:
        """Whether the recorded firing carried out these actions."""
        known = self._actions[epoch, firing.run_id]
        return not firing.shadow and known == tuple(actions)

    def length(self, rule_id: str, actions: Sequence[Action]) -> float:
        """Return how many seconds such a run usually took; 0 if there never was one."""
        lengths = self._by_rule.get(rule_id) or self._by_actions.get(_key(actions))
        return max(median(lengths), 0.0) if lengths else 0.0


def _key(actions: Sequence[Action]) -> str:
    return " ".join(action.model_dump_json() for action in actions)
