"""The person of a drive: sends goals, presses STOP, and has things break."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PointStamped, PoseStamped
from kompass_interfaces.action import PlanPath
from kompass_interfaces.srv import ReleaseStop, SetFault, StopRobot
from nav_msgs.msg import Odometry

from kompass.access.signer import Signer
from kompass.bus.node import ActionClient, Node, Publisher
from kompass.components.base.component import Component
from kompass.components.base.convert import quaternion_msg
from kompass.components.planner.goal_progress import FREE_HEADING
from kompass.drills.facts import GOAL_OUTCOMES, FaultBegan, FaultFailed, GoalEnded, GoalSent
from kompass.drills.runner.goal_watch import GoalWatch
from kompass.drills.runner.observer import Observer
from kompass.drills.scenario import Goal, OperatorAct, Scenario, ScheduledFault
from kompass.simulation.faults.fault_names import AT_ONCE
from kompass.simulation.faults.fault_service import SERVICE as SET_FAULT
from kompass.store.robot_key import known_keys

PERIOD = 0.05  # s between two looks at what is to be done
PATIENCE = 5.0  # s for which a planner that does not take goals is waited for
MATCHED = 1.0  # s in which all who listen to a topic have found a publisher
FOUND = 0.5  # s after which everybody has found a planner that was started again
TOLERANCE = 0.1  # m, where a goal says nothing of it


# What planners take goals as.
_GOALS: dict[str, type[Any]] = {
    "geometry_msgs/msg/PointStamped": PointStamped,
    "geometry_msgs/msg/PoseStamped": PoseStamped,
    "nav_msgs/msg/Odometry": Odometry,
}


class NoPlanner(ValueError):
    """Nobody in the stack takes goals."""


class Operator:
    """Carries a scenario out.

    Parameters
    ----------
    node
        Asks; in a process of its own.
    scenario
        What is to happen.
    components
        Of the stack.
    observer
        Where goals and their ends are written down.

    Raises
    ------
    NoPlanner
        When nobody takes goals.
    """

    def __init__(
        self, node: Node, scenario: Scenario, components: list[Component], observer: Observer
    ) -> None:
        self._node, self._observer = node, observer
        self._goals = list(scenario.goals)
        self._acts = sorted(scenario.operators, key=lambda act: act.at)
        self._faults = sorted(scenario.faults, key=lambda fault: fault.at)
        self._sent = 0
        self._near = (0.0, 0.0, 0.0)  # of the goal under way: x, y, tolerance [m]
        self._under_way: int | None = None
        self._unanswered: set[int] = set()  # those that were taken over are answered later
        self._planner_from = 0.0  # monotonic time from which on it takes goals
        self._asked_since: float | None = None
        self._way = _way(components)
        self._client: ActionClient | None = None
        self._ends: GoalWatch | None = None
        if self._way.action:
            self._client = node.create_action_client(PlanPath, f"/{self._way.action}")
            if any(goal.topic for goal in self._goals):
                self._ends = GoalWatch(node, f"/{self._way.action}")
        self._publishers: dict[str, tuple[type[Any], Publisher]] = {}
        self._heard_from: dict[str, float] = {}  # monotonic time since when one is made ready
        self._fault_client = node.create_client(SetFault, SET_FAULT)
        self._switched: dict[Any, ScheduledFault] = {}  # by the answers that are on their way
        gates = [one.node_name for one in components if one.stops_robot]
        self._stops = [node.create_client(StopRobot, f"{name}/stop") for name in gates]
        self._releases = [
            (
                f"/{name}/release_stop",
                node.create_client(ReleaseStop, f"{name}/release_stop"),
                Signer(node, f"/{name}", known_keys()),
            )
            for name in gates
        ]
        node.create_timer(PERIOD, self._look)

    @property
    def is_done(self) -> bool:
        """Whether all goals have ended, and all else was done."""
        return not (self._goals or self._acts or self._faults) and self._under_way is None

    def _look(self) -> None:
        if not self._observer.has_begun:
            return
        now = self._observer.now
        while self._faults and self._faults[0].at <= now:
            self._break(self._faults.pop(0))
        while self._acts and self._acts[0].at <= now:
            self.act(self._acts.pop(0))
        if self._goals:
            goal = self._goals[0]
            due = self._under_way is None if goal.at is None else goal.at <= now
            if due:
                self._try(goal, now)
        self._look_at_arrival()

    # -- goals --------------------------------------------------------------------------------

    def _try(self, goal: Goal, now: float) -> None:
        """Send a goal as soon as somebody takes it; not for ever."""
        topic = goal.topic or self._way.topic
        send = self._taker(goal, topic)
        if send is not None:
            self._goals.pop(0)
            self._asked_since = None
            send()
        elif self._asked_since is None:
            self._asked_since = now
        elif now - self._asked_since > PATIENCE:
            self._goals.pop(0)
            self._asked_since = None
            number = self._begin(goal)
            nobody = f"nobody listens to {topic}" if topic else "the planner is not there"
            self._end(number, "refused", f"nobody takes goals: {nobody}")

    def _taker(self, goal: Goal, topic: str) -> Callable[[], None] | None:
        """What sends a goal; None as long as nobody takes it."""
        if self._node.clock.monotonic() < self._planner_from and not goal.topic:
            return None
        if topic:
            publisher = self._publisher(topic)
            if publisher is not None and self._is_heard(topic, *publisher):
                return partial(self._publish, goal, *publisher)
        elif self._client is not None and self._client.server_is_ready():
            return partial(self._send, goal)
        return None

    def _is_heard(self, topic: str, kind: type[Any], publisher: Publisher) -> bool:
        """Whether all who listen have found a publisher: to the others its word is lost.

        Who listens with a quality of service that does not fit finds it never, and is not waited
        for long.
        """
        found = publisher.get_subscription_count()
        infos = self._node.get_subscriptions_info_by_topic(topic)
        listening = sum(_GOALS.get(info.topic_type) is kind for info in infos)
        waited = self._node.clock.monotonic() - self._heard_from.setdefault(
            topic, self._node.clock.monotonic()
        )
        return found > 0 and (found >= listening or waited > MATCHED)

    def _publisher(self, topic: str) -> tuple[type[Any], Publisher] | None:
        """A publisher of the type that is listened to; None as long as nobody listens."""
        found = self._publishers.get(topic)
        if found is None:
            listening = self._node.get_subscriptions_info_by_topic(topic)
            kinds = [kind for info in listening if (kind := _GOALS.get(info.topic_type))]
            if not kinds:
                return None
            found = kinds[0], self._node.create_publisher(kinds[0], topic, 10)
            self._publishers[topic] = found
        return found

    def _publish(self, goal: Goal, kind: type[Any], publisher: Publisher) -> None:
        number = self._begin(goal)
        message = kind()
        message.header.frame_id = "map"
        message.header.stamp = self._node.get_clock().now().to_msg()
        if kind is PointStamped:
            message.point.x, message.point.y = goal.x, goal.y
        else:
            pose = message.pose.pose if kind is Odometry else message.pose
            pose.position.x, pose.position.y = goal.x, goal.y
            pose.orientation = quaternion_msg(goal.yaw or 0.0)
        self._near = (goal.x, goal.y, goal.tolerance or TOLERANCE)
        if self._ends is not None:
            self._ends.follow_next(partial(self._ended, number))
        publisher.publish(message)

    def _look_at_arrival(self) -> None:
        """A planner without an action tells nobody that the robot is there: one sees it."""
        if self._under_way is None or self._client is not None or self._observer.place is None:
            return
        x, y, tolerance = self._near
        here = self._observer.place
        if math.hypot(here[0] - x, here[1] - y) <= tolerance:
            self._end(self._under_way, "arrived", "")

    def _begin(self, goal: Goal) -> int:
        number = self._sent
        self._sent += 1
        tolerance = goal.tolerance or TOLERANCE
        self._observer.note(GoalSent, number, goal.x, goal.y, tolerance)
        self._under_way = number
        self._unanswered.add(number)
        return number

    def _end(self, number: int, outcome: str, message: str) -> None:
        self._unanswered.discard(number)
        self._observer.note(GoalEnded, number, outcome, message)
        if self._under_way == number:
            self._under_way = None

    def _send(self, goal: Goal) -> None:
        number = self._begin(goal)
        request = PlanPath.Goal()
        request.goal.position.x, request.goal.position.y = goal.x, goal.y
        request.goal.orientation = quaternion_msg(goal.yaw or 0.0)
        free = goal.yaw is None
        request.end_tolerance.lateral_distance_error = goal.tolerance or 0.0
        request.end_tolerance.orientation_error = (
            FREE_HEADING if free else goal.heading_tolerance or 0.0
        )
        self._node.executor.create_task(self._follow, number, request)

    async def _follow(self, number: int, request: Any) -> None:
        assert self._client is not None
        handle = await self._client.send_goal_async(request)
        if not handle.accepted:
            self._end(number, "refused", "the planner did not accept the goal")
            return
        self._ended(number, await handle.get_result_async())

    def _ended(self, number: int, ended: Any) -> None:
        result = ended.result
        # An action that was aborted before anybody filled its result in claims the first outcome.
        unsaid = ended.status != GoalStatus.STATUS_SUCCEEDED and not result.outcome
        outcome = "error" if unsaid else GOAL_OUTCOMES[result.outcome]
        self._end(number, outcome, result.message)

    def planner_changed(self, state: str) -> None:
        """Take what the supervisor tells of the planner's process.

        Of one that has died nobody will ever say how its goals ended, neither the one under way nor
        those that this one was to take over. Until it is back and found no other is sent: DDS
        believes in the dead for a while.
        """
        if state == "dead":
            self._planner_from = math.inf
        elif state == "active" and self._planner_from == math.inf:
            self._planner_from = self._node.clock.monotonic() + FOUND
        if state == "dead":
            for number in sorted(self._unanswered):
                self._end(number, "error", "the planner's process died")

    # -- all else -----------------------------------------------------------------------------

    def _break(self, fault: ScheduledFault) -> None:
        request = SetFault.Request(fault=fault.name, on=True, duration=fault.duration)
        asked = self._fault_client.call_async(request)
        self._switched[asked] = fault
        asked.add_done_callback(partial(self._on_switched, fault, self._observer.now))

    def _on_switched(self, fault: ScheduledFault, at: float, answered: Any) -> None:
        del self._switched[answered]
        answer = answered.result()
        if not answer.success:
            self._observer.note(FaultFailed, fault.name, answer.message, at=at)
        # What goes on for a while is told by the simulator; what is over at once, by nobody.
        elif fault.name.startswith(AT_ONCE):
            self._observer.note(FaultBegan, fault.name, at=at)

    def finish(self) -> None:
        """The drive is over: what was not answered by now is not."""
        for fault in self._switched.values():
            self._observer.note(FaultFailed, fault.name, "the simulator did not answer")

    def act(self, act: OperatorAct) -> None:
        """Press STOP or release it, now."""
        if act.does == "stop":
            for client in self._stops:
                client.call_async(StopRobot.Request(operator_name=act.by, reason=act.reason))
            return
        self._observer.releasing(act.by)
        for service, client, signer in self._releases:
            request = signer.sign(service, ReleaseStop.Request(operator_name=act.by))
            asked = client.call_async(request)
            asked.add_done_callback(self._on_release)

    def _on_release(self, answered: Any) -> None:
        self._observer.release_answered(released=answered.result().success)


@dataclass(frozen=True)
class _Way:
    """How a stack is given goals.

    Attributes
    ----------
    action, topic
        Of the two one is empty.
    node
        Who takes them.
    """

    node: str
    action: str = ""
    topic: str = ""


def _way(components: list[Component]) -> _Way:
    for component in components:
        if component.main_action_type is PlanPath and component.run_type.value == "ActionServer":
            return _Way(component.node_name, action=component.main_action_name)
    for component in components:
        if component.main_action_type is PlanPath and "goal_point" in component.inputs_keys:
            given = component.get_in_topic("goal_point")
            for topic in given if isinstance(given, list) else [given]:
                if topic is not None:
                    return _Way(component.node_name, topic=f"/{topic.name.lstrip('/')}")
    raise NoPlanner(
        "no component of the recipe takes goals; a drill needs a Planner, with run_type = "
        '"ActionServer" or with a goal_point among its inputs'
    )


def planner_node(components: list[Component]) -> str:
    """Name of the node that takes goals.

    Raises
    ------
    NoPlanner
        When nobody does.
    """
    return _way(components).node
