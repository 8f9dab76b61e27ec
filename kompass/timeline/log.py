"""Entries out of happenings: what belongs together becomes one entry."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable

from kompass.timeline.entry import TimelineEntry, shortened
from kompass.timeline.happening import Began, Happened, Happening, Over

AGAIN = 60.0  # s after which the same is told as something new
FLICKERS = 10.0  # s within which what begins again has never ended
REMEMBERED = 2000  # keys
_LONGEST = 200  # characters of all but the text


class TimelineLog:
    """Numbers the entries, and knows which can still change.

    Parameters
    ----------
    newest
        Number of the newest entry that there is.
    lasting
        Those of before that had not ended when they were written last. Whatever of them is not
        seen again before :meth:`settle` has ended meanwhile.
    """

    def __init__(self, newest: int = 0, lasting: Iterable[TimelineEntry] = ()) -> None:
        self._newest = newest
        self._known: OrderedDict[str, TimelineEntry] = OrderedDict()
        for entry in lasting:
            self._known[entry.key] = entry
        self._unseen = set(self._known)

    @property
    def newest(self) -> int:
        """Number of the newest entry."""
        return self._newest

    def take(self, happening: Happening) -> list[TimelineEntry]:
        """The entries that are new or have changed by it, to be kept under their numbers.

        Of a key, times are expected not to go back; where they do, an entry ends when it began.
        """
        self._unseen.discard(happening.key)
        match happening:
            case Happened():
                return self._happened(happening)
            case Began():
                return self._began(happening)
            case Over():
                return self._over(happening)

    def settle(self, now: float) -> list[TimelineEntry]:
        """End what was told to last before the start, and of which nothing was seen since."""
        left = [self._known[key] for key in sorted(self._unseen) if key in self._known]
        self._unseen.clear()
        return [
            self._keep(entry.model_copy(update={"lasts": False, "last": max(now, entry.time)}))
            for entry in left
            if entry.lasts
        ]

    def _happened(self, it: Happened) -> list[TimelineEntry]:
        known = self._known.get(it.key) if it.key else None
        if (
            known is not None
            and not known.lasts
            and known.title == shortened(it.title, _LONGEST)
            and known.level == it.level
            and 0.0 <= it.time - known.last < AGAIN
        ):
            changes = {
                "count": known.count + 1,
                "last": it.time,
                "ended": it.time,
                "text": shortened(it.text),
                "link": it.link,
            }
            return [self._keep(known.model_copy(update=changes))]
        # What lasted under this key is over, or it would not have happened.
        over = self._over(Over(it.time, it.key)) if it.key else []
        return [*over, self._add(it, ended=it.time)]

    def _began(self, it: Began) -> list[TimelineEntry]:
        known = self._known.get(it.key)
        if known is None:
            return [self._add(it, ended=None)]
        same = (known.title, known.who) == (
            shortened(it.title, _LONGEST),
            shortened(it.who, _LONGEST),
        )
        if known.lasts:
            return [] if same else [*self._over(Over(it.time, it.key)), self._add(it, ended=None)]
        if not same or known.ended is None or not 0.0 <= it.time - known.ended < FLICKERS:
            return [self._add(it, ended=None)]
        changes = {
            "lasts": True,
            "ended": None,
            "count": known.count + 1,
            "last": it.time,
            "level": it.level,
            "text": shortened(it.text),
        }
        return [self._keep(known.model_copy(update=changes))]

    def _over(self, it: Over) -> list[TimelineEntry]:
        known = self._known.get(it.key)
        if known is None or not known.lasts:
            return []
        changes: dict[str, object] = {"lasts": False, "ended": max(it.time, known.time)}
        if it.text:
            before = f"{known.text.rstrip('.')}. " if known.text else ""
            changes["text"] = shortened(before + it.text)
        if it.level is not None:
            changes["level"] = it.level
        return [self._keep(known.model_copy(update=changes))]

    def _add(self, it: Happened | Began, ended: float | None) -> TimelineEntry:
        self._newest += 1
        return self._keep(
            TimelineEntry(
                number=self._newest,
                key=it.key,
                kind=it.kind,
                level=it.level,
                time=it.time,
                ended=ended,
                lasts=ended is None,
                last=it.time,
                source=shortened(it.source, _LONGEST),
                title=shortened(it.title, _LONGEST),
                text=shortened(it.text),
                who=shortened(it.who, _LONGEST),
                link=it.link,
            )
        )

    def _keep(self, entry: TimelineEntry) -> TimelineEntry:
        if entry.key:
            self._known[entry.key] = entry
            self._known.move_to_end(entry.key)
            if len(self._known) > REMEMBERED:
                self._known.popitem(last=False)
        return entry
