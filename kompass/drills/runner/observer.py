"""Writes down what happens in a drive, and takes no part in it."""

from __future__ import annotations

import json
import math
from collections import deque
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

from automatika_ros_sugar.msg import ComponentStatus
from kompass_interfaces.msg import DriveState, RuleFiring
from nav_msgs.msg import Odometry
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String, UInt32

from kompass.bus.node import Node
from kompass.drills.facts import (
    ActionDone,
    AlarmCleared,
    AlarmRaised,
    Contact,
    Fact,
    FaultBegan,
    FaultEnded,
    Motion,
    ProcessEnded,
    ProcessStarted,
    RuleFired,
    RunDone,
    SeesAgain,
    Status,
    StopPressed,
    StopReleased,
    WentBlind,
)
from kompass.monitor.process import NAME as MONITOR
from kompass.rclpy_ext.qos import LATCHED_PROFILE
from kompass.supervisor.news import ProcessNews

PERIOD = 0.1  # s between two looks at the robot
BLIND = 0.5  # s without a message of a sensor
BEFORE = 1e-6  # s between two facts of before the beginning, which keeps their order
PAUSES = 5  # between its last messages, by which its rhythm is told
_ANY = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
_ALL = QoSProfile(depth=100)
SENSES: tuple[tuple[str, str, Any], ...] = (
    ("scan", "/scan", LaserScan),
    ("odometry", "/odometry/filtered", Odometry),
)
TRUTH = "/simulator/ground_truth"
CONTACTS, PERSON_CONTACTS = "/simulator/contacts", "/simulator/person_contacts"


