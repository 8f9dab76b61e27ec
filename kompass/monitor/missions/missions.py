"""The robot's missions: kept, told to everybody, changed and steered by people, begun on time.

What runs is kept on the disk. A person who starts or resumes something gets the answer when it has
been written down, and the robot sets off after that; it stands at once when told to, and that is
written down afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from datetime import datetime, tzinfo

from kompass_interfaces.srv import ChangeMissions
from std_msgs.msg import String

from kompass.access.gatekeeper import Gatekeeper
from kompass.bus.node import Executor, Node
from kompass.missions.change import (
    MISSION_CHANGE,
    DeleteMission,
    EditMission,
    Interruptions,
    MissionChange,
    MissionEdit,
    RestoreMission,
    SaveMission,
    StartMission,
    StartNext,
    SteerRun,
    Unqueue,
)
from kompass.missions.mission import Editor, Mission, MissionBook, MissionPlan
from kompass.missions.queue import LATEST, MOST_QUEUED, MissionState, Queued, is_due, looked_at
from kompass.missions.run import (
    Cease,
    DriveEnd,
    Effect,
    GoTo,
    MissionRefused,
    MissionRun,
    Now,
    Run,
)
from kompass.monitor.execution.action_runner import ActionRunner
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.missions.actions import UnfitAction, check_actions
from kompass.monitor.missions.robot import MissionRobot
from kompass.monitor.places import Places
from kompass.monitor.signed_changes import SignedChanges
from kompass.monitor.tables.types import Who
from kompass.monitor.worker_thread import WorkerThread
from kompass.places.place import LONGEST_AUTHOR, same_name
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.timers import MovableTimer, Timers
from kompass.rclpy_ext.topic import LATCHED
from kompass.rulebook.permissions import Permissions
from kompass.store.errors import ChangeRefused, EntryRefused, NoSuchEntry, StaleEntry, StoreError
from kompass.store.mission_store import MissionStore
from kompass.supervisor.news import ProcessNews
from kompass.timeline.edit import edited
from kompass.timeline.happening import Happening
from kompass.timeline.mission import MissionObserver

BOOK, STATE = "missions", "mission_state"  # topics
SERVICE = "change_missions"
SCHEDULE_PERIOD = 5.0  # s between looks at the hour
CLOCK = "the clock"  # who begins what has a schedule
_LARGEST = 200_000  # characters of a change


class Missions:
    """Tells the missions on ``<node>/missions`` and what runs on ``<node>/mission_state``.

    A store that cannot be opened costs the missions and nothing else.

    Parameters
    ----------
    node, executor, main, timers
        Where it runs.
    gatekeeper
        Lets requests in.
    runner
        Carries out what is done at places.
    catalog, permissions
        What actions are checked against.
    places
        Of the robot.
    open_store
        Opens the missions of this robot.
    happened
        Told of what people change, and of what becomes of missions. Any thread.
    zone
        Of the hours of schedules; the robot's own where left out.
    """

    def __init__(
        self,
        node: Node,
        executor: Executor,
        main: MainThread,
        timers: Timers,
        gatekeeper: Gatekeeper,
        runner: ActionRunner,
        catalog: RecipeCatalog,
        permissions: Permissions,
        places: Places,
        open_store: Callable[[], MissionStore],
        happened: Callable[[Iterable[Happening]], None],
        zone: tzinfo | None = None,
    ) -> None:
        self._happened, self._observer = happened, MissionObserver()
        self._main, self._clock, self._zone = main, node.clock, zone
        self._log = node.get_logger()
        self._catalog, self._permissions, self._places = catalog, permissions, places
        self._worker = WorkerThread(node, "missions")
        self._robot = MissionRobot(
            *(node, executor, timers, main, runner, catalog),
            min(permissions.gates),
            self._worker,
            find_place=places.find,
            drive_ended=self._drive_ended,
            task_ended=self._task_ended,
            interrupted=self._interrupted,
        )
        places.watch(self._robot.places_changed)
        self._wake = MovableTimer(timers, self._tick)
        self._books = node.create_publisher(String, f"{node.get_name()}/{BOOK}", LATCHED.to_ros())
        self._states = node.create_publisher(String, f"{node.get_name()}/{STATE}", LATCHED.to_ros())
        self._store: MissionStore | None = None
        self._state = self._written = MissionState()
        self._unwritten = ""
        self._looked = self._hour()
        self._problem = problem = ""
        try:
            store = open_store()
            book, self._state = store.book(), store.state()
            self._written = self._state
            self._store = store
        except (StoreError, OSError) as error:
            self._problem = problem = f"missions cannot be kept: {error}"
            self._log.error(problem)
            book = MissionBook(problem=problem, available=False)
        self._run: MissionRun | None = None
        if self._state.run is not None:
            self._run = MissionRun(self._state.run, self._now())
        self._tell_book(book)
        self._tell_missed()
        self._changed()
        SignedChanges(
            *(node, main, gatekeeper, self._worker, ChangeMissions, SERVICE, MISSION_CHANGE),
            largest=_LARGEST,
            what="missions",
            problem=problem,
            carry_out=self._carry_out,
        )
        timers.every(SCHEDULE_PERIOD, self._look_at_schedules)

    def close(self) -> None:
        """Drive and change nothing any more; what is under way is paused when it begins anew."""
        self._robot.close()
        self._worker.close()
        if self._store is not None:
            self._store.close()

    def process_changed(self, news: ProcessNews) -> None:
        """A process lives, or has died."""
        self._robot.process_changed(news)

    def start(self, name: str, by: str, told: Callable[[str], None]) -> None:
        """Begin the mission of that name, or let it wait for its turn; for rules.

        Parameters
        ----------
        told
            Called on a worker, with why it did not begin; with an empty text when it did.
        """

        def begin() -> None:
            if self._problem:
                told(self._problem)
                return
            try:
                mission = self._main.call(lambda: self._named(name))
                if mission is None:
                    raise NoSuchEntry(f"there is no mission called {name!r}; look at the others")
                self._durably(lambda: self._take_on_once(mission, by[:LONGEST_AUTHOR]))
            except (StoreError, RuntimeError) as error:
                told(str(error))
            else:
                told("")

        self._worker.post(begin)

    # -- what people do, on the worker --------------------------------------------------------

    def _carry_out(self, change: MissionChange, who: Who) -> str:
        by = who.name[:LONGEST_AUTHOR]
        match change:
            case SaveMission() | EditMission() | DeleteMission() | RestoreMission():
                return self._edit(change, by, _editor(who))
            case StartMission():
                return self._start(change, by)
            case StartNext():
                return self._durably(lambda: self._begin_next(by), change.interruptions)
            case Unqueue():
                return self._durably(lambda: self._unqueue(change.number))
            case SteerRun():
                return self._durably(lambda: self._steer(change, by), change.interruptions)

    def _edit(self, change: MissionEdit, by: str, role: Editor) -> str:
        if isinstance(change, SaveMission | EditMission):
            self._check(change.plan, role)
        store = self._kept()
        mission = store.change(change, by, role)
        book = store.book()
        self._main.post(lambda: self._tell_book(book))
        self._happened([edited("Mission", change.kind, mission.name, by, self._clock.wall())])
        return mission.model_dump_json()

    def _check(self, plan: MissionPlan, role: Editor) -> None:
        for number, waypoint in enumerate(plan.waypoints, 1):
            place = self._places.find(waypoint.place)
            if place is None:
                raise EntryRefused(
                    f"place {number} is there no more ({waypoint.place}); choose another"
                )
            if place.map.id != plan.map.id:
                raise EntryRefused(
                    f"place {number}, {place.name!r}, is on another map ({place.map.label}) than "
                    "the mission; choose places of one map"
                )
        try:
            check_actions(plan, role, self._catalog, self._permissions)
        except UnfitAction as error:
            raise EntryRefused(str(error)) from None

    def _start(self, change: StartMission, by: str) -> str:
        mission = self._main.call(lambda: self._find(change.id))
        if mission is None:
            raise NoSuchEntry(
                f"there is no mission {change.id} any more, somebody has deleted it; "
                "look at the others"
            )
        if mission.version != change.version:
            raise StaleEntry(
                f"the mission {mission.name!r} was changed meanwhile, by {mission.author}; "
                "look at it as it is now, and try again"
            )
        self._durably(lambda: self._take_on(mission, by), change.interruptions)
        return mission.model_dump_json()

    def _durably(
        self, decide: Callable[[], tuple[Effect, ...]], asked: Interruptions = None
    ) -> str:
        """Decide on the main thread, write it down, and only then set anything in motion.

        Nothing is, where people pressed STOP or took the wheel after the count ``asked``.
        """

        def decided() -> tuple[tuple[Effect, ...], MissionState]:
            effects = decide()
            self._do(each for each in effects if isinstance(each, Cease))
            self._changed(keep=False)
            return tuple(each for each in effects if not isinstance(each, Cease)), self._state

        try:
            effects, state = self._main.call(decided)
        except MissionRefused as error:
            raise EntryRefused(str(error)) from None
        try:
            self._write(state)
        except StoreError as error:
            why = str(error)
            self._main.call(lambda: self._stand(f"It could not be written down: {why}"))
            raise
        if asked is None or not effects:
            self._main.post(lambda: self._do(effects))
        else:
            self._main.post(
                lambda: self._robot.unless_interrupted(asked, lambda: self._do(effects))
            )
        return ""

    # -- on the main thread -------------------------------------------------------------------

    def _take_on(self, mission: Mission, by: str) -> tuple[Effect, ...]:
        """Begin a mission, or let it wait for its turn."""
        if not self._state.busy and not self._state.queue:
            return self._begin(mission, by)
        if len(self._state.queue) >= MOST_QUEUED:
            raise MissionRefused(
                f"{MOST_QUEUED} missions wait already; take one out of the queue first"
            )
        number = self._state.queuings + 1
        waits = Queued(number=number, mission=mission.id, by=by, time=self._clock.wall())
        self._set(queuings=number, queue=(*self._state.queue, waits))
        return ()

    def _take_on_once(self, mission: Mission, by: str) -> tuple[Effect, ...]:
        """As a rule does, which may fire again and again."""
        if self._is_on(mission):
            raise MissionRefused(f"{mission.name!r} runs or waits already")
        return self._take_on(mission, by)

    def _is_on(self, mission: Mission) -> bool:
        run = self._state.run if self._state.busy else None
        on = {each.mission for each in self._state.queue} | ({run.mission.id} if run else set())
        return mission.id in on

    def _begin(self, mission: Mission, by: str) -> tuple[Effect, ...]:
        now, number = self._now(), self._state.runs + 1
        run = Run(
            number=number,
            mission=mission,
            by=by,
            started=now.wall,
            phase="paused",
            since=now.wall,
        )
        self._run = MissionRun(run, now)
        self._set(runs=number, notice="")
        self._robot.listen()
        effects = self._run.begin(now)
        if by == CLOCK and self._robot.pursues_other_goals:
            self._run.interrupted("the robot was on its way to a goal that somebody gave it", now)
            return ()
        return effects

    def _begin_next(self, by: str) -> tuple[Effect, ...]:
        if self._state.busy:
            raise MissionRefused("a mission runs; the queue goes on when it is done")
        while self._state.queue:
            first, *others = self._state.queue
            self._set(queue=tuple(others))
            mission = self._find(first.mission)
            if mission is not None:
                return self._begin(mission, by or first.by)
            self._set(notice="A mission that waited for its turn has been deleted; it is left out.")
        if by:
            raise MissionRefused("no mission waits; start one")
        return ()

    def _unqueue(self, number: int) -> tuple[Effect, ...]:
        left = tuple(each for each in self._state.queue if each.number != number)
        if len(left) == len(self._state.queue):
            raise MissionRefused("it waits no more; look at what runs")
        self._set(queue=left)
        return ()

    def _steer(self, change: SteerRun, by: str) -> tuple[Effect, ...]:
        run = self._run
        if run is None or run.run.number != change.run:
            raise MissionRefused("that run is over; look at what runs now")
        now = self._now()
        if change.verb not in ("pause", "cancel") and change.step != run.run.step:
            raise MissionRefused(
                "the mission has gone on meanwhile; look at what it does now, and decide again"
            )
        match change.verb:
            case "pause":
                return run.pause(by, now)
            case "resume":
                return run.resume(by, now)
            case "skip":
                return run.skip(by, now)
            case "confirm":
                return run.confirm(by, now)
            case "cancel":
                return run.cancel(by, now)

    def _named(self, name: str) -> Mission | None:
        wanted = same_name(name)
        missions = self._book.missions
        return next((each for each in missions if same_name(each.name) == wanted), None)

    def _find(self, mission_id: int) -> Mission | None:
        missions = self._book.missions
        return next((each for each in missions if each.id == mission_id), None)

    # -- what happens -------------------------------------------------------------------------

    def _drive_ended(self, ticket: int, end: DriveEnd, reason: str) -> None:
        self._advance(lambda run: run.drive_ended(ticket, end, reason, self._now()))

    def _task_ended(self, ticket: int, ok: bool, reason: str) -> None:
        self._advance(lambda run: run.task_ended(ticket, ok, reason, self._now()))

    def _interrupted(self, reason: str) -> None:
        self._advance(lambda run: run.interrupted(reason, self._now()))

    def _tick(self) -> None:
        self._advance(lambda run: run.tick(self._now()))

    def _stand(self, reason: str) -> None:
        self._set(notice=reason)
        self._advance(lambda run: run.interrupted(reason, self._now()))

    def _advance(self, step: Callable[[MissionRun], tuple[Effect, ...]]) -> None:
        """Let something happen to the run, and carry out what follows."""
        if self._run is None:
            return
        before = self._run.run
        effects = step(self._run)
        if self._run.run is before:
            self._wake.set(self._run.due)
            return
        if self._run.run.phase == "done" and self._state.queue:
            self._set(run=self._run.run)
            effects += self._begin_next("")
        self._do(effects)
        self._changed()

    def _do(self, effects: Iterable[Effect]) -> None:
        for effect in effects:
            if isinstance(effect, Cease):
                self._robot.cease()
            elif self._run is None or not self._run.awaits(effect.ticket):
                continue  # something came between
            elif isinstance(effect, GoTo):
                self._robot.go(effect, self._run.run.mission.map)
            else:
                self._robot.perform(effect, self._run.run.mission)

    def _look_at_schedules(self) -> None:
        before, now = self._looked, self._hour()
        self._looked = looked_at(before, now)
        for mission in self._book.missions:
            saved = self._local(mission.time)
            if mission.schedule is not None and is_due(mission.schedule, saved, before, now):
                self._due(mission)

    def _tell_missed(self) -> None:
        """What was due while this program was being started is not begun; say so."""
        now, wall = self._hour(), self._clock.wall()
        run = self._state.run
        for mission in self._book.missions:
            saved = self._local(mission.time)
            if mission.schedule is None or not is_due(mission.schedule, saved, now - LATEST, now):
                continue
            last = None if run is None or run.mission.id != mission.id else run
            if last is None or wall - last.started > LATEST.total_seconds():
                notice = f"{mission.name!r} was due while the robot's program was being started."
                self._set(notice=f"{notice} It did not begin; start it by hand.")

    def _due(self, mission: Mission) -> None:
        if self._is_on(mission):
            self._set(notice=f"{mission.name!r} was due, and has not ended since the last time.")
            self._changed()
            return
        self._worker.post(lambda: self._begin_on_time(mission))

    def _begin_on_time(self, mission: Mission) -> None:
        try:
            self._durably(lambda: self._take_on(mission, CLOCK))
        except ChangeRefused as error:
            notice = f"{mission.name!r} was due and did not begin: {error}"
            self._main.call(lambda: self._set(notice=notice))
            self._main.call(self._changed)

    # -- pieces -------------------------------------------------------------------------------

    def _changed(self, *, keep: bool = True) -> None:
        """Tell everybody, and write it down."""
        run = self._run
        if run is not None:
            self._set(run=run.run, left=run.left(self._now()))
            self._wake.set(run.due)
            if run.run.over:
                self._robot.rest()
        self._states.publish(String(data=self._state.model_dump_json()))
        self._happened(self._observer.sees(self._state.run, self._clock.wall()))
        if keep and self._store is not None:
            self._worker.post(self._keep)

    def _keep(self) -> None:
        """Write the newest down; on the worker, as all that is written."""
        state = self._state
        if state is self._written:
            return
        try:
            self._write(state)
        except StoreError as error:
            notice = f"what the mission does cannot be written down: {error}"
            self._log.error(notice)
            self._main.post(lambda: self._tell_unwritten(notice))
        else:
            if self._unwritten:
                self._main.post(lambda: self._tell_unwritten(""))

    def _write(self, state: MissionState) -> None:
        self._kept().keep(state)
        self._written = state

    def _tell_unwritten(self, notice: str) -> None:
        if notice or self._state.notice == self._unwritten:
            self._set(notice=notice)
            self._states.publish(String(data=self._state.model_dump_json()))
        self._unwritten = notice

    def _tell_book(self, book: MissionBook) -> None:
        self._book = book
        self._books.publish(String(data=book.model_dump_json()))

    def _kept(self) -> MissionStore:
        assert self._store is not None  # or it was refused
        return self._store

    def _set(self, **fields: object) -> None:
        self._state = self._state.model_copy(update=fields)

    def _now(self) -> Now:
        return Now(self._clock.monotonic(), self._clock.wall())

    def _hour(self) -> datetime:
        return self._local(self._clock.wall())

    def _local(self, wall: float) -> datetime:
        return datetime.fromtimestamp(wall, self._zone).replace(tzinfo=None)


def _editor(who: Who) -> Editor:
    return "engineer" if who.role == "engineer" else "operator"
