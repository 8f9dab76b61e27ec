"""Tell everybody when the supervisor starts nobody again, and when it does so again."""

from __future__ import annotations

from collections.abc import Callable

from kompass.monitor.reporting.alarms import Alarms

ALARM = "supervisor-silent"
SILENT = 3.0  # s; it shows life five times a second


class SupervisorWatch:
    """Raises an alarm while the supervisor shows no life: a signal holds it, or its terminal.

    Parameters
    ----------
    silent
        For how long it has shown no life [s].
    alarms
        Where the alarm is raised.
    announce
        Takes a sentence that every operator must hear.
    """

    def __init__(
        self, silent: Callable[[], float], alarms: Alarms, announce: Callable[[str], None]
    ) -> None:
        self._silent, self._alarms, self._announce = silent, alarms, announce
        self._said = False

    def look(self) -> None:
        """Look at how the supervisor is doing; to be called every second or so."""
        silent = self._silent()
        if silent >= SILENT and not self._said:
            text = (
                f"the supervisor has shown no life for {silent:.0f} s: what dies or hangs is not "
                "started again. Let it go on (SIGCONT; Ctrl-Q where Ctrl-S holds its terminal), or "
                "end the stack"
            )
            self._alarms.raise_alarm(ALARM, text, "", "error")
            self._announce(text)
            self._said = True
        elif self._said and silent < SILENT:
            self._alarms.clear(ALARM)
            self._announce("the supervisor shows life again")
            self._said = False
