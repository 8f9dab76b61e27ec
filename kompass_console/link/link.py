"""The console's node: discovers what is on the graph and keeps the world up to date."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import rclpy
from kompass_interfaces.srv import CheckGoal
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import get_rmw_implementation_identifier

from kompass.monitor.client import MonitorClient
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.node import PlainNode
from kompass_console.link.battery import Battery
from kompass_console.link.component_topics import ComponentTopics
from kompass_console.link.components import Components
from kompass_console.link.drive import DriveLink
from kompass_console.link.goals.goals import Goals, pose_message
from kompass_console.link.graph import convert
from kompass_console.link.graph.discovery import NODE_NAME
from kompass_console.link.graph.services import ServicePool
from kompass_console.link.initial_pose import InitialPose
from kompass_console.link.log_ring import LogRing
from kompass_console.link.missions import MissionsWatch
from kompass_console.link.on_demand.on_demand import OnDemand
from kompass_console.link.places import PlacesWatch
from kompass_console.link.processes import Processes
from kompass_console.link.rosout import PERIOD, Rosout
from kompass_console.link.rules.backtests import Backtests
from kompass_console.link.rules.monitor import MonitorLink
from kompass_console.link.rules.topic_watch import TopicWatch
from kompass_console.link.rules.watch import RulesWatch
from kompass_console.link.streams import Streams
from kompass_console.link.timeline import Notes, TimelineWatch
from kompass_console.link.wheel import WheelLink
from kompass_console.link.zones import ZonesWatch
from kompass_console.schema.plain import plain
from kompass_console.schema.world import WorldModel
from kompass_console.settings import ConsoleSettings

_WHO_LOOK = (NODE_NAME, "rules_cli_")
CHECK_TIMEOUT = 2.0  # s
CANCEL_TIMEOUT = 2.0  # s

_LOOK_AROUND = 0.25  # s between two looks at the graph
_TICK = 0.1  # s

_logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class CheckAnswer:
    """What the planner says about a goal; `reason` is CheckGoal's number, `preview` (N, 2) m."""

    reachable: bool
    reason: int
    message: str
    nearest: tuple[float, float] | None
    preview: npt.NDArray[np.float64]
    length: float
    duration: float


