"""One run of a mission: where it is, and what comes next. No ROS and no clock: time is given."""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

from pydantic import Field

from kompass.missions.mission import Act, Ask, Halt, Mission, Task, Wait, Waypoint
from kompass.places.place import AuthorName
from kompass.rules.schema.model import Model

MOST_SKIPPED = 50  # that are kept of a run
LONGEST_REASON = 500  # characters

Phase = Literal["driving", "waiting", "asking", "acting", "paused", "done", "failed", "canceled"]
OVER: frozenset[Phase] = frozenset({"done", "failed", "canceled"})


class Skipped(Model):
    """A waypoint that was left out, and why."""

    round: int
    waypoint: int
    reason: str


class Run(Model):
    """Where a run is.

    Attributes
    ----------
    number
        Counts the runs of the robot.
    mission
        As it was when the run began.
    by, started
        Who began it, and when (s since the epoch).
    phase, since
        What goes on, and from when on (s since the epoch).
    step
        Counts the phases: who decides about one says which.
    round
        From 1.
    waypoint
        To which it goes or at which it is, from 0.
    tasks_done
        Of those at the waypoint.
    attempt
        To get to the waypoint, from 1.
    waited
        How much of the next wait is over [s]; counted when it is interrupted.
    reason, decided_by
        Why it is paused or over, and who wanted that; empty where nobody did.
    arrivals
        How often it arrived at a place in this round.
    skipped
        The last that were left out.
    """

    number: Annotated[int, Field(ge=1)]
    mission: Mission
    by: AuthorName
    started: float
    phase: Phase
    since: float
    step: Annotated[int, Field(ge=0)] = 0
    round: Annotated[int, Field(ge=1)] = 1
    waypoint: Annotated[int, Field(ge=0)] = 0
    tasks_done: Annotated[int, Field(ge=0)] = 0
    attempt: Annotated[int, Field(ge=1)] = 1
    waited: Annotated[float, Field(ge=0.0)] = 0.0
    reason: str = ""
    decided_by: str = ""
    arrivals: Annotated[int, Field(ge=0)] = 0
    skipped: tuple[Skipped, ...] = ()

    @property
    def over(self) -> bool:
        """Whether it has ended."""
        return self.phase in OVER

    @property
    def here(self) -> Waypoint:
        """The waypoint to which it goes, or at which it is."""
        return self.mission.waypoints[self.waypoint]

    @property
    def task(self) -> Task | None:
        """What is to be done next at the waypoint; None when all is done."""
        tasks = self.here.tasks
        return tasks[self.tasks_done] if self.tasks_done < len(tasks) else None


class Now(NamedTuple):
    """The time: of a clock that never goes back, and of the day [s]."""

    monotonic: float
    wall: float


class GoTo(NamedTuple):
    """Drive to the place of a waypoint; the end is told with :meth:`MissionRun.drive_ended`."""

    ticket: int
    place: int


class Perform(NamedTuple):
    """Do it; the end is told with :meth:`MissionRun.task_ended`."""

    ticket: int
    task: Act | Halt


class Cease(NamedTuple):
    """End what is under way: the drive, or the action."""


Effect = GoTo | Perform | Cease
# Of a drive. `interrupted`: somebody else decided so, and a person decides how it goes on.
DriveEnd = Literal["arrived", "failed", "interrupted"]


class MissionRefused(ValueError):
    """It cannot be done now; the message says why, and what to do."""


