"""What the robot's monitor tells of its timeline, and what people did, noted on it."""

from __future__ import annotations

import logging
from collections.abc import Callable
from concurrent.futures import Future

from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.monitor.client import MonitorClient, NoMonitor, Refused
from kompass.rclpy_ext.reply import NoAnswer
from kompass.timeline.change import AddNote
from kompass.timeline.query import TimelineNews
from kompass_console.link.rules.monitor import MonitorLink
from kompass_console.schema.models import TimelineInfo
from kompass_console.schema.plain import plain

_logger = logging.getLogger(__name__)


class TimelineWatch:
    """Knows whether something has happened, and not what: pages ask for that.

    Parameters
    ----------
    changed
        Called when pages have something new to show; on the link's thread.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._news = TimelineNews(available=False)

    def follow(self, monitor: MonitorClient) -> None:
        """Listen to the monitor that is there now; what another said last stays until then."""
        monitor.watch_timeline(self._store)

    def info(self) -> TimelineInfo:
        """By what pages see that they have to ask again."""
        news = self._news
        return TimelineInfo(available=news.available, newest=news.newest, changes=news.changes)

    def _store(self, text: str) -> None:
        try:
            self._news = TimelineNews.model_validate_json(text)
        except ValidationError as error:
            _logger.warning("news that cannot be read: %s", plain(first_invalid(error).text))
            return
        self._changed()


class Notes:
    """Has the monitor note what people did; the audit log has it in any case."""

    def __init__(self, monitor: MonitorLink) -> None:
        self._monitor = monitor

    def note(self, title: str, who: str, role: str) -> None:
        """Never waits. Any thread."""
        try:
            client = self._monitor.client
        except NoMonitor:
            return  # nobody keeps a timeline
        sent = client.change_timeline(AddNote(title=title), author=who, role=role)
        sent.add_done_callback(_complain)


def _complain(done: Future[None]) -> None:
    try:
        done.result()
    except (NoAnswer, Refused) as error:
        _logger.warning("what somebody did is not on the timeline: %s", plain(error))
