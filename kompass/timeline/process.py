"""What the supervisor tells of processes, as happenings."""

from __future__ import annotations

from kompass.supervisor.news import ProcessNews
from kompass.timeline.happening import Began, Happened, Happening, Over

_TITLES = {
    "dead": "Died",
    "stuck": "Hangs",
    "given up": "Died too often, and is not started again",
}


class ProcessObserver:
    """Tells when processes are lost, and when they are there again.

    Attributes
    ----------
    lost
        Nodes whose process is lost.
    """

    def __init__(self) -> None:
        self.lost: set[str] = set()
        self._restarts: dict[str, int] = {}
        self._failed: set[str] = set()

    def told(self, news: ProcessNews, now: float) -> list[Happening]:
        """The supervisor tells of a process; ``now`` in seconds since the epoch."""
        key = f"process {news.name}"
        title = _TITLES.get(news.state)
        if title is not None:
            self.lost.update(news.nodes)
            self._failed.add(news.name)
            return [Began(now, "fault", key, title, news.reason, "error", news.name)]
        if news.state != "active":
            return []
        before = self._restarts.get(news.name, 0)
        self._restarts[news.name] = news.restarts
        self.lost.difference_update(news.nodes)
        if news.name in self._failed:
            self._failed.discard(news.name)
            # One that hung, or was held, may come round before anybody ends it.
            again = news.restarts > before
            return [Over(now, key, "Started again." if again else "Goes on without a new start.")]
        # It was away while nobody listened: the monitor itself, say.
        if news.restarts > before:
            text = "It had died, or was asked to start anew."
            return [Happened(now, "fault", "Started again", text, "warning", news.name, key=key)]
        return [Over(now, key)]
