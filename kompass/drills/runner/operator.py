"""The person of a drive: sends goals, presses STOP, and has things break."""

from __future__ import annotations

from typing import Any

from action_msgs.msg import GoalStatus
from kompass_interfaces.action import PlanPath
from kompass_interfaces.srv import ReleaseStop, SetFault, StopRobot

from kompass.access.signer import Signer
from kompass.bus.node import Node
from kompass.components.base.component import Component
from kompass.components.base.convert import quaternion_msg
from kompass.components.planner.mission import FREE_HEADING
from kompass.drills.facts import GOAL_OUTCOMES, FaultBegan, GoalEnded, GoalSent
from kompass.drills.runner.observer import Observer
from kompass.drills.scenario import Goal, OperatorAct, Scenario, ScheduledFault
from kompass.simulation.faults.fault_names import AT_ONCE
from kompass.simulation.faults.fault_service import SERVICE as SET_FAULT
from kompass.store.robot_key import known_keys

PERIOD = 0.05  # s between two looks at what is to be done
PATIENCE = 5.0  # s for which a planner that does not take goals is waited for
TOLERANCE = 0.1  # m, where a goal says nothing of it


class NoPlanner(ValueError):
    """Nobody in the stack takes goals as an action."""


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
        self._under_way: int | None = None
        self._asked_since: float | None = None
        self._client = node.create_action_client(PlanPath, f"/{_planner(components)}")
        self._fault_client = node.create_client(SetFault, SET_FAULT)
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
            self._act(self._acts.pop(0))
        if self._goals:
            goal = self._goals[0]
            due = self._under_way is None if goal.at is None else goal.at <= now
            if due:
                self._try(goal, now)

    # -- goals --------------------------------------------------------------------------------

    def _try(self, goal: Goal, now: float) -> None:
        """Send a goal as soon as somebody takes it; not for ever."""
        if self._client.server_is_ready():
            self._goals.pop(0)
            self._asked_since = None
            self._send(goal)
        elif self._asked_since is None:
            self._asked_since = now
        elif now - self._asked_since > PATIENCE:
            self._goals.pop(0)
            self._asked_since = None
            number = self._begin(goal)
            self._end(number, "refused", "nobody takes goals: the planner is not there")

    def _begin(self, goal: Goal) -> int:
        number = self._sent
        self._sent += 1
        tolerance = goal.tolerance or TOLERANCE
        self._observer.note(GoalSent, number, goal.x, goal.y, tolerance)
        self._under_way = number
        return number

    def _end(self, number: int, outcome: str, message: str) -> None:
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
        handle = await self._client.send_goal_async(request)
        if not handle.accepted:
            self._end(number, "refused", "the planner did not accept the goal")
            return
        ended = await handle.get_result_async()
        result = ended.result
        # An action that was aborted before anybody filled its result in claims the first outcome.
        unsaid = ended.status != GoalStatus.STATUS_SUCCEEDED and not result.outcome
        outcome = "error" if unsaid else GOAL_OUTCOMES[result.outcome]
        self._end(number, outcome, result.message)

    def planner_died(self) -> None:
        """Nobody will ever say how the goal under way ended."""
        if self._under_way is not None:
            self._end(self._under_way, "error", "the planner's process died")

    # -- all else -----------------------------------------------------------------------------

    def _break(self, fault: ScheduledFault) -> None:
        request = SetFault.Request(fault=fault.name, on=True, duration=fault.duration)
        # What goes on for a while is told by the simulator; what is over at once, by nobody.
        if fault.name.startswith(AT_ONCE):
            self._observer.note(FaultBegan, fault.name)
        self._fault_client.call_async(request)

    def _act(self, act: OperatorAct) -> None:
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
        if not answered.result().success:
            self._observer.releasing("")


def _planner(components: list[Component]) -> str:
    """Name of the action that takes goals."""
    for component in components:
        if component.main_action_type is PlanPath and component.run_type.value == "ActionServer":
            return component.main_action_name
    raise NoPlanner(
        "no component of the recipe takes goals as an action; a drill needs a Planner with "
        'run_type = "ActionServer"'
    )


def planner_node(components: list[Component]) -> str:
    """Name of the node that takes goals."""
    action = _planner(components)
    return next(
        one.node_name
        for one in components
        if one.main_action_type is PlanPath and one.main_action_name == action
    )