class RosLink:
    """One rclpy context, node and thread.

    Parameters
    ----------
    changed
        Called on any thread when the goal, the drive manager's state or a component's status has
        changed.
    rules_said
        Called when the monitor has said something of the rules.
    """

    def __init__(
        self,
        settings: ConsoleSettings,
        world: WorldModel,
        changed: Callable[[], None],
        rules_said: Callable[[], None],
    ) -> None:
        self._ending = threading.Event()
        self._context = rclpy.Context()
        rclpy.init(
            args=[],
            context=self._context,
            domain_id=settings.domain_id,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self.domain_id = int(self._context.get_domain_id())
        self.middleware = str(get_rmw_implementation_identifier())
        # The process id keeps two consoles on one robot apart.
        self._node = self._make_node(f"{NODE_NAME}_{os.getpid()}")
        self.streams = Streams(self._node, world, settings.topics)
        self.battery = Battery(self._node, changed)
        self.processes = Processes(self._node, changed)
        self.components = Components(self._node, changed)
        self.component_topics = ComponentTopics(self._node)
        self.drive = DriveLink(self._node, changed)
        self.wheel = WheelLink(self._node)
        self.initial_pose = InitialPose(self._node)
        self.rules = RulesWatch(changed, rules_said)
        self.places = PlacesWatch(world, changed)
        self.zones = ZonesWatch(self._node, world, self.places, changed)
        self.missions = MissionsWatch(self.places, changed)
        self.goals = Goals(self._node, world, changed, self.missions.sender)
        self.timeline = TimelineWatch(changed)
        self.monitor = MonitorLink(self._node, self._follow)
        self.notes = Notes(self.monitor)
        self.backtests = Backtests(self.monitor)
        self.topics = TopicWatch(self._node, self._run)
        self._log_node = self._make_node(f"{NODE_NAME}_log_{os.getpid()}")
        self.log = LogRing()
        self.rosout = Rosout(self._log_node, self.log)
        self._on_demand_node = self._make_node(f"{NODE_NAME}_on_demand_{os.getpid()}")
        self.on_demand = OnDemand(self._on_demand_node, world)
        self._checks = ServicePool(self._node, CheckGoal, "kompass_interfaces/srv/CheckGoal")
        self._node.create_timer(_LOOK_AROUND, self._look_around)
        self._node.create_timer(_TICK, self.goals.tick)
        self._node.create_timer(PERIOD, self.rosout.look)
        self._executor = TaskExecutor(self._context)
        self._executor.add_node(self._node)
        self._look_around()
        self._thread = threading.Thread(target=self._spin, name="ros", daemon=True)
        self._thread.start()

    @property
    def planner_checks(self) -> bool:
        """Whether some planner answers goal checks."""
        return bool(self._checks.names)

    @property
    def kompass_runs(self) -> bool:
        """Whether components of ours are there, whose planner has to be asked before a goal is
        sent. Not so where the console is attached to another navigation stack."""
        return bool(self.components.names) or self.goals.action_there

    @property
    def meets_somebody(self) -> bool:
        """Whether anybody is on the graph but consoles and command lines, who look themselves."""
        return any(not name.startswith(_WHO_LOOK) for name in self._node.get_node_names())

    async def check_goal(self, x: float, y: float, yaw: float | None) -> CheckAnswer:
        """Ask the planner about a goal (m, rad, map frame).

        Raises
        ------
        NoAnswer
            When no planner answers within `CHECK_TIMEOUT`.
        """
        request = CheckGoal.Request(
            goal=pose_message(x, y, yaw or 0.0), use_heading=yaw is not None
        )
        answer = await self._checks.call(request, CHECK_TIMEOUT)
        nearest = (answer.nearest.x, answer.nearest.y) if answer.has_nearest else None
        return CheckAnswer(
            reachable=bool(answer.reachable),
            reason=int(answer.reason),
            message=plain(answer.message),
            nearest=nearest,
            preview=convert.path(answer.preview),
            length=float(answer.length),
            duration=float(answer.duration),
        )

    def stop(self) -> None:
        """Leave the graph and end the thread."""
        self._ending.set()
        self._executor.wake()
        self._thread.join(2.0)
        self._executor.shutdown(0.0)
        self.on_demand.stop()
        self._on_demand_node.destroy_node()
        self._log_node.destroy_node()
        self._node.destroy_node()
        rclpy.shutdown(context=self._context, uninstall_handlers=False)

    def _make_node(self, name: str) -> PlainNode:
        return PlainNode(
            name,
            context=self._context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )

    def _spin(self) -> None:
        while not self._ending.is_set() and self._context.ok():
            try:
                self._executor.spin_once(timeout_sec=0.5)
            except Exception:
                # One message that cannot be handled must not make the console deaf.
                _logger.exception("a ROS callback failed")

    def _run(self, work: Callable[[], None]) -> None:
        """Do something on the link's thread. Any thread."""
        self._executor.create_task(work)

    def _look_around(self) -> None:
        topics = dict(self._node.get_topic_names_and_types())
        published = {n: t for n, t in topics.items() if self._node.count_publishers(n) > 0}
        # A client makes a service's name appear as well, this console's own for one.
        named = dict(self._node.get_service_names_and_types())
        services = {n: t for n, t in named.items() if self._node.count_services(n) > 0}
        self.streams.refresh(published)
        self.battery.refresh(published)
        self.components.refresh(published, self.processes.of)
        self.component_topics.refresh(self.components.names)
        self.drive.refresh(published, services)
        self.wheel.refresh(services)
        self.goals.refresh(published, services)
        self._checks.refresh(services)
        self.processes.refresh(published)
        self.monitor.refresh(services)
        self.backtests.refresh()
        self.topics.refresh(published)
        self.on_demand.extras.refresh(published, self.streams.topics)
        self.on_demand.cameras.refresh(published)
        self.places.refresh()
        self.zones.refresh()

    def _follow(self, monitor: MonitorClient) -> None:
        self.rules.follow(monitor)
        self.places.follow(monitor)
        self.missions.follow(monitor)
        self.zones.follow(monitor)
        self.timeline.follow(monitor)
