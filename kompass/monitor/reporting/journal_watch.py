"""Tell everybody when firings cannot be written down, and when they can again."""

from __future__ import annotations

from collections.abc import Callable

from kompass.monitor.reporting.alarms import Alarms
from kompass.store.store import RuleStore

ALARM = "journal-not-kept"


class JournalWatch:
    """Raises an alarm while the journal is not kept.

    The rules go on: what they do is worth more than what is known of it afterwards.

    Parameters
    ----------
    store
        Writes the journal.
    alarms
        Where the alarm is raised.
    announce
        Takes a sentence that every operator must hear.
    """

    def __init__(self, store: RuleStore, alarms: Alarms, announce: Callable[[str], None]) -> None:
        self._store, self._alarms, self._announce = store, alarms, announce
        self._said = ""
        self._lost = 0

    def look(self) -> None:
        """Look at how the journal is doing; to be called every two seconds or so."""
        trouble, lost = self._store.journal_trouble, self._store.lost_entries
        if trouble and trouble != self._said:
            text = f"firings are not written down: {trouble}. The rules go on"
            self._alarms.raise_alarm(ALARM, text, "", "error")
            self._announce(text)
        elif self._said and not trouble:
            self._alarms.clear(ALARM)
            self._announce(
                f"firings are written down again; {lost - self._lost} entries of the journal are "
                "missing"
            )
            self._lost = lost
        self._said = trouble
