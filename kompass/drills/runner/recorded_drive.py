"""A scenario made of a recording: what was asked of the robot, and what broke, as it was seen."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from geometry_msgs.msg import PointStamped, PoseStamped
from kompass_interfaces.msg import DriveState, StackState
from nav_msgs.msg import OccupancyGrid, Odometry
from nav_msgs.msg import Path as PathMessage
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

from kompass.algorithms.map_file import load_map
from kompass.backtest.event_log import Began, Resumed, Swapped
from kompass.drills.runner.recording import SCENARIO
from kompass.drills.scenario import (
    LONGEST,
    USUAL_ROBOT,
    Goal,
    OperatorAct,
    Scenario,
    ScheduledFault,
    Start,
)
from kompass.drills.scenario_file import parse_scenario
from kompass.recorder.clip import is_event
from kompass.recorder.mcap.reader import Recording, Track, messages
from kompass.recorder.replay.beginning import DRIVE as DRIVE_OF_DRILL
from kompass.recorder.replay.beginning import beginning
from kompass.recorder.streams import REPEAT, read_event
from kompass.rules.schema.table import Table
from kompass.share import map_path
from kompass.simulation.faults.fault_names import AT_ONCE, MAP_WITHHELD, UnknownFault, check_fault
from kompass.simulation.physics.robot_model import robot_names
from kompass.simulation.worlds.registry import world_names

MARGIN = 30.0  # s that the drive may take longer than the recorded one
SILENT = 0.5  # s without a message of a sensor, from which on it is taken to be unplugged
HELD_BEFORE_STUCK = 0.65  # s that a process was silent before it is called stuck
SAME_PLACE = 0.05  # m between two goals that are one
MOVES = 0.02  # m/s
MAP, POSE, SCAN, PLAN = "/map", "/odometry/filtered", "/scan", "/plan"
FAULTS, STACK, DRIVE = "/simulator/faults", "/monitor/stack_state", "/drive_state"
INITIAL_POSE, DESCRIPTION = "/initialpose", "/robot_description"
_CLICKS: Mapping[str, type[Any]] = {"/clicked_point": PointStamped, "/goal_pose": PoseStamped}
_KINDS: Mapping[str, type[Any]] = {
    MAP: OccupancyGrid,
    POSE: Odometry,
    SCAN: LaserScan,
    PLAN: PathMessage,
    FAULTS: String,
    DESCRIPTION: String,
    STACK: StackState,
    DRIVE: DriveState,
    **_CLICKS,
}
# Nobody can be in a drill who takes no part in it.
_BESIDE = ("recorder", "console", "guard")


class NoScenario(ValueError):
    """No scenario can be made of a recording; the message says what is missing, and what to do."""


class Found(NamedTuple):
    """A scenario, and what could not be carried over.

    Attributes
    ----------
    table
        In force at its beginning; None where no rules were recorded.
    """

    scenario: Scenario
    remarks: tuple[str, ...]
    table: Table | None

    @property
    def sentence(self) -> str:
        """What is in it."""
        made = self.scenario
        parts = [
            f"{len(each)} {one if len(each) == 1 else many}"
            for each, one, many in (
                (made.goals, "goal", "goals"),
                (made.faults, "fault", "faults"),
                (made.operators, "press or release of STOP", "presses and releases of STOP"),
            )
            if each
        ]
        return f"{made.world}, {', '.join(parts)}, {made.limit:g} s at most"


class _Said(NamedTuple):
    at: float  # s since the beginning of the recording
    message: Any


@dataclass
class _Heard:
    """What a recording holds of a drive, by topic."""

    length: float = 0.0
    topics: dict[str, list[_Said]] = field(default_factory=dict)
    tables: list[tuple[float, Table]] = field(default_factory=list)
    poses_set: int = 0

    def of(self, topic: str) -> list[_Said]:
        return self.topics.get(topic, [])


def scenario_of(path: Path, name: str, begin: float | None, end: float | None) -> Found:
    """Make a scenario of a recording, or of a stretch of it.

    Parameters
    ----------
    path
        A recording of the flight recorder, or of a drill.
    begin, end
        Seconds since its beginning, or that of its drive; None for all of it.

    Raises
    ------
    NoScenario
        When something is missing, as a map that one of the worlds has.
    NotMcap
        When the file is damaged.
    pydantic.ValidationError
        When it would be a scenario that cannot be carried out.
    """
    with Recording([path]) as recording:
        if begin is None and end is None:
            known = [file.contents.metadata.get(DRIVE_OF_DRILL) for file in recording.files]
            if known and known[0] is not None:
                return _drilled(known[0][SCENARIO], name, _read(recording))
        heard = _read(recording)
    start = begin or 0.0
    stop = heard.length if end is None else min(end, heard.length)
    if start >= stop:
        raise NoScenario(
            f"from {start:g} s to {stop:g} s there is nothing: the recording lasts "
            f"{heard.length:.0f} s; choose others"
        )
    return _Stretch(heard, start, stop).scenario(name)


def _drilled(text: str, name: str, heard: _Heard) -> Found:
    """What a drill has written down of its own."""
    scenario = parse_scenario(text).model_copy(update={"name": name})
    table = next((table for _, table in heard.tables), None)
    return Found(scenario, ("it is a drive of a drill: this is its scenario as it was",), table)


def _read(recording: Recording) -> _Heard:
    heard = _Heard()
    first, last = beginning(recording), recording.end_time
    heard.length = (last - first) * 1e-9

    def wanted(track: Track) -> bool:
        return track.topic in _KINDS or track.topic == INITIAL_POSE or is_event(track)

    for message in messages(recording.files, wanted):
        track, at = message.track, (message.log_time - first) * 1e-9
        if is_event(track):
            event = read_event(message.data).event
            if isinstance(event, Began | Resumed | Swapped):
                heard.tables.append((at, event.table))
        elif track.topic == INITIAL_POSE:
            heard.poses_set += not track.source.endswith(REPEAT)
        # What a file repeats at its beginning was said before: it is valid, and no goal.
        elif not (track.source.endswith(REPEAT) and track.topic in _CLICKS):
            said = _Said(at, deserialize_message(message.data, _KINDS[track.topic]))
            heard.topics.setdefault(track.topic, []).append(said)
    return heard


class _Stretch:
    def __init__(self, heard: _Heard, begin: float, end: float) -> None:
        self._heard, self._begin, self._end = heard, begin, end
        self._remarks: list[str] = []

    def scenario(self, name: str) -> Found:
        """All of it, put together."""
        place = self._world()
        start = self._start()
        limit = round(min(self._end - self._begin + MARGIN, LONGEST), 3)
        faults = self._faults()
        made = Scenario(
            name=name,
            world=place,
            robot=self._robot(),
            start=start,
            goals=tuple(self._goals()),
            faults=tuple(sorted(faults, key=lambda fault: fault.at)),
            operators=tuple(self._operators()),
            limit=limit,
        )
        table = self._table()
        self._told_by_hand()
        self._remarks.append("noise and delays are drawn anew (seed 0)")
        return Found(made, tuple(self._remarks), table)

    def _at(self, at: float) -> float:
        return round(max(at - self._begin, 0.0), 3)

    def _within(self, topic: str) -> list[_Said]:
        return [said for said in self._heard.of(topic) if self._begin <= said.at <= self._end]

    def _before(self, topic: str) -> Any:
        """What was valid at the beginning; None for nothing."""
        found = [said.message for said in self._heard.of(topic) if said.at <= self._begin]
        return found[-1] if found else None

    # -- where --------------------------------------------------------------------------------

    def _world(self) -> str:
        maps = self._heard.of(MAP)
        if not maps:
            raise NoScenario(f"it has no {MAP}: nobody knows where that was; record with a map")
        for name in world_names():
            grid = load_map(map_path(name))
            for _, message in maps:
                if _is(message, grid):
                    if len(maps) > 1:
                        self._remarks.append(
                            f"{MAP} changed while it was recorded; the map of {name} counts"
                        )
                    return name
        info = maps[0].message.info
        raise NoScenario(
            f"its {MAP} ({info.width} x {info.height} cells of {info.resolution:.3g} m) is that of "
            f"none of the worlds ({', '.join(world_names())}): there is no physics to drive in; "
            "draw scenarios for a world instead"
        )

    def _robot(self) -> str:
        """Which embedded robot it was, or else the usual one."""
        described = self._heard.of(DESCRIPTION)
        text = described[-1].message.data if described else ""
        found = re.search(r"<robot\b[^>]*\bname=[\"']([^\"']*)", text)
        if found is not None and found[1] in robot_names():
            return found[1]
        why = f"{DESCRIPTION} is not in it" if found is None else f"{found[1]} is not embedded"
        self._remarks.append(f"{why}: the robot is {USUAL_ROBOT}; name another in the scenario")
        return USUAL_ROBOT

    def _start(self) -> Start:
        poses = self._heard.of(POSE)
        if not poses:
            raise NoScenario(f"it has no {POSE}: nobody knows where the robot was; record it")
        after = [said for said in poses if said.at >= self._begin]
        message = (after or poses[-1:])[0].message
        pose, twist = message.pose.pose, message.twist.twist
        if math.hypot(twist.linear.x, twist.linear.y) > MOVES:
            self._remarks.append("the robot was moving at the beginning; it stands there now")
        if self._heard.poses_set:
            self._remarks.append(
                f"{INITIAL_POSE} was given {self._heard.poses_set} times, which is left out: the "
                "embedded robot knows where it begins"
            )
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        return Start(
            x=round(pose.position.x, 4),
            y=round(pose.position.y, 4),
            yaw=round(math.remainder(yaw, math.tau), 4),
        )

    # -- what was asked -----------------------------------------------------------------------

    def _goals(self) -> list[Goal]:
        sent = [
            (said.at, _goal(topic, said.message, self._at(said.at)))
            for topic in _CLICKS
            for said in self._within(topic)
        ]
        sent.sort(key=lambda each: each[0])
        if not any(at - self._begin < 1.0 for at, _ in sent):
            sent[:0] = self._goal_under_way()
        inferred = [
            each
            for each in self._planned()
            if all(math.hypot(each.x - goal.x, each.y - goal.y) > SAME_PLACE for _, goal in sent)
        ]
        if inferred:
            self._remarks.append(
                "goals that were sent as an action are not recorded; here are the ends of "
                f"paths on {PLAN} ({len(inferred)}), without heading and tolerance"
            )
        goals = [goal for _, goal in sent] + inferred
        if not goals:
            raise NoScenario("no goal was sent in that stretch; choose one in which one was")
        return sorted(goals, key=lambda goal: goal.at or 0.0)

    def _goal_under_way(self) -> list[tuple[float, Goal]]:
        """What the robot was driving to when the stretch began, if it was."""
        path = self._before(PLAN)
        last = [
            (said.at, topic, said.message)
            for topic in _CLICKS
            for said in self._heard.of(topic)
            if said.at < self._begin
        ]
        if path is None or not path.poses or not last:
            return []
        _, topic, message = max(last, key=lambda each: each[0])
        self._remarks.append("a goal was under way at the beginning; it is sent then")
        return [(self._begin, _goal(topic, message, 0.0))]

    def _planned(self) -> list[Goal]:
        found: list[Goal] = []
        for said in self._within(PLAN):
            if said.message.poses:
                at = said.message.poses[-1].pose.position
                if not found or math.hypot(found[-1].x - at.x, found[-1].y - at.y) > SAME_PLACE:
                    found.append(Goal(x=round(at.x, 4), y=round(at.y, 4), at=self._at(said.at)))
        return found

    def _operators(self) -> list[OperatorAct]:
        acts: list[OperatorAct] = []
        stopped, by = False, "operator"
        before = self._before(DRIVE)
        states = [_Said(self._begin, before)] if before is not None else []
        unknown = 0
        for at, state in states + self._within(DRIVE):
            if state.stopped and not stopped:
                by = state.stopped_by.strip() or "operator"
                # A rule that presses STOP does so again, if it is to.
                if not by.startswith("rule "):
                    acts.append(
                        OperatorAct(at=self._at(at), does="stop", by=by, reason=state.reason)
                    )
            elif stopped and not state.stopped:
                unknown += 1
                who = "operator" if by.startswith("rule ") else by
                acts.append(OperatorAct(at=self._at(at), does="release", by=who))
            stopped = state.stopped
        if unknown:
            self._remarks.append("who released STOP is not recorded; it is who had pressed it")
        return acts

    def _told_by_hand(self) -> None:
        """Where a hand has moved the robot, what comes after it begins elsewhere."""
        before = self._before(DRIVE)
        states = [_Said(self._begin, before)] if before is not None else []
        driven, since = "", 0.0
        for at, state in [*states, *self._within(DRIVE)]:
            if driven and state.driven_by != driven:
                self._left_out_by_hand(driven, since, at)
            if state.driven_by != driven:
                driven, since = state.driven_by, at
        if driven:
            self._left_out_by_hand(driven, since, self._end)

    def _left_out_by_hand(self, by: str, begin: float, end: float) -> None:
        self._remarks.append(
            f"left out: {by} drove by hand from {self._at(begin):g} s to {self._at(end):g} s; what "
            "comes after that may begin elsewhere. Choose a stretch without it"
        )

    # -- what broke ---------------------------------------------------------------------------

    def _faults(self) -> list[ScheduledFault]:
        faults = self._switched() if self._heard.of(FAULTS) else self._silences()
        known = {fault.name for fault in faults}
        return faults + self._deaths(known)

    def _switched(self) -> list[ScheduledFault]:
        """As the simulator told."""
        spells: dict[str, float] = {}
        found: list[ScheduledFault] = []
        on: list[str] = []
        before = self._before(FAULTS)
        said = [_Said(self._begin, before)] if before is not None else []
        for at, message in said + self._within(FAULTS):
            now = json.loads(message.data)
            for name in now:
                if name not in on:
                    spells[name] = at
            for name in on:
                if name not in now:
                    found += self._fault(name, spells.pop(name), at)
            on = now
        for name, at in spells.items():
            found += self._fault(name, at, None)
        return found

    def _fault(self, name: str, begin: float, end: float | None) -> list[ScheduledFault]:
        try:
            check_fault(name)
        except UnknownFault as error:
            self._remarks.append(f"left out: {error}")
            return []
        at = self._at(begin)
        if name == MAP_WITHHELD and at:
            self._remarks.append(f"left out: {name} at {at:g} s, when the map was there already")
            return []
        lasts = 0.0 if end is None else max(round(end - begin, 3), 0.001)
        return [ScheduledFault(name=name, at=at, duration=lasts)]

    def _silences(self) -> list[ScheduledFault]:
        """What a recording tells that no simulator was asked for."""
        found: list[ScheduledFault] = []
        for topic, name in ((SCAN, "lidar_unplugged"), (POSE, "odometry_silent")):
            times = [said.at for said in self._within(topic)]
            for at, then in zip([self._begin, *times], [*times, self._end], strict=True):
                if then - at > SILENT:
                    end = None if then == self._end else then
                    found += self._fault(name, at, end)
        if found:
            self._remarks.append(
                f"{FAULTS} is not in it: {len(found)} faults are taken from the silence of sensors"
            )
        return found

    def _deaths(self, known: set[str]) -> list[ScheduledFault]:
        found: list[ScheduledFault] = []
        states: dict[str, Any] = {}
        stuck: dict[str, float] = {}
        before = self._before(STACK)
        for process in before.processes if before is not None else ():
            states[process.name] = process
        for at, message in self._within(STACK):
            for process in message.processes:
                last = states.get(process.name)
                states[process.name] = process
                if last is None:
                    continue
                held = any(f"stop:{who}" in known for who in (process.name, *process.nodes))
                if process.state == "stuck" and last.state != "stuck":
                    stuck[process.name] = at
                elif process.state != "stuck" and process.name in stuck and not held:
                    begin = stuck[process.name] - HELD_BEFORE_STUCK
                    found += self._process_fault("stop", process, begin, at)
                died = process.state in ("dead", "given up") and last.state not in (
                    *("dead", "given up"),
                )
                missed = process.restarts > last.restarts and last.state not in ("dead", "given up")
                # One that hung is killed by its supervisor, which will do so again.
                if (died or missed) and process.name not in stuck:
                    found += self._process_fault("kill", process, at, None)
                if process.state != "stuck":
                    stuck.pop(process.name, None)
        return found

    def _process_fault(
        self, kind: str, process: Any, begin: float, end: float | None
    ) -> list[ScheduledFault]:
        if process.name in _BESIDE:
            self._remarks.append(
                f"left out: {process.name} at {self._at(begin):g} s, which is in no drill"
            )
            return []
        if kind == AT_ONCE.rstrip(":") and process.reason and "SIGKILL" not in process.reason:
            self._remarks.append(
                f"{process.name} ended at {self._at(begin):g} s otherwise ({process.reason}); it "
                "is killed then"
            )
        name = f"{kind}:{process.name}"
        if kind == "stop":
            self._remarks.append(f"{name} is taken from its hanging")
        return self._fault(name, max(begin, self._begin), end)

    # -- which rules --------------------------------------------------------------------------

    def _table(self) -> Table | None:
        before = [table for at, table in self._heard.tables if at <= self._begin]
        later = [table for at, table in self._heard.tables if self._begin < at <= self._end]
        if before and any(table != before[-1] for table in later):
            self._remarks.append("other rules were applied meanwhile, which a scenario cannot")
        return before[-1] if before else (later[0] if later else None)


def _goal(topic: str, message: Any, at: float) -> Goal:
    if isinstance(message, PointStamped):
        return Goal(x=round(message.point.x, 4), y=round(message.point.y, 4), at=at, topic=topic)
    pose = message.pose
    yaw = math.remainder(2.0 * math.atan2(pose.orientation.z, pose.orientation.w), math.tau)
    return Goal(
        x=round(pose.position.x, 4),
        y=round(pose.position.y, 4),
        yaw=round(yaw, 4),
        at=at,
        topic=topic,
    )


def _is(message: OccupancyGrid, grid: Any) -> bool:
    """Whether a map is that of a world."""
    height, width = grid.cells.shape
    info = message.info
    place = info.origin.position
    return (
        (info.width, info.height) == (width, height)
        and math.isclose(info.resolution, grid.resolution, rel_tol=1e-5)
        and math.isclose(place.x, grid.origin[0], abs_tol=1e-3)
        and math.isclose(place.y, grid.origin[1], abs_tol=1e-3)
        and bool((grid.cells.astype("int8").tobytes()) == message.data.tobytes())
    )
