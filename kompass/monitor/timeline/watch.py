"""What of the robot is looked at for its timeline: health, drive manager, goals, processes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

from automatika_ros_sugar.msg import ComponentStatus
from kompass_interfaces.msg import DriveState
from pydantic import ValidationError
from std_msgs.msg import String

from kompass.bus.node import Node
from kompass.components.base.people import People
from kompass.components.planner.goal_reports import GOAL_REPORTS, REPORTS
from kompass.invalid import first_invalid
from kompass.monitor.introspection.catalog import RecipeCatalog, status_topics
from kompass.rclpy_ext.timers import Timers
from kompass.rclpy_ext.topic import LATCHED
from kompass.rclpy_ext.unreadable import LeftOut, Unreadable, read_message
from kompass.supervisor.news import ProcessNews
from kompass.timeline.drive import DriveObserver, DriveSaid
from kompass.timeline.goal import GoalObserver, GoalReport
from kompass.timeline.happening import Happening
from kompass.timeline.health import HealthObserver, Said
from kompass.timeline.process import ProcessObserver

PERIOD = 0.5  # s between looks for what has lasted long enough


class RobotWatch:
    """Listens, and tells what happens.

    Parameters
    ----------
    node, timers
        Where it runs.
    catalog
        Says which components there are.
    tell
        Takes what happens.

    Attributes
    ----------
    people
        What people did by STOP and the wheel.
    """

    def __init__(
        self,
        node: Node,
        timers: Timers,
        catalog: RecipeCatalog,
        tell: Callable[[Iterable[Happening]], None],
    ) -> None:
        self._clock, self._tell, self._log = node.clock, tell, node.get_logger()
        self._health, self._drive = HealthObserver(), DriveObserver()
        self._goals, self._processes = GoalObserver(), ProcessObserver()
        self._newest: dict[str, bytes] = {}
        self._left_out = LeftOut(node, "the status of a component")
        self.people = People()
        for component in catalog.components():
            topic, _ = status_topics(component)
            node.create_subscription(
                *(ComponentStatus, topic, partial(self._on_status, component), LATCHED.to_ros()),
                raw=True,
            )
        node.create_subscription(DriveState, "drive_state", self._on_drive, LATCHED.to_ros())
        node.create_subscription(String, GOAL_REPORTS, self._on_goal, REPORTS.to_ros())
        timers.every(PERIOD, self._look)

    def process_changed(self, news: ProcessNews) -> None:
        """Take the state of a process, as the supervisor tells it."""
        now = self._clock.wall()
        self._tell(self._processes.told(news, now))
        if news.is_lost:
            self._tell(self._goals.lost(news.nodes, now))
            for node in news.nodes:
                self._newest.pop(node, None)

    def _look(self) -> None:
        now = self._clock.wall()
        self._tell([*self._health.due(now), *self._drive.due(now)])

    def _on_status(self, component: str, raw: bytes) -> None:
        # Each says five times a second what it said before; that is not worth being taken apart.
        if self._newest.get(component) == raw:
            return
        self._newest[component] = raw
        try:
            message: Any = read_message(raw, ComponentStatus)
        except Unreadable as error:
            self._left_out.tell(error)
            return
        said = Said(
            int(message.status),
            str(message.msg),
            tuple(message.src_topics),
            tuple(message.src_components),
            tuple(message.src_algorithms),
        )
        lost = self._processes.lost
        self._tell(self._health.says(component, said, self._clock.wall(), lost))

    def _on_drive(self, message: DriveState) -> None:
        self.people.hear(message, self._clock.monotonic(), self._clock.wall())
        said = DriveSaid(
            bool(message.stopped),
            str(message.stopped_by),
            str(message.reason),
            float(message.speed_factor),
            str(message.limited_by),
            str(message.driven_by),
        )
        self._tell(self._drive.says(said, self._clock.wall()))

    def _on_goal(self, message: String) -> None:
        try:
            report = GoalReport.model_validate_json(message.data)
        except ValidationError as error:
            self._log.error(f"/{GOAL_REPORTS}: {first_invalid(error).text}")
            return
        self._tell(self._goals.told(report))
