"""The robot's timeline: happenings are taken from all threads, kept on the disk, and told."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from typing import Any

from kompass_interfaces.srv import ChangeTimeline, GetTimeline
from pydantic import ValidationError
from std_msgs.msg import String

from kompass.access.gatekeeper import Gatekeeper, NotAdmitted
from kompass.bus.node import Node
from kompass.invalid import first_invalid
from kompass.monitor.reporting.alarms import Alarms
from kompass.monitor.services import answer_in_parts
from kompass.monitor.signed_changes import SignedChanges
from kompass.monitor.tables.types import Who
from kompass.monitor.worker_thread import WorkerThread
from kompass.places.place import LONGEST_AUTHOR
from kompass.rclpy_ext.deferred_service import answered_by_worker, create_deferred_service
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.timers import Timers
from kompass.rclpy_ext.topic import LATCHED
from kompass.store.errors import ChangeRefused, StoreError
from kompass.store.timeline_store import Shelf, TimelineStore
from kompass.timeline.change import TIMELINE_CHANGE, Acknowledge, AddNote, Shelve, TimelineChange
from kompass.timeline.entry import TimelineEntry
from kompass.timeline.happening import Happened, Happening
from kompass.timeline.log import TimelineLog
from kompass.timeline.query import TimelineNews, TimelineQuery

TOPIC = "timeline"
GET, CHANGE = "get_timeline", "change_timeline"  # services
NEWS_PERIOD = 0.5  # s between two tellings that there is something new
SETTLED = 30.0  # s after the start by which what still lasts has been seen again
MOST_UNWRITTEN = 2000  # entries that wait for a disk that takes nothing
_LARGEST = 10_000  # characters of a query or a change


class Timeline:
    """Keeps what happens, answers ``<node>/get_timeline``, and tells on ``<node>/timeline``.

    A store that cannot be opened costs the timeline and nothing else.

    Parameters
    ----------
    node, main, timers
        Where it runs.
    gatekeeper
        Lets requests in.
    open_store
        Opens the timeline of this robot; None where nobody keeps one.
    """

    def __init__(
        self,
        node: Node,
        main: MainThread,
        timers: Timers,
        gatekeeper: Gatekeeper,
        open_store: Callable[[], TimelineStore] | None,
    ) -> None:
        self._clock, self._logger = node.clock, node.get_logger()
        self._main, self._gatekeeper = main, gatekeeper
        self._worker = WorkerThread(node, "timeline")
        self._service = f"{node.get_name()}/{GET}"
        self._publisher = node.create_publisher(
            String, f"{node.get_name()}/{TOPIC}", LATCHED.to_ros()
        )
        self._waiting: deque[Happening] = deque()
        self._unwritten: dict[int, TimelineEntry] = {}
        self._log = TimelineLog()
        self._changes, self._told = 0, -1
        self._problem = ""
        self._store: TimelineStore | None = None
        self._shelves: list[Shelf] = []
        problem = "nobody keeps a timeline of this robot"
        if open_store is not None:
            try:
                store = open_store()
                self._log = TimelineLog(store.newest(), store.lasting())
                self._shelves = store.shelves()
                self._store, problem = store, ""
            except (StoreError, OSError) as error:
                problem = f"the timeline cannot be kept: {error}"
                self._logger.error(problem)
        self._unavailable = problem
        self._tell_news()
        answer = answered_by_worker(main, self._worker, self._answer)
        create_deferred_service(node, GetTimeline, self._service, answer, _failed)
        timers.every(NEWS_PERIOD, self._tell_news)
        timers.after(SETTLED, lambda: self._worker.post(self._settle))
        self.add(Happened(self._clock.wall(), "robot", "Monitor started"))

    def offer_changes(self, node: Node, alarms: Alarms) -> None:
        """Let people write notes, and say what is to become of alarms."""
        alarms.restore(self._shelves)
        self._alarms = alarms
        SignedChanges(
            node,
            self._main,
            self._gatekeeper,
            *(self._worker, ChangeTimeline, CHANGE, TIMELINE_CHANGE),
            largest=_LARGEST,
            what="the timeline",
            problem=self._unavailable,
            carry_out=self._change,
        )

    def add(self, *happenings: Happening) -> None:
        """Take what has happened. Any thread; never waits."""
        self.add_all(happenings)

    def add_all(self, happenings: Iterable[Happening]) -> None:
        """Take what has happened. Any thread; never waits."""
        if self._store is None:
            return
        was_empty = not self._waiting
        self._waiting.extend(happenings)
        if was_empty and self._waiting:
            self._worker.post(self._take)

    def close(self) -> None:
        """Take nothing any more; what was taken is on the disk."""
        self._worker.close()
        if self._store is not None:
            self._waiting.append(Happened(self._clock.wall(), "robot", "Monitor ended"))
            self._take()
            self._store.close()

    # -- on the worker ------------------------------------------------------------------------

    def _take(self) -> None:
        while self._waiting:
            self._keep(self._log.take(self._waiting.popleft()))
        self._write()

    def _settle(self) -> None:
        self._keep(self._log.settle(self._clock.wall()))
        self._write()

    def _keep(self, entries: Iterable[TimelineEntry]) -> None:
        for entry in entries:
            self._unwritten[entry.number] = entry
        while len(self._unwritten) > MOST_UNWRITTEN:
            del self._unwritten[min(self._unwritten)]

    def _write(self) -> None:
        """Bring what is new to the disk; a disk that takes nothing is tried again with the next."""
        if self._store is None or not self._unwritten:
            return
        try:
            self._store.put(self._unwritten.values())
        except StoreError as error:
            if not self._problem:
                self._logger.error(f"what happens cannot be written down: {error}")
            self._problem = f"what happens cannot be written down: {error}"
        else:
            self._problem = ""
            self._unwritten.clear()
        self._changes += 1

    def _answer(self, request: Any, response: Any) -> Any:
        try:
            self._gatekeeper.admit(self._service, request, changes=False)
            if self._unavailable:
                raise ChangeRefused(self._unavailable)
            query = self._read(str(request.query))
        except (NotAdmitted, ChangeRefused) as error:
            response.success, response.message = False, str(error)
            return response
        assert self._store is not None
        self._take()
        page = self._store.page(query)
        page = page.model_copy(update={"problem": self._problem or page.problem})
        return answer_in_parts(response, page, "entries")

    def _read(self, text: str) -> TimelineQuery:
        if len(text) > _LARGEST:
            raise ChangeRefused(f"query has {len(text)} characters; use at most {_LARGEST}")
        try:
            return TimelineQuery.model_validate_json(text)
        except ValidationError as error:
            wrong = first_invalid(error)
            field = wrong.where or "query"
            raise ChangeRefused(f"{field} = {wrong.value!r:.100}: {wrong.text}") from None

    def _change(self, change: TimelineChange, who: Who) -> str:
        assert self._store is not None  # or it was refused
        by, now = who.name[:LONGEST_AUTHOR], self._clock.wall()
        match change:
            case AddNote():
                self._note(Happened(now, "person", change.title, change.text, who=by))
            case Acknowledge():
                self._main.call(lambda: self._alarms.acknowledge(change.alarm, change.since, by))
            case Shelve():
                shelf = Shelf(change.alarm, now + change.seconds if change.seconds else 0.0, by)
                self._store.shelve(shelf)
                self._main.call(lambda: self._alarms.shelve(shelf))
        return ""

    def _note(self, note: Happened) -> None:
        """On the disk before it is answered, or refused."""
        self._waiting.append(note)
        self._take()
        if self._unwritten:
            raise ChangeRefused(f"{self._problem}; it is written down when that is mended")

    # -- on the main thread -------------------------------------------------------------------

    def _tell_news(self) -> None:
        if self._changes == self._told:
            return
        self._told = self._changes
        damage = self._store.notice if self._store else ""
        news = TimelineNews(
            available=not self._unavailable,
            newest=self._log.newest,
            changes=self._changes,
            problem=self._unavailable or self._problem or damage,
        )
        self._publisher.publish(String(data=news.model_dump_json()))


def _failed(response: Any, error: Exception) -> Any:
    response.success, response.message = False, str(error) or type(error).__name__
    return response
