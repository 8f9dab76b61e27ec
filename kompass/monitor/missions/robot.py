"""What a mission has the robot do, and how that ends: drives, actions, STOP."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Coroutine
from functools import partial
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from kompass_interfaces.action import PlanPath
from kompass_interfaces.msg import DriveState
from nav_msgs.msg import OccupancyGrid
from rclpy.qos import qos_profile_action_status_default
from rclpy.task import Future

from kompass.bus.node import ActionClient, Executor, Node
from kompass.components.base.convert import grid_of, quaternion_msg
from kompass.components.planner.goal_progress import FREE_HEADING
from kompass.missions.mission import Act, Halt, Mission
from kompass.missions.run import DriveEnd, GoTo, Perform
from kompass.monitor.execution.action_runner import ActionRunner
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.map_topic import map_topic
from kompass.monitor.missions.actions import firing_of
from kompass.monitor.worker_thread import WorkerThread
from kompass.places.map_identity import identify
from kompass.places.place import MapIdentity, Place
from kompass.rclpy_ext.awaitables import Awaitables
from kompass.rclpy_ext.executor import Cancelled, Task
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.timers import Timers
from kompass.rclpy_ext.topic import LATCHED
from kompass.supervisor.news import ProcessNews

SEARCH = 3.0  # s in which a planner, a map or a drive manager must show up
TRIES = 3  # to give the planner a goal
_DELETED = "the place has been deleted; take it out of the mission"
_NOTHING = 0  # the ticket of nothing; those of runs count from 1
_TYPE = "kompass_interfaces/action/PlanPath"
_REMEMBERED = 64  # ids of goals
_UNDER_WAY = (GoalStatus.STATUS_ACCEPTED, GoalStatus.STATUS_EXECUTING)
_OUTCOMES: dict[int, DriveEnd] = {
    PlanPath.Result.OUTCOME_ARRIVED: "arrived",
    PlanPath.Result.OUTCOME_STOPPED: "interrupted",
    PlanPath.Result.OUTCOME_PREEMPTED: "interrupted",
    PlanPath.Result.OUTCOME_CANCELED: "interrupted",
}


class MissionRobot:
    """Drives, acts and listens for one mission at a time. All on the executor's thread.

    Parameters
    ----------
    node, executor, timers, main
        Where it runs.
    runner
        Carries actions out.
    catalog
        Which component serves which action.
    gate
        Node name of the drive manager.
    worker
        Tells which map it is.
    find_place
        A place by its id.
    drive_ended, task_ended
        Told of ends, with the ticket of the beginning.
    interrupted
        Told when somebody presses STOP, takes the wheel, or sends the robot elsewhere.
    """

    def __init__(
        self,
        node: Node,
        executor: Executor,
        timers: Timers,
        main: MainThread,
        runner: ActionRunner,
        catalog: RecipeCatalog,
        gate: str,
        worker: WorkerThread,
        *,
        find_place: Callable[[int], Place | None],
        drive_ended: Callable[[int, DriveEnd, str], None],
        task_ended: Callable[[int, bool, str], None],
        interrupted: Callable[[str], None],
    ) -> None:
        self._node, self._main, self._runner, self._gate = node, main, runner, gate
        self._awaitables = Awaitables(timers, executor)
        self._worker, self._find_place = worker, find_place
        self._drive_ended, self._task_ended = drive_ended, task_ended
        self._interrupted = interrupted
        self._catalog = catalog
        self._servers = {
            action: name for name, spec in catalog.components().items() for action in spec.serves
        }
        self._clients: dict[str, ActionClient] = {}
        self._task: Task | None = None
        self._looking: Task | None = None  # whether it may begin
        self._ticket = _NOTHING
        self._driver = ""  # node name of who has the goal
        self._place: int | None = None  # to which it drives
        self._listening: Any = None
        self._drive: DriveState | None = None
        # By action: the goals that others have the robot pursue.
        self._others: dict[str, frozenset[bytes]] = {}
        self._own = deque[bytes](maxlen=_REMEMBERED)  # ids of the goals of missions
        self._sending = False  # a goal whose id is not yet known
        for action in self._servers:
            node.create_subscription(
                GoalStatusArray,
                f"/{action}/_action/status",
                partial(self._on_goals, action),
                qos_profile_action_status_default,
            )

    @property
    def pursues_other_goals(self) -> bool:
        """Whether the robot is on its way to a goal that no mission gave it."""
        return any(self._others.values())

    def close(self) -> None:
        """Nothing is driven or done any more."""
        self.cease()
        if self._looking is not None:
            self._looking.cancel()
        self.rest()
        for client in self._clients.values():
            client.destroy()

    def listen(self) -> None:
        """Hear of STOP and of who drives by hand, from now on."""
        if self._listening is None:
            self._listening = self._node.create_subscription(
                DriveState, "drive_state", self._on_drive_state, LATCHED.to_ros()
            )

    def rest(self) -> None:
        """Hear nothing more: no mission is under way."""
        if self._listening is not None:
            self._node.destroy_subscription(self._listening)
            self._listening = self._drive = None

    def unless_interrupted(self, asked: int, go_on: Callable[[], None]) -> None:
        """Go on with what a person asked for, unless STOP was pressed or the wheel taken since.

        Parameters
        ----------
        asked
            The count of that (DriveState) when the person asked.
        """

        async def look() -> None:
            # What was heard may be from before this process was held: ask for the newest.
            heard: list[DriveState] = []
            listening = self._node.create_subscription(
                DriveState, "drive_state", heard.append, LATCHED.to_ros()
            )
            try:
                await self._awaitables.until(lambda: bool(heard), SEARCH, "")
            except TimeoutError:
                pass  # a drive is refused for that, with its own words
            finally:
                self._node.destroy_subscription(listening)
            if heard and heard[-1].interruptions != asked:
                self._interrupted("STOP was pressed, or the wheel taken, after this was asked for")
            else:
                go_on()

        def over(error: BaseException | None) -> None:
            if error is not None and not isinstance(error, Cancelled):
                self._interrupted(f"it is not known whether STOP was pressed: {error!r}")

        self._looking = Task(look(), over)

    async def _hindrance(self) -> str:
        """Why the robot would not set off now; empty when it would."""
        self.listen()
        try:
            await self._awaitables.until(lambda: self._drive is not None, SEARCH, "")
        except TimeoutError:
            return "the drive manager says nothing; look at its health"
        return _held(self._drive)

    def go(self, effect: GoTo, of_map: MapIdentity) -> None:
        """Drive to a place of that map."""
        self._begin(effect.ticket, self._go(effect.place, of_map), self._drive_ended, "failed")

    def perform(self, effect: Perform, mission: Mission) -> None:
        """Carry an action out, or press STOP."""
        run = self._perform(effect.task, mission)
        self._begin(effect.ticket, run, self._task_ended, False)

    def cease(self) -> None:
        """End what is under way; its end is told to nobody."""
        self._ticket, self._driver, self._place = _NOTHING, "", None
        if self._task is not None:
            self._task.cancel()

    def process_changed(self, news: ProcessNews) -> None:
        """A process that had the goal may have died with it: nobody will tell its end."""
        if news.is_lost:
            for action in self._others:
                if self._servers[action] in news.nodes:
                    self._others[action] = frozenset()
        if self._driver and news.is_lost and self._driver in news.nodes:
            ticket, driver = self._ticket, self._driver
            self.cease()
            reason = f"{driver}, which had the goal, was lost: {news.reason or news.state}"
            self._drive_ended(ticket, "interrupted", reason)

    def places_changed(self) -> None:
        """Where it drives to may be no place any more."""
        if self._place is not None and self._find_place(self._place) is None:
            ticket = self._ticket
            self.cease()
            self._drive_ended(ticket, "failed", _DELETED)

    # -- pieces -------------------------------------------------------------------------------

    def _begin(
        self,
        ticket: int,
        run: Coroutine[Future, None, tuple[Any, str]],
        tell: Callable[[int, Any, str], None],
        otherwise: Any,
    ) -> None:
        self.cease()
        self._ticket, self._driver = ticket, ""
        ended: list[tuple[Any, str]] = []

        async def carry_out() -> None:
            ended.append(await run)

        def over(error: BaseException | None) -> None:
            if self._ticket == ticket:
                self._ticket, self._driver, self._place = _NOTHING, "", None
                what, why = ended[0] if ended else (otherwise, str(error) or repr(error))
                # What follows begins on a stack of its own.
                self._main.post(lambda: tell(ticket, what, why))

        self._task = Task(carry_out(), over)

    async def _go(self, place_id: int, of_map: MapIdentity) -> tuple[DriveEnd, str]:
        place = self._find_place(place_id)
        if place is None:
            return "failed", _DELETED
        self._place = place_id
        why = await self._elsewhere(place, of_map) or await self._hindrance()
        if why:
            return "interrupted", why
        server = self._server()
        if server is None:
            return (
                "interrupted",
                "nobody takes goals: the recipe's planner must run as ActionServer",
            )
        name, self._driver = server
        client = self._clients.get(name)
        if client is None:
            client = self._clients[name] = self._node.create_action_client(PlanPath, name)
        for _ in range(TRIES):
            try:
                return await self._goal(client, _goal_of(place))
            except TimeoutError:
                # What is asked before a planner that was just started is found goes to the dead
                # one, whom DDS remembers for a while. One that heard twice takes the newer goal.
                continue
        return "interrupted", f"no answer from {self._driver or name}; look at its health"

    async def _goal(self, client: ActionClient, goal: PlanPath.Goal) -> tuple[DriveEnd, str]:
        await self._awaitables.until(client.server_is_ready, SEARCH, "")
        self._sending = True
        sent = client.send_goal_async(goal)
        sent.add_done_callback(self._on_sent)
        try:
            handle = await self._awaitables.result(sent, SEARCH, "")
            if not handle.accepted:
                return "interrupted", "the planner refused the goal; look at its health"
            ended = await handle.get_result_async()
        except BaseException:
            # Nobody follows it any more, so it must not go on; it may not have been taken yet.
            sent.add_done_callback(_cancel)
            self._sending = False
            raise
        return _OUTCOMES.get(ended.result.outcome, "failed"), ended.result.message

    async def _perform(self, task: Act | Halt, mission: Mission) -> tuple[bool, str]:
        at = self._node.clock.monotonic()
        firing = firing_of(mission, mission.role, task, self._gate, at)
        ok, error = await self._runner.run(firing, lambda outcome: None)
        # Of several actions of a rule the next would go on, and so does the mission.
        return ok or firing.actions[0].on_error == "continue", error

    def _server(self) -> tuple[str, str] | None:
        """Name of the action that takes goals, and of the component that serves it, if any does."""
        names = sorted(
            name.removeprefix("/")
            for name, types in self._node.get_action_names_and_types()
            if _TYPE in types
        )
        own = [name for name in names if name in self._servers]
        if not names:
            return None
        name = (own or names)[0]
        return name, self._servers.get(name, "")

    async def _elsewhere(self, place: Place, of_map: MapIdentity) -> str:
        """Why a place is none of the map that the robot has; empty when it is."""
        if place.map.id != of_map.id:
            return f"{place.name!r} is a place of another map by now; look at the mission"
        topic = map_topic(self._node, self._catalog)
        if topic is None:
            return "the robot has no map; load the one of the mission"
        heard: list[OccupancyGrid] = []
        listening = self._node.create_subscription(
            OccupancyGrid, f"/{topic}", heard.append, LATCHED.to_ros()
        )
        try:
            await self._awaitables.until(lambda: bool(heard), SEARCH, "")
        except TimeoutError:
            return f"no map came on /{topic}; load the one of the mission"
        finally:
            self._node.destroy_subscription(listening)
        here = await self._identity(heard[-1])
        if here is None or here.id != of_map.id:
            return f"the robot has another map now than the one of the mission ({of_map.label})"
        return ""

    async def _identity(self, message: OccupancyGrid) -> MapIdentity | None:
        made = self._awaitables.future()

        def look() -> None:
            try:
                made.set_result(identify(grid_of(message)))
            except ValueError:  # no map at all
                made.set_result(None)

        self._worker.post(look)
        found: MapIdentity | None = await made
        return found

    def _on_sent(self, sent: Future) -> None:
        self._sending = False
        if sent.exception() is None:
            own = bytes(sent.result().goal_id.uuid)
            self._own.append(own)
            self._others = {action: ids - {own} for action, ids in self._others.items()}

    def _on_goals(self, action: str, goals: GoalStatusArray) -> None:
        under_way = frozenset(
            bytes(goal.goal_info.goal_id.uuid)
            for goal in goals.status_list
            if goal.status in _UNDER_WAY
        )
        before = self._others.get(action, frozenset())
        self._others[action] = others = under_way.difference(self._own)
        # While it drives for the mission the end of that drive is told, and what an action of the
        # mission sets off is no surprise. A goal of ours may be told of before its id is known.
        if others - before and self._ticket == _NOTHING and not self._sending:
            self._interrupted("somebody sent the robot elsewhere")

    def _on_drive_state(self, state: DriveState) -> None:
        before, self._drive = self._drive, state
        reason = _held(state)
        if not reason and before is not None and before.interruptions != state.interruptions:
            reason = "somebody pressed STOP, or took the wheel, for a moment"
        if reason:
            self._interrupted(reason)


def _held(state: DriveState | None) -> str:
    """Who holds the robot; empty when nobody does."""
    if state is not None and state.stopped:
        return f"{state.stopped_by or 'somebody'} pressed STOP"
    if state is not None and state.driven_by:
        return f"{state.driven_by} drives by hand"
    return ""


def _goal_of(place: Place) -> PlanPath.Goal:
    pose, goal = place.pose, PlanPath.Goal()
    goal.goal.position.x, goal.goal.position.y = pose.x, pose.y
    goal.goal.orientation = quaternion_msg(pose.yaw or 0.0)
    if pose.yaw is None:
        goal.end_tolerance.orientation_error = FREE_HEADING
    return goal


def _cancel(sent: Future) -> None:
    if sent.exception() is None and sent.result().accepted:
        sent.result().cancel_goal_async()
