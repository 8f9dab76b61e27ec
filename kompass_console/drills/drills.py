"""The drills of this console: one at a time, and what came of the last ones."""

from __future__ import annotations

import os
import secrets
import threading
import time
from collections import OrderedDict
from dataclasses import dataclass, field

from kompass.drills.report_json import Report
from kompass.drills.runner.program import DrillOrder, Failed, Finished, Progress
from kompass.drills.scenario import USUAL_ROBOT
from kompass.rules.schema.table import Table
from kompass.simulation.physics.robot_model import RobotModel, robot_model
from kompass.simulation.worlds.registry import world, world_names
from kompass.simulation.worlds.shapes import Box, Shape
from kompass_console.drills.process import DrillNews, DrillProcess
from kompass_console.drills.subject import DrillSubject
from kompass_console.schema.drill_models import (
    DrillDrive,
    DrillOptions,
    DrillPair,
    DrillPlace,
    DrillProgress,
    DrillState,
    DrillSummary,
    DrillWall,
    DrillWish,
)

LIMIT = 1800.0  # s
MEMORY = 4 << 30  # bytes of address space for each process; a drive takes an eighth of it
_KEPT = 4  # reports


class Busy(Exception):
    """A drill runs already; the message says whose."""


class CannotDrill(Exception):
    """There is no drill here, or not now; the message says why."""

    def __init__(self, why: str, remedy: str) -> None:
        super().__init__(why)
        self.remedy = remedy


@dataclass(slots=True)
class _Run:
    id: str
    by: str
    session: str
    revision: int
    total: int
    wish: DrillWish
    enough: int  # drives after which it can be told how long the others take
    state: DrillState = "running"
    done: int = 0
    began: float = 0.0  # of the first drive; 0 before
    ended: float = 0.0
    error: str = ""
    canceled: bool = False
    report: Report | None = None
    process: DrillProcess | None = None
    lock: threading.Lock = field(default_factory=threading.Lock)

    def hear(self, news: DrillNews) -> None:
        """Take what the program says. The drill's thread."""
        with self.lock:
            match news:
                case Progress():
                    self.began = self.began or time.monotonic()
                    self.done, self.total = news.done, news.total
                    return
                case Failed():
                    self.state, self.error = "canceled" if self.canceled else "failed", news.text
                case Finished():
                    self.state, self.report = "done", news.report
            self.ended = time.monotonic()

    def told(self) -> DrillProgress:
        """How far it is."""
        with self.lock:
            until = self.ended or time.monotonic()
            elapsed = until - self.began if self.began else 0.0
            left = None
            if self.state == "running" and self.done >= self.enough:
                left = elapsed / self.done * (self.total - self.done)
            return DrillProgress(
                id=self.id,
                state=self.state,
                by=self.by,
                revision=self.revision,
                done=self.done,
                total=self.total,
                elapsed=elapsed,
                left=left,
                error=self.error or None,
                wish=self.wish,
                report=None if self.report is None else _summary(self.report),
            )