class MissionRun:
    """Advances a run; what is to be done comes out as effects.

    Every drive and action has a ticket. What is told of one that is no more awaited changes
    nothing.

    Parameters
    ----------
    run
        To go on from. One that was under way is paused: whoever knew of it has gone meanwhile.
    """

    def __init__(self, run: Run, now: Now) -> None:
        self.run = run
        self._ticket, self._under_way = 0, False
        self._wait_began: float | None = None
        if not run.over and run.phase != "paused":
            self._pause(
                f"The robot's program ended while it was {_DOING[run.phase]}, and has begun anew; "
                "nothing was done since.",
                "",
                now,
            )

    def awaits(self, ticket: int) -> bool:
        """Whether that drive or action is still the one that is wanted."""
        return self._under_way and ticket == self._ticket

    @property
    def due(self) -> float | None:
        """When :meth:`tick` has something to do (monotonic, s); None for never."""
        task = self.run.task
        if self._wait_began is None or not isinstance(task, Wait):
            return None
        return self._wait_began + task.seconds - self.run.waited

    def left(self, now: Now) -> float | None:
        """How long the wait still lasts [s]; None when it does not wait."""
        return None if self.due is None else max(0.0, self.due - now.monotonic)

    # -- what happens -------------------------------------------------------------------------

    def drive_ended(self, ticket: int, end: DriveEnd, reason: str, now: Now) -> tuple[Effect, ...]:
        """The drive has come to its end."""
        if not self.awaits(ticket):
            return ()
        self._under_way = False
        if end == "arrived":
            self._set(arrivals=self.run.arrivals + 1, attempt=1)
            return self._go_on(now)
        if end == "interrupted":
            return self._pause(reason, "", now)
        if self.run.attempt < self.run.mission.attempts:
            self._set(attempt=self.run.attempt + 1)
            return self._set_off(now)
        return self._failed(reason, now)

    def task_ended(self, ticket: int, ok: bool, reason: str, now: Now) -> tuple[Effect, ...]:
        """What was to be performed has been, or has failed."""
        if not self.awaits(ticket):
            return ()
        self._under_way, halted = False, isinstance(self.run.task, Halt)
        if not ok:
            return self._failed(reason, now)
        self._set(tasks_done=self.run.tasks_done + 1)
        if halted:
            return self._pause("STOP was pressed here, as the mission says.", "", now)
        return self._go_on(now)

    def tick(self, now: Now) -> tuple[Effect, ...]:
        """Let time pass."""
        if self.due is None or now.monotonic < self.due:
            return ()
        return self._task_done(now)

    def interrupted(self, reason: str, now: Now) -> tuple[Effect, ...]:
        """Somebody has stopped the robot, or drives it by hand: a person decides what follows."""
        if self.run.over or self.run.phase == "paused":
            return ()
        if self.run.phase == "acting" and isinstance(self.run.task, Halt):
            return ()  # it is our own, and its end is told
        return self._pause(reason, "", now)

    # -- what people do -----------------------------------------------------------------------

    def begin(self, now: Now) -> tuple[Effect, ...]:
        """Set off for the first place."""
        return self._set_off(now)

    def pause(self, by: str, now: Now) -> tuple[Effect, ...]:
        """Stand where it is.

        Raises
        ------
        MissionRefused
            When it is paused already, or over.
        """
        self._check_under_way()
        if self.run.phase == "paused":
            raise MissionRefused("the mission is paused already; resume it, or cancel it")
        return self._pause("", by, now)

    def resume(self, by: str, now: Now) -> tuple[Effect, ...]:
        """Go on: to the place first, for it may have been moved, and with what is left to do there.

        Raises
        ------
        MissionRefused
            When it is not paused.
        """
        self._check_under_way()
        if self.run.phase != "paused":
            raise MissionRefused("the mission is not paused; nothing is to be resumed")
        self._set(reason="", decided_by=by, attempt=1)
        return self._go_on(now) if self._all_done_here() else self._set_off(now)

    def skip(self, by: str, now: Now) -> tuple[Effect, ...]:
        """Leave out what is under way or paused: a task where it is there, else the place.

        Raises
        ------
        MissionRefused
            When it is over.
        """
        self._check_under_way()
        ceased = self._cease()
        if self.run.phase in ("waiting", "asking", "acting"):
            return (*ceased, *self._task_done(now))
        return (*ceased, *self._leave_out(f"{by} skipped it", by, now))

    def confirm(self, by: str, now: Now) -> tuple[Effect, ...]:
        """Say that it may go on, where it asks for that.

        Raises
        ------
        MissionRefused
            When it asks for nothing.
        """
        self._check_under_way()
        if self.run.phase != "asking":
            raise MissionRefused("the mission waits for nobody now; look at what it does")
        self._set(decided_by=by)
        return self._task_done(now)

    def cancel(self, by: str, now: Now) -> tuple[Effect, ...]:
        """End it here.

        Raises
        ------
        MissionRefused
            When it is over.
        """
        self._check_under_way()
        return self._end("canceled", "", by, now)

    # -- pieces -------------------------------------------------------------------------------

    def _check_under_way(self) -> None:
        if self.run.over:
            raise MissionRefused(f"the mission is over ({self.run.phase}); start it again")

    def _set(self, **fields: object) -> None:
        self.run = self.run.model_copy(update=fields)

    def _enter(self, phase: Phase, now: Now, **fields: object) -> None:
        self._wait_began = None
        self._set(phase=phase, since=now.wall, step=self.run.step + 1, **fields)

    def _all_done_here(self) -> bool:
        return bool(self.run.tasks_done) and self.run.task is None

    def _set_off(self, now: Now) -> tuple[Effect, ...]:
        self._ticket, self._under_way = self._ticket + 1, True
        self._enter("driving", now, reason="")
        return (GoTo(self._ticket, self.run.here.place),)

    def _go_on(self, now: Now) -> tuple[Effect, ...]:
        """At the place: the next task, or from there on."""
        task = self.run.task
        if task is None:
            return self._next_waypoint(now)
        if isinstance(task, Wait):
            self._enter("waiting", now)
            self._wait_began = now.monotonic
            return ()
        if isinstance(task, Ask):
            self._enter("asking", now)
            return ()
        self._ticket, self._under_way = self._ticket + 1, True
        self._enter("acting", now)
        return (Perform(self._ticket, task),)

    def _task_done(self, now: Now) -> tuple[Effect, ...]:
        self._set(tasks_done=self.run.tasks_done + 1, waited=0.0)
        return self._go_on(now)

    def _next_waypoint(self, now: Now) -> tuple[Effect, ...]:
        run = self.run
        fresh = {"tasks_done": 0, "attempt": 1, "waited": 0.0}
        if run.waypoint + 1 < len(run.mission.waypoints):
            self._set(waypoint=run.waypoint + 1, **fresh)
            return self._set_off(now)
        if run.mission.rounds and run.round >= run.mission.rounds:
            return self._end("done", "", "", now)
        self._set(waypoint=0, round=run.round + 1, arrivals=0, **fresh)
        if not run.arrivals:
            return self._pause("No place was reached in a whole round.", "", now)
        return self._set_off(now)

    def _failed(self, reason: str, now: Now) -> tuple[Effect, ...]:
        policy = self.run.mission.on_failure
        if policy == "skip":
            return self._leave_out(reason, "", now)
        if policy == "end":
            return self._end("failed", reason, "", now)
        return self._pause(reason, "", now)

    def _leave_out(self, reason: str, by: str, now: Now) -> tuple[Effect, ...]:
        run = self.run
        left_out = Skipped(round=run.round, waypoint=run.waypoint, reason=reason[:LONGEST_REASON])
        skipped = (*run.skipped, left_out)[-MOST_SKIPPED:]
        self._set(skipped=skipped, decided_by=by)
        return self._next_waypoint(now)

    def _pause(self, reason: str, by: str, now: Now) -> tuple[Effect, ...]:
        ceased = self._cease()
        waited = self.run.waited
        if self._wait_began is not None:
            waited += now.monotonic - self._wait_began
        self._enter("paused", now, reason=reason[:LONGEST_REASON], decided_by=by, waited=waited)
        return ceased

    def _end(self, phase: Phase, reason: str, by: str, now: Now) -> tuple[Effect, ...]:
        ceased = self._cease()
        self._enter(phase, now, reason=reason[:LONGEST_REASON], decided_by=by)
        return ceased

    def _cease(self) -> tuple[Effect, ...]:
        """What is under way is awaited no more."""
        under_way, self._under_way = self._under_way, False
        return (Cease(),) if under_way else ()


_DOING: dict[Phase, str] = {
    "driving": "driving",
    "waiting": "waiting",
    "asking": "waiting for a person",
    "acting": "doing something at a place",
}
