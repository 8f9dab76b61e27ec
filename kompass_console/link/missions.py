"""The robot's missions and what runs, as its monitor tells them."""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from kompass.invalid import first_invalid
from kompass.missions.mission import Act, Ask, Halt, Mission, MissionBook, Wait
from kompass.missions.queue import MissionState
from kompass.missions.run import Run
from kompass.monitor.client import MonitorClient
from kompass.rulebook.views.wording import describe_action
from kompass_console.link.places import PlacesWatch
from kompass_console.schema.models import MissionRunInfo, MissionsInfo, QueuedMission
from kompass_console.schema.plain import plain

_logger = logging.getLogger(__name__)
MOST_SKIPPED = 5  # that pages are told of

M = TypeVar("M", bound=BaseModel)


class MissionsWatch:
    """The newest book of missions, and the newest state of what runs.

    Parameters
    ----------
    places
        By which waypoints are named.
    changed
        Called when pages have something new to show; on the link's thread.
    """

    def __init__(self, places: PlacesWatch, changed: Callable[[], None]) -> None:
        self._places, self._changed = places, changed
        self._book: MissionBook | None = None
        self._state, self._heard = MissionState(), 0.0

    def follow(self, monitor: MonitorClient) -> None:
        """Listen to the monitor that is there now; what another said last stays until then."""
        monitor.watch_missions(self._store_book, self._store_state)

    @property
    def book(self) -> MissionBook | None:
        """All missions; None until the monitor has told them."""
        return self._book

    @property
    def state(self) -> MissionState:
        """What runs, and what waits."""
        return self._state

    def find(self, mission_id: int) -> Mission | None:
        """A mission; None when there is none of this number."""
        missions = () if self._book is None else self._book.missions
        return next((each for each in missions if each.id == mission_id), None)

    def sender(self, x: float, y: float) -> str:
        """The mission that has the robot drive to a place (m); empty when none does."""
        run = self._state.run
        place = None if run is None else self._places.find(run.here.place)
        if run is None or place is None or run.phase in ("done", "canceled"):
            return ""
        # A goal that was refused at once may be heard of after the run has been paused by it.
        there = math.isclose(place.pose.x, x, abs_tol=1e-6)
        there &= math.isclose(place.pose.y, y, abs_tol=1e-6)
        return f"mission {plain(run.mission.name)}" if there else ""

    def info(self) -> MissionsInfo:
        """What pages show."""
        book, state = self._book, self._state
        return MissionsInfo(
            available=book is not None and book.available,
            revision=0 if book is None else book.revision,
            notice=plain(state.notice),
            run=None if state.run is None else self._run(state.run, state.left),
            queue=[
                QueuedMission(number=each.number, name=self._name(each.mission), by=plain(each.by))
                for each in state.queue
            ],
        )

    def _run(self, run: Run, left: float | None) -> MissionRunInfo:
        task = run.task
        since = time.monotonic() - self._heard
        return MissionRunInfo(
            number=run.number,
            mission=run.mission.id,
            name=plain(run.mission.name),
            by=plain(run.by),
            phase=run.phase,
            step=run.step,
            elapsed=max(0.0, time.time() - run.since),
            round=run.round,
            rounds=run.mission.rounds,
            waypoint=run.waypoint + 1,
            waypoints=len(run.mission.waypoints),
            attempt=run.attempt,
            place=self._place(run.here.place),
            task="" if task is None else task_text(task),
            ask=plain(task.text) if isinstance(task, Ask) else "",
            left=None if left is None else max(0.0, left - since),
            reason=plain(run.reason),
            decided_by=plain(run.decided_by),
            skipped=[
                f"{self._place(run.mission.waypoints[each.waypoint].place)}: {plain(each.reason)}"
                for each in run.skipped[-MOST_SKIPPED:]
            ],
        )

    def _place(self, place_id: int) -> str:
        place = self._places.find(place_id)
        return "" if place is None else place.name

    def _name(self, mission_id: int) -> str:
        mission = self.find(mission_id)
        return "" if mission is None else plain(mission.name)

    def _store_book(self, text: str) -> None:
        book = _read(MissionBook, text)
        if book is not None:
            self._book = book.model_copy(update={"problem": plain(book.problem)})
            self._changed()

    def _store_state(self, text: str) -> None:
        state = _read(MissionState, text)
        if state is not None:
            self._state, self._heard = state, time.monotonic()
            self._changed()


def task_text(task: Wait | Ask | Halt | Act) -> str:
    """What is done, in a few words."""
    match task:
        case Wait():
            return "wait"
        case Ask():
            return "wait for a person"
        case Halt():
            return "STOP"
        case Act():
            return plain(describe_action(task.action))


def _read(kind: type[M], text: str) -> M | None:
    try:
        return kind.model_validate_json(text)
    except ValidationError as error:
        # Of another release, or of a stranger: what was known before is better than nothing.
        _logger.warning("missions that cannot be read: %s", plain(first_invalid(error).text))
        return None