class Drills:
    """Begins drills, tells how far they are, and ends them.

    Parameters
    ----------
    subject
        What can be drilled; None where nothing can.
    """

    def __init__(self, subject: DrillSubject | None) -> None:
        self._subject = subject
        self._runs: OrderedDict[str, _Run] = OrderedDict()
        self._lock = threading.Lock()
        self._closed = False

    @property
    def refusal(self) -> CannotDrill | None:
        """Why nothing can be drilled here; None when something can."""
        if self._subject is None:
            return CannotDrill(
                "This console was attached to a robot that something else started, so it does not "
                "have the recipe that a drill would drive.",
                "Start the robot with kompass-console run, or use kompass-console drill where the "
                "recipe is.",
            )
        if why := self._subject.changed:
            return CannotDrill(
                f"The recipe {why}: a drill would drive another robot than this one.",
                "Start the robot again.",
            )
        return None

    @property
    def own_world(self) -> str | None:
        """The world in which the embedded robot drives; None for another robot."""
        return None if self._subject is None else self._subject.world

    @property
    def robot(self) -> RobotModel:
        """The embedded one that drives in drills."""
        return robot_model(USUAL_ROBOT if self._subject is None else self._subject.robot)

    @property
    def recipe(self) -> str:
        """Name of the recipe's file; empty when there is none."""
        return "" if self._subject is None else self._subject.recipe.name

    @property
    def newest(self) -> DrillProgress | None:
        """The drill that runs, or ran last."""
        with self._lock:
            run = next(reversed(self._runs.values()), None)
        return None if run is None else run.told()

    def start(
        self,
        options: DrillOptions,
        *,
        proposed: Table,
        in_force: Table,
        revision: int,
        by: str,
        session: str,
    ) -> str:
        """Begin one; its id.

        Raises
        ------
        CannotDrill
            When there is nothing to drill.
        Busy
            When one runs.
        """
        refused = self.refusal
        if refused is not None or self._subject is None:
            raise refused or CannotDrill("There is nothing to drill.", "")
        order = DrillOrder(
            recipe=str(self._subject.recipe),
            proposed=proposed,
            proposed_name="proposed",
            in_force=in_force,
            in_force_name=f"revision {revision}",
            scenario=options.scenario,
            worlds=(options.world or self.own_world or world_names()[0],),
            robot=self._subject.robot,
            faults=tuple(options.faults),
            faults_per_drive=options.faults_per_drive,
            lasting=options.lasting,
            seed=options.seed,
            drives=options.drives,
            jobs=max(1, len(os.sched_getaffinity(0)) - 1),
            memory=MEMORY,
            starter=os.getpid(),
        )
        with self._lock:
            running = next((run for run in self._runs.values() if run.state == "running"), None)
            if running is not None:
                raise Busy(
                    f"A drill of {running.by}'s runs already: {running.done} of {running.total} "
                    "drives are made."
                )
            if self._closed:
                raise CannotDrill("The console is ending.", "Start it again.")
            # The tables' drives may differ much in length: some of both must be over.
            enough, total = 2 * order.jobs, 2 * options.drives
            run = _Run(secrets.token_hex(8), by, session, revision, total, _wish(order), enough)
            self._runs[run.id] = run
            while len(self._runs) > _KEPT:
                self._runs.popitem(last=False)
            run.process = DrillProcess(order, LIMIT, run.hear)
        return run.id

    def progress(self, run_id: str) -> DrillProgress | None:
        """How far it is; None when it is not known. Any thread."""
        run = self._runs.get(run_id)
        return None if run is None else run.told()

    def report(self, run_id: str) -> Report | None:
        """All that came of one that is done; None for any other."""
        run = self._runs.get(run_id)
        return None if run is None else run.report

    def pair(self, run_id: str, scenario: str) -> DrillPair | None:
        """A scenario's drives under both tables; None when there are none."""
        report = self.report(run_id)
        if report is None:
            return None
        for proposed, in_force in zip(report.drives, report.drives_against, strict=True):
            if proposed.scenario.name == scenario:
                return DrillPair(
                    place=place_of(proposed.scenario.world), proposed=proposed, in_force=in_force
                )
        return None

    def cancel(self, run_id: str, why: str) -> bool:
        """End one that runs, or forget one that has ended; False when it is not known."""
        with self._lock:
            run = self._runs.get(run_id)
            if run is None:
                return False
            if run.state != "running":
                del self._runs[run_id]
                return True
        _end(run, why)
        if run.process is not None:
            run.process.join()  # killed: the next may begin as soon as this has answered
        return True

    def overtaken(self, revision: int) -> None:
        """A later revision is in force: what is compared with one before is of no use any more."""
        for run in self._listed():
            if run.revision < revision:
                _end(run, f"Ended: revision {revision} was put in force meanwhile.")

    def left(self, session: str) -> None:
        """Somebody has logged out: nobody waits for their drill."""
        for run in self._listed():
            if run.session == session:
                _end(run, f"Ended: {run.by} logged out.")

    def close(self) -> None:
        """End what runs, and wait until nothing is left of it."""
        with self._lock:
            self._closed = True
        for run in self._listed():
            _end(run, "Ended with the console.")
            if run.process is not None:
                run.process.join()

    def _listed(self) -> list[_Run]:
        with self._lock:
            return [run for run in self._runs.values() if run.state == "running"]


def _wish(order: DrillOrder) -> DrillWish:
    own = order.scenario
    return DrillWish(
        faults=list(order.faults) if own is None else [fault.name for fault in own.faults],
        world=order.worlds[0] if own is None else own.world,
        drives=order.drives,
        scenario=None if own is None else own.name,
    )


def _end(run: _Run, why: str) -> None:
    with run.lock:
        if run.state != "running":
            return
        run.canceled = True
    if run.process is not None:
        run.process.end(why)


def _summary(report: Report) -> DrillSummary:
    comparison = report.comparison
    assert comparison is not None
    changes = {change.scenario: change for change in comparison.changes}
    order = {change.scenario: place for place, change in enumerate(comparison.changes)}
    drives = sorted(report.drives, key=lambda one: order.get(one.scenario.name, len(order)))
    before = {drive.scenario.name: drive for drive in report.drives_against}
    return DrillSummary(
        sentence=report.sentence,
        chance=comparison.chance,
        notes=list(report.notes),
        verdict=comparison.verdict,
        recipe=report.recipe,
        proposed=report.table.name,
        in_force="" if report.against is None else report.against.name,
        drives=[
            DrillDrive(
                name=drive.scenario.name,
                world=drive.scenario.world,
                faults=list(drive.scenario.faults),
                change="same" if found is None else found.change,
                text=drive.why if found is None else found.text,
                why=drive.why,
                proposed=drive.outcome,
                in_force=before[drive.scenario.name].outcome,
            )
            for drive in drives
            for found in (changes.get(drive.scenario.name),)
        ],
    )


def place_of(name: str) -> DrillPlace:
    """A world from above.

    Raises
    ------
    ValueError
        There is no such world.
    """
    place = world(name)
    return DrillPlace(
        name=name,
        title=place.title,
        bounds=place.bounds,
        start=place.start,
        floor=list(place.floor),
        walls=[_wall(solid) for solid in place.solids],
        doorways=[door.name for door in place.doorways],
    )


def _wall(solid: Shape) -> DrillWall:
    x, y = solid.center
    if isinstance(solid, Box):
        length, width = solid.size
        return DrillWall(x=x, y=y, yaw=solid.yaw, length=length, width=width, round=False)
    across = 2 * solid.radius
    return DrillWall(x=x, y=y, yaw=0.0, length=across, width=across, round=True)