class Observer:
    """Collects facts, from topics and nothing else: also what the embedded robot tells of itself.

    Parameters
    ----------
    node
        Listens; in a process of its own, which no fault strikes.
    components
        Names of those whose statuses are noted.

    Attributes
    ----------
    facts
        What was observed so far; times are seconds since :meth:`begin`. What was seen before counts
        as of then.
    place
        Where the robot truly is, x and y [m]; None before the drive.
    """

    def __init__(self, node: Node, components: Iterable[str]) -> None:
        self.facts: list[Fact] = []
        self._before: list[Fact] = []
        self.place: tuple[float, float] | None = None
        self._node = node
        self._began: float | None = None
        components = list(components)
        self._components = frozenset(components)
        self._silent: set[str] = set()
        self._stopped = False
        self._releasing = ""
        self._release_answered = False
        self._epoch = ""
        self._faults: list[str] = []
        self._alarms: dict[str, str] = {}
        self._truth: Odometry | None = None
        self._contacts = {CONTACTS: 0, PERSON_CONTACTS: 0}
        self._counted = (0, 0)  # contacts with something, and with a person
        self._heard: dict[str, deque[float]] = {}
        self._blind: set[str] = set()
        listen = node.create_subscription
        for name in components:
            note = partial(self._on_status, name)
            listen(ComponentStatus, f"{name}/status", note, LATCHED_PROFILE)
        listen(RuleFiring, f"{MONITOR}/firings", self._on_firing, _ALL)
        listen(String, f"{MONITOR}/alarms", self._on_alarms, LATCHED_PROFILE)
        listen(DriveState, "drive_state", self._on_drive_state, LATCHED_PROFILE)
        listen(String, "/simulator/faults", self._on_faults, LATCHED_PROFILE)
        for sense, topic, kind in SENSES:
            listen(kind, topic, partial(self._on_sense, sense), _ANY)
        listen(Odometry, TRUTH, self._on_truth, _ANY)
        for topic in (CONTACTS, PERSON_CONTACTS):
            listen(UInt32, topic, partial(self._on_contacts, topic), LATCHED_PROFILE)
        node.create_timer(PERIOD, self._look)

    def begin(self) -> None:
        """Let the drive begin: what was seen before counts as of now, in its order.

        Of what components said of themselves while they came up, the last word of each counts.
        """
        self._began = self._node.clock.monotonic()
        last = {seen.component: seen for seen in self._before if isinstance(seen, Status)}
        told = [
            seen
            for seen in self._before
            if not isinstance(seen, Status) or last[seen.component] is seen
        ]
        self.facts += [
            replace(seen, at=round(BEFORE * place, 6)) for place, seen in enumerate(told)
        ]
        self._before.clear()

    @property
    def has_begun(self) -> bool:
        """Whether the drive has begun."""
        return self._began is not None

    @property
    def now(self) -> float:
        """Seconds since the beginning."""
        assert self._began is not None
        return round(self._node.clock.monotonic() - self._began, 6)

    def note(self, kind: type[Any], *values: Any, at: float | None = None, **more: Any) -> None:
        """Write a fact down, at a time or now; see :meth:`begin` for those of before it."""
        if self._began is None:
            self._before.append(kind(0.0, *values, **more))
        else:
            self.facts.append(kind(self.now if at is None else at, *values, **more))

    def on_news(self, news: ProcessNews) -> None:
        """Take what the supervisor tells of a process."""
        if news.state in ("dead", "stuck"):
            self._silent.update(news.nodes)
            hangs = news.state == "stuck"
            # What has no status, as the monitor, nobody can speak for on its topic.
            components = tuple(name for name in news.nodes if name in self._components)
            self.note(ProcessEnded, news.name, components, news.reason, hangs=hangs)
        elif news.state == "active" and self._silent & set(news.nodes):
            self._silent.difference_update(news.nodes)
            self.note(ProcessStarted, news.name)

    # -- topics -------------------------------------------------------------------------------

    def _on_status(self, component: str, status: ComponentStatus) -> None:
        own = component not in self._silent
        self.note(Status, component, int(status.status), status.msg, own=own)

    def _on_firing(self, firing: RuleFiring) -> None:
        details = json.loads(firing.details or "{}")
        run, rule = int(firing.run_id), firing.rule_id
        # Told of what fires, and not of what comes of it, which the same monitor tells.
        self._epoch = epoch = details.get("epoch", self._epoch)
        match firing.phase:
            case "fired":
                self.note(RuleFired, rule, run, firing.text, epoch=epoch)
            case "action":
                self.note(
                    ActionDone, rule, run, details["action"], firing.ok, firing.text, epoch=epoch
                )
            case "done":
                self.note(RunDone, rule, run, firing.ok, firing.text, epoch=epoch)

    def _on_alarms(self, message: String) -> None:
        alarms = {each["name"]: each["text"] for each in json.loads(message.data)}
        for name, text in alarms.items():
            if name not in self._alarms:
                self.note(AlarmRaised, name, text)
        for name in self._alarms:
            if name not in alarms:
                self.note(AlarmCleared, name)
        self._alarms = alarms

    def _on_drive_state(self, state: DriveState) -> None:
        if state.stopped and not self._stopped:
            if self._release_answered:
                self._releasing = ""  # it was for an earlier STOP, or for none
            self.note(StopPressed, state.stopped_by, state.reason)
        elif self._stopped and not state.stopped:
            by = self._releasing or "nobody"
            self.note(StopReleased, by, person=bool(self._releasing))
            self._releasing = ""
        self._stopped = state.stopped

    def releasing(self, by: str) -> None:
        """A person asks for the release of STOP; who else lets it go is none.

        It may be asked for before STOP has been heard of: requests have a way, too.
        """
        self._releasing, self._release_answered = by, False

    def release_answered(self, *, released: bool) -> None:
        """A request for the release was carried out, or refused."""
        self._release_answered = True
        if not released:
            self._releasing = ""

    def _on_faults(self, message: String) -> None:
        faults = json.loads(message.data)
        for name in faults:
            if name not in self._faults:
                self.note(FaultBegan, name)
        for name in self._faults:
            if name not in faults:
                self.note(FaultEnded, name)
        self._faults = faults

    def _on_sense(self, sense: str, _: object) -> None:
        heard = self._heard.setdefault(sense, deque(maxlen=PAUSES + 1))
        heard.append(self._node.clock.monotonic())
        if sense in self._blind:
            self._blind.discard(sense)
            self.note(SeesAgain, sense)

    # -- the truth ----------------------------------------------------------------------------

    def _on_truth(self, message: Odometry) -> None:
        self._truth = message

    def _on_contacts(self, topic: str, message: UInt32) -> None:
        self._contacts[topic] = int(message.data)

    def _look(self) -> None:
        if self._began is None:
            return
        now = self._node.clock.monotonic()
        for sense, times in self._heard.items():
            at = times[-1]
            if now - at > BLIND and sense not in self._blind:
                self._blind.add(sense)
                period = max((after - before for before, after in pairwise(times)), default=0.0)
                begin = round(max(at - self._began, 0.0), 6)
                self.note(WentBlind, sense, round(period, 6), at=begin)
        if self._truth is not None:
            self._note_motion(self._truth)
        # Both counts of one moment have come by now, in whatever order.
        of_people = self._contacts[PERSON_CONTACTS]
        others = self._contacts[CONTACTS] - of_people
        for what, count, before in zip(
            ("something", "a person"), (others, of_people), self._counted, strict=True
        ):
            for _ in range(count - before):
                self.note(Contact, what)
        self._counted = (others, of_people)

    def _note_motion(self, odometry: Odometry) -> None:
        at, twist = odometry.pose.pose, odometry.twist.twist
        yaw = 2.0 * math.atan2(at.orientation.z, at.orientation.w)
        self.place = at.position.x, at.position.y
        self.note(
            Motion,
            *(round(part, 4) for part in (at.position.x, at.position.y, yaw)),
            round(math.hypot(twist.linear.x, twist.linear.y), 4),
            round(twist.angular.z, 4),
        )
