"""Carry out the actions of a firing: in their order, each with an outcome."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Collection, Mapping
from concurrent.futures import Future
from contextlib import suppress
from typing import Any

from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal as CancelGoalService
from automatika_ros_sugar.srv import (
    ChangeParameter,
    ChangeParameters,
    ConfigureFromFile,
    ExecuteMethod,
    ReplaceTopic,
)
from kompass_interfaces.srv import SignedCall, StopRobot
from lifecycle_msgs.srv import ChangeState
from pydantic import JsonValue
from rclpy.node import NodeNameNonExistentError
from rclpy.serialization import deserialize_message, serialize_message

from kompass.access.signed_services import SIGNED_CALL, unwrap, wrap
from kompass.access.signer import MOST_CALLS, Signer
from kompass.bus.node import ActionClient, Executor, Node
from kompass.channel.channels import Channels
from kompass.components.base.people import People
from kompass.message_types import ros_class
from kompass.monitor.execution.component_channels import ComponentChannels
from kompass.monitor.execution.publishers import Listeners, Publishers
from kompass.monitor.execution.service_refusal import refusal
from kompass.monitor.recipe_call import RecipeCall
from kompass.monitor.reporting.alarms import Alarms
from kompass.monitor.reporting.entries import ActionOutcome
from kompass.printable import printable
from kompass.rclpy_ext.awaitables import Awaitables
from kompass.rclpy_ext.executor import Cancelled
from kompass.rclpy_ext.messages import checked, fill, part_to_plain, to_plain
from kompass.rclpy_ext.timers import Timers
from kompass.recipe.action import METHOD_TIMEOUT
from kompass.recipe.fallbacks import FallbackSequence
from kompass.recipe.parsed import Parsed
from kompass.rulebook.permissions import Permissions, rights_text
from kompass.rules.engine.firing import NO_RUN, Firing
from kompass.rules.schema import actions as kinds
from kompass.rules.schema.arguments import expand, resolve
from kompass.signing.canonical import PROOF
from kompass.store.robot_key import robot_key

MATCH = 0.5  # s for which a message waits for those who listen
LINGER = 0.1  # s for which a publisher that goes again stays, to deliver
INTERRUPTED = "not begun: STOP was pressed, or the wheel taken, after the rule had fired"
# What came first cannot be told from a message.
MISSED = (
    "not begun: STOP was pressed, or the wheel taken, while the monitor was held up; have the rule "
    "fire again if it is wanted"
)
_GO = frozenset({"trigger_main_action_server", "run_test"})  # methods that move it
_GOALS = ("geometry_msgs/msg/PointStamped", "geometry_msgs/msg/PoseStamped")
SEARCH = 2.0  # s in which a service or an action server must show up
LET_IN = 0.001  # s for which a function may keep the engine waiting until it has begun
PARSING = 10.0  # s in which a parser must have made its argument
# What changes a component, in types that have no place for a proof.
_UNSIGNABLE = frozenset(
    {ChangeParameter, ChangeParameters, ConfigureFromFile, ExecuteMethod, ReplaceTopic, ChangeState}
)
LONGEST_ALARM = 400  # characters of a text that is taken from a message
THREADS = 64  # functions of the recipe at a time, in each lane


StartMission = Callable[[str, str, Callable[[str], None]], None]


class Failed(Exception):
    """An action did not do what it should; the message says why.

    ``problem`` says so too, without the name of the action; empty where the message has no name.
    """

    def __init__(self, text: str, problem: str = "") -> None:
        super().__init__(text)
        self.problem = problem


class ActionRunner:
    """Runs on the executor of one node; functions of the recipe run in threads, by lane.

    Parameters
    ----------
    node, executor
        Where coroutines run.
    timers
        On the executor's thread.
    functions
        What the recipe's opaque actions are called.
    alarms
        Where alarms are raised and cleared.
    permissions
        What rules may touch.
    components
        Of the stack, by node name: they take requests for changes from us where we sign them.
    restart_if_stuck
        Has the process of a component started anew if it hangs, and returns whether it does.
    channels
        To components; who has none is asked over ROS.

    Attributes
    ----------
    channels
        To the components.
    publishers
        Of the rules in force.
    start_mission
        Begins a mission: takes its name, who wants it, and what to call, on any thread, with why it
        did not begin (empty when it did). None where nobody keeps missions.
    people
        What people did by STOP and the wheel; they did nothing where nobody tells.
    """

    start_mission: StartMission | None = None

    def __init__(
        self,
        node: Node,
        executor: Executor,
        timers: Timers,
        functions: Mapping[str, Callable[..., Any] | Parsed | FallbackSequence],
        alarms: Alarms,
        permissions: Permissions,
        components: Collection[str],
        restart_if_stuck: Callable[[str], bool],
        channels: Channels | None = None,
    ) -> None:
        self._node, self._clock = node, node.clock
        self.people = People()
        self._alarms = alarms
        self._permissions = permissions
        self.publishers = Publishers(node, permissions, functions)
        self._functions = functions
        self._executor = executor
        self._awaitables = Awaitables(timers, executor)
        self.channels = ComponentChannels(channels, self._awaitables, self._clock)
        self._reached: set[Future[Any]] = set()
        self._restart_if_stuck = restart_if_stuck
        self._clients: dict[tuple[type, str], Any] = {}
        whole = {name: node.resolve_service_name(f"{name}/{SIGNED_CALL}") for name in components}
        self._own = {service.rpartition("/")[0]: name for name, service in whole.items()}
        self._signers: dict[str, Signer] = {}
        self._actions: dict[tuple[type, str], ActionClient] = {}
        # A slow function of one lane never holds up the other.
        self._threads = {lane: node.threads(THREADS, lane) for lane in ("normal", "safety")}

    def close(self) -> None:
        """Begin nothing more, and wait for nothing that is under way."""
        for threads in self._threads.values():
            threads.shutdown(wait=False, cancel_futures=True)
        for reached in list(self._reached):
            reached.set_exception(Failed("the monitor ends"))
        for client in self._actions.values():
            client.destroy()
        for signer in self._signers.values():
            signer.close()

    def reach(self, component: str, method: str, kwargs: Mapping[str, Any]) -> Future[Any]:
        """Call an action of a component where it runs; from any thread.

        Returns
        -------
        concurrent.futures.Future
            Of what the action returns; False when it did not succeed. :class:`Failed` when it was
            refused or has raised.
        """
        made: Future[Any] = Future()

        async def call() -> None:
            try:
                made.set_result(await self._result_of(component, method, kwargs))
            except Exception as problem:  # noqa: BLE001 - raised again where it is awaited
                made.set_exception(problem)
            finally:
                self._reached.discard(made)

        self._reached.add(made)
        self._executor.create_task(call)
        return made

    async def _result_of(self, component: str, method: str, kwargs: Mapping[str, Any]) -> Any:
        given = json.dumps({key: to_plain(value) for key, value in kwargs.items()})
        request = ExecuteMethod.Request(name=method, kwargs_json=given)
        name = f"{component}/execute_method"
        answer = await self._call(ExecuteMethod, name, request, METHOD_TIMEOUT)
        result = json.loads(answer.response_json or "null")
        if answer.success:
            return result
        if isinstance(result, dict) and "problem" in result:
            return False
        raise Failed(answer.error_msg or f"{component}.{method} failed")

    async def run(self, firing: Firing, tell: Callable[[ActionOutcome], None]) -> tuple[bool, str]:
        """Carry out all actions of a firing; return whether all went well, and the first error.

        To be run as a :class:`kompass.rclpy_ext.executor.Task`. When that is cancelled, a goal that
        was sent is cancelled too, and no further action begins; a function of the recipe runs
        to its end, but for an ``async def``, which is cancelled where it awaits.

        Parameters
        ----------
        tell
            Takes the outcome of each action when it has ended.
        """
        # Who has not heard yet counts as one who heard of none: better too careful.
        error, before = "", self.people.interruptions or 0
        for action in firing.actions:
            began = self._clock.monotonic()
            try:
                text = await self._perform(action, firing, before)
                outcome = ActionOutcome(_name(action), True, text, self._clock.monotonic() - began)
            except Exception as problem:  # noqa: BLE001 - becomes the outcome, which is reported
                text = str(problem) or type(problem).__name__
                why = (problem.problem if isinstance(problem, Failed) else "") or text
                took = self._clock.monotonic() - began
                outcome = ActionOutcome(_name(action), False, text, took, why)
                error = error or f"{outcome.action}: {text}"
            tell(outcome)
            if not outcome.ok and action.on_error == "abort":
                break
        return not error, error

    def _moves(self, action: kinds.Action) -> bool:
        """Whether it may set the robot in motion."""
        match action:
            case kinds.SendGoal() | kinds.StartMission():
                return True
            case kinds.Method():
                return action.component in self._permissions.gates or action.method in _GO
            case kinds.Publish():
                return action.type in _GOALS
        return False

    async def _check_uninterrupted(self, before: int) -> None:
        """Set nothing in motion that was asked for before people stopped the robot."""
        up_to_date = lambda: self.people.is_up_to_date(self._clock.monotonic())  # noqa: E731
        # Past a drive manager that tells nothing, nothing moves.
        with suppress(TimeoutError):
            await self._awaitables.until(up_to_date, SEARCH, "what the drive manager tells")
        if (self.people.interruptions or 0) > before:
            raise Failed(INTERRUPTED)
        if self.people.were_missed(self._clock.monotonic()):
            raise Failed(MISSED)

    async def _perform(self, action: kinds.Action, firing: Firing, before: int) -> str:
        self._check_permitted(action, firing)
        return await self._carry_out(action, firing, before)

    async def _carry_out(self, action: kinds.Action, firing: Firing, before: int) -> str:
        if isinstance(action, kinds.Python):
            return await self._python(action, firing, before)
        return await self._known(action, firing, {}, before)

    def _check_permitted(self, action: kinds.Action, firing: Firing) -> None:
        """Look again: the table may be older than what is allowed today, and so may a topic."""
        rule = firing.rule
        if rule is None:
            raise Failed("refused: nobody knows whose rule this is")
        refusal = self._permissions.refusal(rule, action)
        if refusal is not None:
            whose = rights_text(rule.source)
            raise Failed(f"refused: {refusal.text} (this rule has the rights of {whose})")
        if isinstance(action, kinds.Publish) and not self._permissions.is_own(rule):
            listening = self._node.get_subscriptions_info_by_topic(action.topic)
            gates = self._permissions.gates.intersection(info.node_name for info in listening)
            if gates:
                raise Failed(f"refused: {min(gates)} hears /{action.topic} by now")

    async def _python(self, action: kinds.Python, firing: Firing, before: int) -> str:
        entry = self._functions.get(action.name)
        if entry is None:
            raise Failed(f"the recipe has no function {action.name!r}")
        if isinstance(entry, FallbackSequence):
            fallback = entry.next()
            if fallback is None:
                raise Failed("given up: every fallback was tried; a person must look")
            text = await self._carry_out(fallback, firing, before)
            return f"{_name(fallback)}: {text}"
        if isinstance(entry, Parsed):
            parser = entry.parser
            made = await self._call_function(
                parser.make, {"message": firing.message}, firing.lane, PARSING, action.name
            )
            return await self._known(entry.action, firing, parser.arguments(made), before)
        kwargs = resolve(action.kwargs, firing.message, firing.messages)
        result = await self._call_function(entry, kwargs, firing.lane, action.timeout, action.name)
        if result is False:
            raise Failed(f"{action.name} returned False")
        return "" if result is None else str(result)

    async def _call_function(
        self,
        function: Callable[..., Any],
        kwargs: Mapping[str, Any],
        lane: str,
        timeout: float | None,
        name: str,
    ) -> Any:
        """Call a function of the recipe in a thread; an ``async def`` ends with whoever waits."""
        call = RecipeCall(function, kwargs)
        done = self._awaitables.future()
        begun = threading.Lock()  # an Event would do, at three times the cost
        begun.acquire()

        def run() -> None:
            begun.release()
            try:
                done.set_result(call.run())
            except Exception as problem:  # noqa: BLE001 - raised again where it is awaited
                done.set_exception(problem)
            except BaseException as problem:  # noqa: BLE001 - exit() in a function ends no robot
                done.set_exception(Failed(f"{name} raised {problem!r}"))

        self._threads[lane].submit(run)
        # Python goes on with this thread; the other one waits its turn unless it is let in.
        begun.acquire(timeout=LET_IN)
        try:
            return await self._awaitables.result(done, timeout, f"{name} did not return")
        except (Cancelled, TimeoutError):
            call.cancel()
            raise

    async def _known(
        self, action: Any, firing: Firing, made: Mapping[str, Any], before: int
    ) -> str:
        """One of the kinds that are data; ``made`` are arguments from a parser."""
        if self._moves(action):
            await self._check_uninterrupted(before)

        def arguments(data: Mapping[str, Any]) -> dict[str, Any]:
            return resolve(data, firing.message, firing.messages)

        match action:
            case kinds.Log():
                self._node.write_log(action.level, action.text)
                return action.text
            case kinds.RaiseAlarm():
                taken = arguments(kinds.arguments_of(action))
                text = printable(str(taken["text"]), LONGEST_ALARM) if taken else action.text
                self._alarms.raise_alarm(
                    *(action.alarm, text, firing.rule_id, firing.severity.name.lower()),
                    until_seen=firing.run_id == NO_RUN,
                )
                return text or "raised"
            case kinds.StartMission():
                return await self._mission(action, firing)
            case kinds.ClearAlarm():
                return "cleared" if self._alarms.clear(action.alarm) else "was not raised"
            case kinds.Method():
                kwargs = {**arguments(action.kwargs), **made}
                return await self._method(action.component, action.method, kwargs, action.timeout)
            case kinds.Lifecycle():
                if action.action == "restart" and self._restart_if_stuck(action.component):
                    return "it hung; its process is started anew"
                return await self._method(action.component, action.action, {}, action.timeout)
            case kinds.UpdateParameters():
                return await self._parameters(action, _as_json(arguments(action.parameters)))
            case kinds.Reconfigure():
                config = action.config
                given = config if isinstance(config, str) else _as_json(arguments(config))
                return await self._reconfigure(action, given)
            case kinds.CallService():
                given = made.get("srv_request_msg", made.get("request"))
                request = _message(ros_class(action.type).Request, given, arguments(action.request))
                if isinstance(request, StopRobot.Request) and not request.operator_name:
                    request.operator_name = _who(firing)
                answer = await self._call(
                    ros_class(action.type), action.service, request, action.timeout
                )
                if why := refusal(answer):
                    raise Failed(f"{action.service} says no: {why}")
                return _short(answer)
            case kinds.SendGoal():
                given = made.get("action_request_msg", made.get("request_msg"))
                goal = _message(ros_class(action.type).Goal, given, arguments(action.goal))
                return await self._goal(action, goal, before)
            case kinds.CancelGoal():
                request = CancelGoalService.Request()
                name = f"{action.action}/_action/cancel_goal"
                await self._call(CancelGoalService, name, request, action.timeout)
                return "cancelled"
            case kinds.Publish():
                kind = ros_class(action.type)
                message = _message(kind, made.get("msg"), arguments(action.message))
                return await self._publish(action, message)
        raise Failed(f"actions of kind '{action.kind}' cannot be carried out")

    async def _call(self, kind: Any, name: str, request: Any, timeout: float | None) -> Any:
        """Call a service; if it is one of our own stack that changes something, as who may."""
        server, _, suffix = self._node.resolve_service_name(name).rpartition("/")
        if kind in _UNSIGNABLE and server in self._own:
            return await self._call_own(kind, server, suffix, request, timeout)
        if PROOF in request.get_fields_and_field_types():
            return await self._call_signed(kind, f"{server}/{suffix}", request, timeout)
        return await self._call_as_it_is(kind, name, request, timeout)

    async def _call_own(
        self, kind: Any, server: str, suffix: str, request: Any, timeout: float | None
    ) -> Any:
        """Call what changes a component of ours: over its channel, or signed, over ROS."""
        at = f"{server}/{SIGNED_CALL}"
        answer = await self.channels.ask(
            *(self._own[server], suffix, serialize_message(request)),
            timeout,
            f"no answer from {at}",
        )
        if answer is not None:
            return deserialize_message(answer, kind.Response)
        call = wrap(suffix, request)
        return unwrap(await self._call_signed(SignedCall, at, call, timeout), kind)

    async def _call_signed(self, kind: Any, name: str, request: Any, timeout: float | None) -> Any:
        server = name.rpartition("/")[0]
        signer = self._signers.get(server)
        if signer is None:
            signer = self._signers[server] = Signer(self._node, server, [robot_key()])
        search = SEARCH if timeout is None else min(SEARCH, timeout)
        await self._awaitables.until(lambda: signer.is_ready, search, f"no service {name}")
        answer = await self._call_as_it_is(kind, name, signer.sign(name, request), timeout)
        for _ in range(MOST_CALLS - 1):
            if not signer.learn(answer.message, request.proof):
                break
            answer = await self._call_as_it_is(kind, name, signer.sign(name, request), timeout)
        return answer

    async def _call_as_it_is(
        self, kind: Any, name: str, request: Any, timeout: float | None
    ) -> Any:
        client = self._clients.get((kind, name))
        if client is None:
            self._check_type(kind, "service", name)
            client = self._clients[(kind, name)] = self._node.create_client(kind, name)
        search = SEARCH if timeout is None else min(SEARCH, timeout)
        try:
            await self._awaitables.until(client.service_is_ready, search, f"no service {name}")
        except TimeoutError:
            self._check_type(kind, "service", name)
            raise
        return await self._awaitables.result(
            client.call_async(request), timeout, f"no answer from {name}"
        )

    def _check_type(self, kind: Any, what: str, name: str) -> None:
        """Refuse to go on where the server has another type; one that is not there is no reason.

        A client of the wrong type finds nobody, and stands in the way of the right one later.

        Raises
        ------
        Failed
            When all servers of that name have other types.
        """
        package, family = kind.__module__.split(".")[:2]
        wanted, full = f"{package}/{family}/{kind.__name__}", self._node.resolve_service_name(name)
        offered: set[str] = set()
        for node, namespace in self._node.get_node_names_and_namespaces():
            # Of each node: the graph as a whole counts clients, too, and their types.
            with suppress(NodeNameNonExistentError):  # it has just ended
                offered.update(
                    dict(
                        self._node.get_service_names_and_types_by_node(node, namespace)
                        if what == "service"
                        else self._node.get_action_server_names_and_types_by_node(node, namespace)
                    ).get(full, ())
                )
        if offered and wanted not in offered:
            raise Failed(
                f"the {what} {full} is there, but of type {' and '.join(sorted(offered))}, not "
                f"{wanted}; give the rule's action that type"
            )

    async def _method(
        self, component: str, method: str, kwargs: Mapping[str, Any], timeout: float | None
    ) -> str:
        request = ExecuteMethod.Request(name=method, kwargs_json=json.dumps(_as_json(kwargs)))
        answer = await self._call(ExecuteMethod, f"{component}/execute_method", request, timeout)
        if not answer.success:
            text = answer.error_msg or f"{component}.{method} failed"
            raise Failed(text, _problem_in(answer.response_json))
        return str(answer.response_json)

    async def _parameters(
        self, action: kinds.UpdateParameters, parameters: Mapping[str, Any]
    ) -> str:
        request = ChangeParameters.Request(
            names=list(parameters),
            values=[json.dumps(value) for value in parameters.values()],
            keep_alive=action.keep_alive,
        )
        name = f"{action.component}/update_config_parameters"
        answer = await self._call(ChangeParameters, name, request, action.timeout)
        if not all(answer.success):
            raise Failed("; ".join(filter(None, answer.error_msg)))
        return ", ".join(f"{key} = {value}" for key, value in parameters.items())

    async def _reconfigure(
        self, action: kinds.Reconfigure, config: str | Mapping[str, JsonValue]
    ) -> str:
        if isinstance(config, str):
            request = ConfigureFromFile.Request(path_to_file=config, keep_alive=action.keep_alive)
            name = f"{action.component}/configure_from_file"
            answer = await self._call(ConfigureFromFile, name, request, action.timeout)
            if not answer.success:
                raise Failed(answer.error_msg)
            return config
        kwargs = {"new_config": config, "keep_alive": action.keep_alive}
        return await self._method(action.component, "reconfigure", kwargs, action.timeout)

    async def _mission(self, action: kinds.StartMission, firing: Firing) -> str:
        if self.start_mission is None:
            raise Failed("nobody keeps missions here")
        told = self._awaitables.future()
        self.start_mission(action.mission, _who(firing), told.set_result)
        why = await self._awaitables.result(told, action.timeout, "the mission did not begin")
        if why:
            raise Failed(why)
        return "begun, or in the queue"

    async def _goal(self, action: kinds.SendGoal, goal: Any, before: int) -> str:
        kind = ros_class(action.type)
        client = self._actions.get((kind, action.action))
        if client is None:
            self._check_type(kind, "action", action.action)
            client = self._node.create_action_client(kind, action.action)
            self._actions[(kind, action.action)] = client
        try:
            what = f"no server {action.action}"
            await self._awaitables.until(client.server_is_ready, SEARCH, what)
        except TimeoutError:
            self._check_type(kind, "action", action.action)
            raise
        await self._check_uninterrupted(before)
        sent = client.send_goal_async(goal)
        try:
            handle = await self._awaitables.result(sent, SEARCH, f"no answer from {action.action}")
        except (Cancelled, TimeoutError):
            # A server that was held takes it up when it goes on.
            sent.add_done_callback(_call_off)
            raise
        if not handle.accepted:
            raise Failed(f"{action.action} refused the goal")
        try:
            ended = await self._awaitables.result(
                handle.get_result_async(), action.timeout, f"no end of the goal of {action.action}"
            )
        except (Cancelled, TimeoutError):
            # Nobody is left to follow it: a goal must not go on behind everybody's back.
            handle.cancel_goal_async()
            raise
        text = getattr(ended.result, "message", "") or _STATUS.get(ended.status, "ended")
        if ended.status != GoalStatus.STATUS_SUCCEEDED:
            raise Failed(text)
        return text

    async def _publish(self, action: kinds.Publish, message: Any) -> str:
        with self.publishers.lease(action) as publisher:
            with suppress(TimeoutError):  # who listens is told; if nobody does, that is
                await self._awaitables.until(publisher.has_found_all, MATCH, "listeners")
            deadline = None if action.period is None else self._clock.monotonic() + action.period
            times = 1
            publisher.publish(message)
            while action.rate and not (deadline and self._clock.monotonic() >= deadline):
                await self._awaitables.sleep(1.0 / action.rate)
                publisher.publish(message)
                times += 1
            if not publisher.kept:
                # It takes with it what it has not delivered yet.
                await self._awaitables.sleep(LINGER)
            return _heard_by(publisher.listeners(), times)


_STATUS = {
    GoalStatus.STATUS_SUCCEEDED: "succeeded",
    GoalStatus.STATUS_CANCELED: "cancelled",
    GoalStatus.STATUS_ABORTED: "aborted",
}


def _call_off(sent: Any) -> None:
    """Cancel a goal that was accepted when nobody waited for it any more."""
    if sent.exception() is None and sent.result().accepted:
        sent.result().cancel_goal_async()


def _who(firing: Firing) -> str:
    """Who presses STOP, for those who look at the robot."""
    return f"rule {(firing.rule and firing.rule.name) or firing.rule_id}"


def _name(action: Any) -> str:
    """What an action is called in the journal."""
    for key in ("method", "action", "service", "topic", "name", "alarm"):
        value = getattr(action, key, None)
        if value:
            component = getattr(action, "component", "")
            return f"{component}.{value}" if component else f"{action.kind} {value}"
    return str(action.kind)


def _message(kind: type[Any], given: Any, data: Mapping[str, Any]) -> Any:
    """What is sent: made by a function of the recipe, or of data; all of it fits its fields."""
    if given is None:
        return fill(kind(), expand(data))
    if not isinstance(given, kind):
        raise Failed(f"the event_parser made a {type(given).__name__}, not a {kind.__name__}")
    return checked(given)


def _as_json(arguments: Mapping[str, Any]) -> dict[str, JsonValue]:
    """Arguments as they are sent to a component, parts of messages among them."""
    return {name: part_to_plain(value) for name, value in arguments.items()}


def _heard_by(listeners: Listeners, times: int) -> str:
    matched, unfit = listeners
    text = "published" if times == 1 else f"published {times} times"
    text += f" to {matched} listener{'s' * (matched != 1)}" if matched else ", but nobody listens"
    if unfit:
        text += f"; {unfit} more ask{'s' * (unfit == 1)} for a latched topic, and got nothing"
    return text


def _problem_in(response: str) -> str:
    """Why a component's method failed, as the component tells beside its message."""
    try:
        told = json.loads(response or "null")
    except json.JSONDecodeError:  # another's component
        return ""
    problem = told.get("problem") if isinstance(told, dict) else None
    return problem if isinstance(problem, str) else ""


def _short(answer: Any) -> str:
    for key in ("message", "error_msg", "result"):
        value = getattr(answer, key, None)
        if value is not None:
            return f"{key} {value}"
    return "answered"
