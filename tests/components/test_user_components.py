"""Components that users write: what they declare is served, and mistakes in them are told."""

import threading
import time
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest
from automatika_ros_sugar.msg import ComponentStatus
from geometry_msgs.msg import PoseStamped
from kompass_interfaces.action import IntelligentRest, MotionRecording
from lifecycle_msgs.msg import State
from nav_msgs.srv import GetMap
from pydantic import Field
from rclpy.action import ActionServer, CancelResponse
from std_msgs.msg import Bool, Byte, Float32, Float32MultiArray, Int32MultiArray, String
from std_srvs.srv import Trigger

from kompass.components import Component, component_action
from kompass.components.base.values import message_of, value_of
from kompass.config import BaseComponentConfig
from kompass.expressions import condition_of
from kompass.monitor.introspection.component_specs import component_spec
from kompass.recipe.table import recipe_rules
from kompass.ros import Action, Launcher, Topic
from kompass.ros import Event as RecipeEvent
from kompass.rulebook.permissions import Permissions
from kompass.rules.schema.actions import Method
from kompass.rules.schema.events import Event
from kompass.rules.schema.table import Rule, Table
from tests.components.alive import Alive
from tests.components.goals import Goals
from tests.support.patience import patient
from tests.support.processes import wait_until

pytestmark = pytest.mark.ros

Run = Callable[..., Alive]
HEALTHY, ALGORITHM, COMPONENT, SYSTEM, GENERAL = range(5)
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
LEVEL = Topic(name="/level", msg_type="Float32")
ALARM = Topic(name="/alarm", msg_type="Bool")


def last(alive: Alive) -> ComponentStatus:
    wait_until(lambda: alive.statuses, 5, "a status")
    return alive.statuses[-1]


def status_comes(alive: Alive, level: int, text: str = "") -> None:
    wait_until(
        lambda: last(alive).status == level and text in last(alive).msg, 5, f"status {level} {text}"
    )


# -- the kinds of components ------------------------------------------------------------------


class Watch(Component):
    """A timed component, as the older guide writes one: topics in lists, publishers by name."""

    def __init__(self, component_name: str = "watch", **kwargs: Any) -> None:
        super().__init__(component_name, inputs=[LEVEL], outputs=[ALARM], **kwargs)
        self.order: list[str] = []

    def _execution_step(self) -> None:
        self.order.append("step")
        if self.got_all_inputs():
            self.publishers_dict["alarm"].publish(self.callbacks["level"].get_output() < 0.2)

    def _execute_once(self) -> None:
        self.order.append("once")


def test_topics_in_lists_go_by_their_names(run_on_dds: Run) -> None:
    alive = run_on_dds(Watch())
    heard = alive.hear(Bool, "/alarm")
    levels = alive.publisher(Float32, "/level")
    levels.publish(Float32(data=0.1))
    wait_until(lambda: heard and heard[-1].data, 5, "the alarm")
    levels.publish(Float32(data=0.9))
    wait_until(lambda: heard[-1].data is False, 5, "the end of the alarm")


def test_execute_once_is_called_once_in_each_activation_after_the_first_step(
    run_on_dds: Run,
) -> None:
    watch = Watch()
    alive = run_on_dds(watch)
    wait_until(lambda: watch.order.count("step") > 3, 5, "steps")
    assert watch.order[:2] == ["step", "once"]
    assert watch.order.count("once") == 1
    watch.order.clear()
    assert alive.execute("restart").success
    wait_until(lambda: watch.order.count("step") > 3, 5, "steps after the restart")
    assert watch.order.count("once") == 1


class Counter(Component):
    """Steps at messages."""

    def __init__(self) -> None:
        super().__init__("counter", inputs=[LEVEL])
        self.run_type = "Event"
        self.seen: list[float] = []

    def _execution_step(self) -> None:
        value = self.callbacks["level"].get_output()
        self.seen.append(value)
        if value < 0:
            raise ValueError("a level below zero")


def test_an_event_component_steps_at_each_message_and_only_then(run_on_dds: Run) -> None:
    counter = Counter()
    alive = run_on_dds(counter)
    levels = alive.publisher(Float32, "/level")
    status_comes(alive, HEALTHY, "waiting for /level")
    assert counter.seen == []
    for value in (1.0, 2.0, 3.0):
        levels.publish(Float32(data=value))
        wait_until(lambda: counter.seen[-1:] == [value], 5, f"the step at {value}")  # noqa: B023
    assert counter.seen == [1.0, 2.0, 3.0]
    levels.publish(Float32(data=-1.0))
    status_comes(alive, COMPONENT, "a level below zero")
    levels.publish(Float32(data=1.0))
    status_comes(alive, HEALTHY)


def test_a_callback_that_restarts_the_component_takes_the_step_away(run_on_dds: Run) -> None:
    counter = Counter()
    restarted: list[float] = []

    def restart_at_five(output: float) -> None:
        if output == 5.0:
            with counter.safe_restart():
                restarted.append(output)

    counter.attach_custom_callback("level", restart_at_five)
    alive = run_on_dds(counter)
    alive.publisher(Float32, "/level").publish(Float32(data=5.0))
    wait_until(lambda: restarted and counter.is_active, 5, "the restart")
    alive.publisher(Float32, "/level").publish(Float32(data=6.0))
    wait_until(lambda: counter.seen, 5, "a step")
    assert counter.seen == [6.0], "no step without its message"


class Answerer(Component):
    """Serves a Trigger."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("answerer", main_srv_type=Trigger, **kwargs)
        self.run_type = "Server"
        self.problem: Exception | None = None

    def main_service_callback(
        self, request: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        if self.problem is not None:
            raise self.problem
        response.success, response.message = True, f"by {self.node_name}"
        return response


def test_a_server_component_serves_under_the_name_of_its_type(run_on_dds: Run) -> None:
    answer = run_on_dds(Answerer()).call(Trigger, "trigger", Trigger.Request())
    assert (answer.success, answer.message) == (True, "by answerer")


def test_a_service_may_be_named_and_its_type_set_afterwards(run_on_dds: Run) -> None:
    class Older(Component):
        def main_service_callback(self, request: Any, response: Any) -> Any:
            response.success = True
            return response

    component = Older("older")
    component.service_type = Trigger
    component.run_type = "SERVER"
    component.main_srv_name = "/older/ask"
    assert component.main_srv_name == "older/ask"
    assert run_on_dds(component).call(Trigger, "ask", Trigger.Request()).success


def test_a_service_callback_may_take_its_time_while_the_loop_goes_on(run_on_dds: Run) -> None:
    class Slow(Component):
        steps = 0

        async def main_service_callback(self, request: Any, response: Any) -> Any:
            await self.sleep(0.5)
            response.success = True
            return response

        def _execution_step(self) -> None:
            self.steps += 1

    slow = Slow("slow", main_srv_type=Trigger)
    alive = run_on_dds(slow)
    wait_until(lambda: slow.steps > 0, 5, "a step")
    done, before = alive.begin(Trigger, "trigger", Trigger.Request()), slow.steps
    wait_until(lambda: done() is not None, 5, "the answer")
    assert done().success
    assert slow.steps - before >= 2, "a timed component serves too, and steps meanwhile"


def test_a_service_callback_that_raises_is_a_failure_until_it_does_not(run_on_dds: Run) -> None:
    answerer = Answerer()
    alive = run_on_dds(answerer)
    answerer.problem = OSError("the disk is full")
    answer = alive.call(Trigger, "trigger", Trigger.Request())
    assert (answer.success, answer.message) == (False, "OSError: the disk is full")
    status_comes(alive, COMPONENT, "main_service_callback: OSError: the disk is full")
    answerer.problem = None
    assert alive.call(Trigger, "trigger", Trigger.Request()).success
    status_comes(alive, HEALTHY)


def test_an_inactive_server_says_that_it_is(run_on_dds: Run) -> None:
    alive = run_on_dds(Answerer(), activate=False)
    answer = alive.call(Trigger, "trigger", Trigger.Request())
    assert not answer.success
    assert "answerer is not active; start it" in answer.message


def test_without_a_way_to_say_that_it_failed_nothing_is_answered(run_on_dds: Run) -> None:
    class Maps(Component):
        calls = 0

        def main_service_callback(self, request: Any, response: Any) -> Any:
            self.calls += 1
            raise OSError("no map")

    maps = Maps("maps", main_srv_type=GetMap)
    alive = run_on_dds(maps)
    answer = alive.begin(GetMap, "get_map", GetMap.Request())
    status_comes(alive, COMPONENT, "no map")
    assert answer() is None, "an empty map would pass for a map"


class Rest(Component):
    """Pursues a goal as the older guide writes it: it waits, and looks for a cancel request."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("rest", main_action_type=IntelligentRest, **kwargs)
        self.run_type = "ActionServer"
        self.begun = threading.Event()
        self.left = threading.Event()
        self.steps = 0

    def main_action_callback(self, goal_handle: Any) -> IntelligentRest.Result:
        self.begun.set()
        end = time.monotonic() + goal_handle.request.period_secs
        feedback = IntelligentRest.Feedback()
        while time.monotonic() < end:
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                return IntelligentRest.Result()
            if not goal_handle.is_active:
                self.left.set()
                return IntelligentRest.Result()
            feedback.error.orientation_error = end - time.monotonic()
            goal_handle.publish_feedback(feedback)
            time.sleep(0.02)
        goal_handle.succeed()
        return IntelligentRest.Result()


def test_an_action_server_pursues_a_goal_beside_its_loop_and_reports(run_on_dds: Run) -> None:
    rest = Rest()
    alive = run_on_dds(rest)
    goals = Goals(alive, IntelligentRest, "/rest/intelligent_rest")
    handle = goals.send(period_secs=0.4)
    assert handle.accepted
    assert alive.execute("broadcast_status").success, "the loop goes on"
    assert goals.result(handle).status == SUCCEEDED
    assert goals.feedback


def test_a_second_goal_is_refused_until_the_first_has_ended(run_on_dds: Run) -> None:
    rest = Rest()
    goals = Goals(run_on_dds(rest), IntelligentRest, "/rest/intelligent_rest")
    first = goals.send(period_secs=60.0)
    assert rest.begun.wait(patient(5))
    assert not goals.send(period_secs=0.0).accepted
    goals.cancel(first)
    assert goals.result(first).status == CANCELED
    again = goals.send(period_secs=0.0)
    assert again.accepted
    assert goals.result(again).status == SUCCEEDED


def test_deactivation_ends_the_goal_and_refuses_the_next(run_on_dds: Run) -> None:
    rest = Rest()
    alive = run_on_dds(rest)
    goals = Goals(alive, IntelligentRest, "/rest/intelligent_rest")
    handle = goals.send(period_secs=60.0)
    assert rest.begun.wait(patient(5))
    assert alive.execute("stop").success
    assert goals.result(handle).status == ABORTED
    assert rest.left.wait(patient(5)), "the hook sees that its goal is over"
    assert not goals.send(period_secs=0.0).accepted
    assert alive.execute("start").success
    status_comes(alive, HEALTHY)
    assert goals.result(goals.send(period_secs=0.0)).status == SUCCEEDED


def test_an_action_callback_may_be_a_coroutine(run_on_dds: Run) -> None:
    class Async(Component):
        async def main_action_callback(self, goal_handle: Any) -> IntelligentRest.Result:
            await self.sleep(goal_handle.request.period_secs)
            goal_handle.succeed()
            return IntelligentRest.Result()

    component = Async("later", main_action_type=IntelligentRest)
    component.main_action_name = "later/rest"
    goals = Goals(run_on_dds(component), IntelligentRest, "/later/rest")
    assert goals.result(goals.send(period_secs=0.1)).status == SUCCEEDED


def test_an_action_callback_that_raises_aborts_its_goal_and_says_why(run_on_dds: Run) -> None:
    class Broken(Component):
        broken = True

        def main_action_callback(self, goal_handle: Any) -> Any:
            if self.broken:
                raise ZeroDivisionError("no such thing")
            goal_handle.succeed()
            return MotionRecording.Result()

    component = Broken("broken", main_action_type=MotionRecording)
    alive = run_on_dds(component)
    goals = Goals(alive, MotionRecording, "/broken/motion_recording")
    ended = goals.result(goals.send())
    assert ended.status == ABORTED
    assert ended.result.message == "ZeroDivisionError: no such thing"
    status_comes(alive, COMPONENT, "main_action_callback: ZeroDivisionError: no such thing")
    component.broken = False
    assert goals.result(goals.send()).status == SUCCEEDED
    status_comes(alive, HEALTHY)


def test_a_goal_that_an_own_server_cannot_judge_is_refused_and_the_process_lives(
    run_on_dds: Run,
) -> None:
    """Both servers: the node's, and one of rclpy that a component makes by itself."""

    class Judge(Component):
        def create_interfaces(self) -> None:
            async def execute(goal_handle: Any) -> Any:
                goal_handle.succeed()
                return MotionRecording.Result()

            def judge(goal: Any) -> Any:
                raise ZeroDivisionError("no such thing")

            accept = {"cancel_callback": lambda _: CancelResponse.ACCEPT}
            name = f"{self.node_name}/ours"
            self.node.create_action_server(
                MotionRecording, name, execute, goal_callback=judge, **accept
            )
            name = f"{self.node_name}/theirs"
            self.theirs = ActionServer(
                self.node, MotionRecording, name, execute, goal_callback=judge
            )

    alive = run_on_dds(Judge("judge"))
    for name in ("ours", "theirs"):
        assert not Goals(alive, MotionRecording, f"/judge/{name}").send().accepted
        status_comes(alive, COMPONENT, "ZeroDivisionError: no such thing")
    assert alive.execute("broadcast_status").success


@pytest.mark.parametrize("given", [None, 3])
def test_what_is_no_result_is_said_and_the_goal_is_not_won(run_on_dds: Run, given: object) -> None:
    class Forgetful(Component):
        def main_action_callback(self, goal_handle: Any) -> Any:
            return given

    alive = run_on_dds(Forgetful("forgetful", main_action_type=IntelligentRest))
    goals = Goals(alive, IntelligentRest, "/forgetful/intelligent_rest")
    assert goals.result(goals.send()).status == ABORTED
    status_comes(alive, COMPONENT, "return the result, a IntelligentRest.Result")


# -- mistakes ---------------------------------------------------------------------------------


def nothing(self: Any, *_: Any) -> None:
    """Stands for a hook."""


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("_execute_onse", nothing, "did you mean '_execute_once'"),
        ("_execute_step", nothing, "did you mean '_execution_step'"),
        ("main_servce_callback", nothing, "did you mean 'main_service_callback'"),
        ("main_action_callbacks", nothing, "did you mean 'main_action_callback'"),
        ("custom_on_activated", nothing, "did you mean 'custom_on_activate'"),
        ("allowed_input", {}, "did you mean 'allowed_inputs'"),
        ("create_all_timers", nothing, "make others in create_interfaces"),
        ("attach_callbacks", nothing, "call attach_custom_callback in custom_on_activate"),
        ("_execution_step", lambda self, now: None, "is called with no argument besides self"),
        ("main_service_callback", lambda self, request: None, "is called with two arguments"),
        *(
            (name, nothing, "is used by the component itself; give yours another one")
            for name in (
                *("_tick", "start", "stop", "restart", "inputs", "publish", "sleep", "get_logger"),
                *("create_timer", "node_name", "config", "health", "on_activate", "fallbacks"),
            )
        ),
        ("node", property(nothing), "is used by the component itself"),
        ("callbacks", property(nothing), "is used by the component itself"),
        ("loop_rate", 5.0, "is used by the component itself"),
    ],
)
def test_a_hook_that_would_never_be_called_is_an_error_when_the_component_is_made(
    name: str, value: Any, told: str
) -> None:
    kind = type("Mistaken", (Component,), {name: value, "__module__": __name__})
    with pytest.raises(TypeError, match=told) as refused:
        kind("mistaken")
    assert f"Mistaken.{name}" in str(refused.value)


def test_a_mistake_in_a_base_of_ones_own_is_found_too() -> None:
    base = type("Base", (Component,), {"_execute_onse": nothing, "__module__": __name__})
    with pytest.raises(TypeError, match=r"Base\._execute_onse"):
        type("Derived", (base,), {"__module__": __name__})("derived")


def test_a_step_that_nobody_awaits_is_refused() -> None:
    class Later(Component):
        async def _execution_step(self) -> None:  # type: ignore[override]
            """Would never run."""

    with pytest.raises(TypeError, match="is an 'async def', which nobody awaits"):
        Later("later")


def test_names_of_ones_own_are_free() -> None:
    class Own(Component):
        battery_level = 3.0

        def service_callback(self) -> None: ...
        def execute(self) -> None: ...
        def on_level(self) -> None: ...
        def _step_size(self) -> None: ...

    assert Own("own").battery_level == 3.0


class Serving(Component):
    def main_service_callback(self, request: Any, response: Any) -> Any:
        return response


class Pursuing(Component):
    def main_action_callback(self, goal_handle: Any) -> Any:
        return None


class Needing(Component):
    from kompass.ros import AllowedTopics

    allowed_inputs = {"level": AllowedTopics(["Float32"])}  # noqa: RUF012


@pytest.mark.parametrize(
    ("make", "run_type", "told"),
    [
        (lambda: Component("x"), "Server", r"run_type = Server needs main_srv_type=… and main_"),
        (lambda: Component("x"), "ActionServer", r"run_type = ActionServer needs main_action_type"),
        (lambda: Serving("x"), "Timed", r"main_service_callback would never be called"),
        (lambda: Pursuing("x"), "Timed", r"main_action_callback would never be called"),
        (lambda: Component("x", main_srv_type=Trigger), "Timed", r"Trigger, and nothing that serv"),
        (lambda: Watch("x"), "Server", r"run_type = Server needs main_srv_type"),
        (lambda: Component("x", inputs=[LEVEL]), "Event", r"needs an _execution_step"),
        (lambda: Needing("x"), "Timed", r"x: input 'level' has too few topics; give them with inp"),
    ],
)
def test_what_cannot_work_is_refused_before_anything_starts(
    make: Callable[[], Component], run_type: str, told: str
) -> None:
    component = make()
    component.run_type = run_type
    launcher = Launcher()
    launcher.kompass(components=[component])
    with pytest.raises((TypeError, ValueError), match=told):
        launcher.bringup()


def test_an_event_component_without_inputs_is_refused() -> None:
    class Deaf(Component):
        def _execution_step(self) -> None: ...

    component = Deaf("deaf")
    component.run_type = "Event"
    with pytest.raises(ValueError, match="run_type = Event needs an input"):
        component.check_declaration()


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Component("x", main_srv_type=Bool), "main_srv_type = .* is not the type of a ROS"),
        (lambda: Component("x", main_action_type=Trigger), "is not the type of a ROS action"),
        (
            lambda: Component("x", inputs=cast(Any, ["/level"])),
            "holds '/level', which is not a Topic",
        ),
        (
            lambda: Component("x", inputs=cast(Any, LEVEL)),
            "give a list of topics",
        ),
        (lambda: Component("x", inputs=[LEVEL, LEVEL]), "names '/level' twice"),
    ],
)
def test_what_is_no_topic_or_type_is_refused_when_it_is_given(
    make: Callable[[], Component], told: str
) -> None:
    with pytest.raises((TypeError, ValueError), match=told):
        make()


def test_a_list_finds_the_keys_of_a_component_that_has_some() -> None:
    from kompass.components import LocalMapper, Planner

    mapper = LocalMapper(inputs=[Topic(name="/front", msg_type="LaserScan")])
    assert mapper.in_topic_name("sensor_data") == "front"
    with pytest.raises(ValueError, match="'/here' fits several: goal_point, location; give inputs"):
        Planner(inputs=[Topic(name="/here", msg_type="Odometry")])
    with pytest.raises(ValueError, match="'/level' fits none of map, goal_point, location"):
        Planner(inputs=[LEVEL])


# -- actions ------------------------------------------------------------------------------------


class Chatty(Component):
    """Has methods that are marked, and some that are not."""

    def __init__(self) -> None:
        super().__init__("chatty")
        self.said: list[str] = []

    def say(self, text: str) -> bool:
        """Say it."""
        self.said.append(text)
        return True

    def wipe(self) -> bool:
        """Forget all."""
        self.said.clear()
        return True

    @component_action
    def shout(self, text: str) -> bool:
        """Say it aloud."""
        self.said.append(text.upper())
        return True


def test_a_method_that_is_not_marked_may_be_used_by_the_recipe_and_is_closed_else(
    run_on_dds: Run,
) -> None:
    chatty = Chatty()
    assert "say" not in chatty.available_actions
    data = Action(chatty.say, args=("hello",)).to_data()
    assert isinstance(data, Method)
    assert (data.method, data.kwargs) == ("say", {"text": "hello"})
    alive = run_on_dds(chatty)
    assert alive.execute("say", text="hello").success
    assert chatty.said == ["hello"]
    answer = alive.execute("wipe")
    assert not answer.success
    assert "chatty has no action 'wipe'" in answer.error_msg


def test_it_is_open_to_the_recipe_however_the_recipe_writes_the_action() -> None:
    chatty = Chatty()
    data = Method(component="chatty", method="say", kwargs={"text": "hello"})
    recipe_rules({RecipeEvent(LEVEL): Action.from_data(data)}, [chatty])
    assert "say" in chatty.available_actions


def test_one_may_be_a_fallback_and_what_is_ours_or_hidden_may_not(run_on_dds: Run) -> None:
    chatty = Chatty()
    chatty.on_fail(chatty.wipe)
    assert "wipe" in chatty.available_actions
    with pytest.raises(TypeError, match="publish_status is not a component action"):
        chatty.on_fail(chatty.publish_status)
    for hidden in (chatty.main_service_callback, chatty._execution_step, chatty.init_variables):
        with pytest.raises(TypeError, match="cannot be called by a rule"):
            Action(hidden)


@pytest.mark.parametrize("source", ["edited", "engineer"])
def test_rules_of_people_may_call_what_is_marked_and_nothing_that_the_recipe_opened(
    source: Any,
) -> None:
    chatty = Chatty()
    Action(chatty.say, args=("hello",))
    permissions = Permissions({"chatty": component_spec(chatty)}, Table())

    def refusal(method: str) -> str | None:
        call = Method(component="chatty", method=method, kwargs={"text": "x"})
        condition = condition_of(chatty.status_topic.msg.status != 0)
        event = Event(condition=condition)
        rule = Rule(id="a", name="a", event=event, actions=(call,), source=source)
        refused = permissions.refusal(rule, call)
        return refused.code if refused else None

    assert refusal("shout") is None
    assert refusal("say") == "recipe-only"


# -- what the code of a component uses --------------------------------------------------------


class Desk(Component):
    """Has an output of each sort."""

    KINDS = ("Float32", "Int32", "Bool", "String", "Float32MultiArray", "PoseStamped", "Twist")

    def __init__(self) -> None:
        super().__init__(
            "desk",
            inputs={"words": Topic(name="/words", msg_type="String")},
            outputs={kind: Topic(name=f"/out/{kind}", msg_type=kind) for kind in self.KINDS},
        )


@pytest.mark.parametrize(
    ("kind", "value", "told"),
    [
        ("Float32", 1.5, lambda message: message.data == 1.5),
        ("Float32", 2, lambda message: message.data == 2.0),
        ("Float32", np.float64(0.5), lambda message: message.data == 0.5),
        ("Int32", np.int64(7), lambda message: message.data == 7),
        ("Bool", True, lambda message: message.data is True),
        ("String", "hello", lambda message: message.data == "hello"),
        ("String", {"data": "by field"}, lambda message: message.data == "by field"),
        ("String", String(data="itself"), lambda message: message.data == "itself"),
        ("PoseStamped", (1.0, 2.0, 0.0), lambda message: message.pose.position.y == 2.0),
        ("Twist", (0.1, 0.0, 0.5), lambda message: message.angular.z == 0.5),
    ],
)
def test_a_publisher_takes_plain_values(
    run_on_dds: Run, kind: str, value: Any, told: Callable[[Any], bool]
) -> None:
    desk = Desk()
    alive = run_on_dds(desk)
    heard = alive.hear(desk.get_out_topic(kind).ros_msg_type, f"/out/{kind}")  # type: ignore[union-attr]
    wait_until(lambda: alive.node.count_publishers(f"/out/{kind}"), 5, "the publisher")

    def comes() -> bool:
        desk.publishers_dict[kind].publish(value)
        return bool(heard)

    wait_until(comes, 5, "the message")
    assert told(heard[-1])


@pytest.mark.parametrize(
    ("kind", "value"),
    [
        (Float32MultiArray, np.arange(6.0).reshape(2, 3)),
        (Float32MultiArray, [[1, 2], [3, 4]]),
        (Int32MultiArray, [-(2**31), 2**31 - 1]),
        (Int32MultiArray, []),
        (Byte, 7),
        (PoseStamped, (1.0, 2.0, 0.5, 0.3)),
    ],
)
def test_values_read_as_they_were_written(kind: type, value: Any) -> None:
    np.testing.assert_allclose(value_of(message_of(kind, value)), value)


@pytest.mark.parametrize(
    ("kind", "value", "told"),
    [
        ("Float32", "much", r"/out/Float32: 'much' makes no Float32; give a number, a Float32 mes"),
        ("Float32", True, "True makes no Float32; give a number"),
        ("Int32", 1.5, "1.5 makes no Int32; give a whole number"),
        ("Bool", 1, "1 makes no Bool; give True or False"),
        ("String", 3, "3 makes no String; give a text"),
        ("Twist", (1.0, 2.0), r"\(there are 2\); give \(vx, vy, omega\)"),
        ("Int32", 2**31, r"makes no Int32 \(data = 2147483648: .*int32: -2147483648 to 2147483647"),
        ("Float32", 1e300, r"makes no Float32 .*float32"),
        ("String", "\ud800", "makes no String .*surrogate"),
        ("Float32MultiArray", [0.0, 1e300], r"makes no Float32MultiArray \(data\[1\] = 1e\+300"),
        ("String", {"text": "x"}, "has no field 'text'"),
        ("PoseStamped", Bool(), "give .* a PoseStamped message"),
    ],
)
def test_a_value_that_makes_no_such_message_is_refused(
    run_on_dds: Run, kind: str, value: Any, told: str
) -> None:
    desk = Desk()
    run_on_dds(desk)
    with pytest.raises(TypeError, match=told):
        desk.publishers_dict[kind].publish(value)


def test_a_header_gets_the_frame_and_the_time_and_nothing_else_takes_one(run_on_dds: Run) -> None:
    desk = Desk()
    alive = run_on_dds(desk)
    heard = alive.hear(PoseStamped, "/out/PoseStamped")

    def comes() -> bool:
        desk.publishers_dict["PoseStamped"].publish((1.0, 2.0, 0.0), frame_id="map")
        return bool(heard)

    wait_until(comes, 5, "the pose")
    assert heard[-1].header.frame_id == "map"
    assert heard[-1].header.stamp.sec > 0
    with pytest.raises(TypeError, match="a Float32 has no header for frame_id = 'map'"):
        desk.publishers_dict["Float32"].publish(1.0, frame_id="map")


def test_inputs_and_outputs_are_found_by_key_and_by_topic_and_else_named(run_on_dds: Run) -> None:
    desk = Desk()
    with pytest.raises(KeyError, match="inputs come when it is configured"):
        desk.callbacks["words"]
    run_on_dds(desk)
    assert desk.callbacks["words"] is desk.callbacks["/words"]
    assert list(desk.callbacks) == ["words"]
    assert len(desk.publishers_dict) == len(Desk.KINDS)
    with pytest.raises(KeyError, match="desk: there is no output 'Flaot32'; there are Float32, "):
        desk.publishers_dict["Flaot32"]


def test_processors_and_callbacks_hold_over_restarts_and_other_topics(run_on_dds: Run) -> None:
    desk = Desk()
    called: list[Any] = []
    desk.attach_custom_callback("/words", lambda *, msg, output, **_: called.append(output))
    desk.attach_custom_callback(Topic(name="words", msg_type="String"), called.append)
    desk.add_callback_postprocessor("words", str.upper)
    desk.add_callback_postprocessor("words", lambda text: f"{text}!")
    desk.add_publisher_preprocessor("String", lambda text: None if text == "no" else f"<{text}>")
    alive = run_on_dds(desk)
    assert alive.execute("restart").success
    desk.replace_topic("input", "words", Topic(name="/more_words", msg_type="String"))
    alive.publisher(String, "/more_words").publish(String(data="hi"))
    wait_until(lambda: len(called) == 2, 5, "both callbacks")
    assert called == ["HI!", String(data="hi")]
    assert desk.callbacks["words"].get_output(clear_last=True) == "HI!"
    assert desk.callbacks["words"].get_output() is None
    heard = alive.hear(String, "/out/String")

    def comes() -> bool:
        desk.publishers_dict["String"].publish("no")
        desk.publishers_dict["String"].publish("yes")
        return bool(heard)

    wait_until(comes, 5, "what is not held back")
    assert {message.data for message in heard} == {"<yes>"}


def test_a_callback_that_raises_is_a_failure_with_its_name(run_on_dds: Run) -> None:
    desk = Desk()

    def on_words(msg: String) -> None:
        if msg.data == "bad":
            raise ValueError("not that word")

    desk.attach_custom_callback("words", on_words)
    alive = run_on_dds(desk)
    words = alive.publisher(String, "/words")
    words.publish(String(data="bad"))
    status_comes(alive, COMPONENT, "callback on_words: ValueError: not that word")
    words.publish(String(data="good"))
    status_comes(alive, HEALTHY)


@pytest.mark.parametrize(
    ("attach", "told"),
    [
        (
            lambda c: c.attach_custom_callback("wrods", print),
            "no input uses 'wrods'; .* are /words",
        ),
        (lambda c: c.attach_custom_callback("words", 3), "3 is not a function"),
        (lambda c: c.attach_custom_callback("words", lambda a, b: None), "needs a, b; a callback"),
        (lambda c: c.add_callback_postprocessor("x", str), "no input uses 'x'"),
        (lambda c: c.add_publisher_preprocessor("x", str), "no output uses 'x'"),
        (lambda c: c.add_publisher_preprocessor("String", "f"), "'f' is not a function"),
    ],
)
def test_a_processor_of_nothing_is_refused(attach: Callable[[Component], None], told: str) -> None:
    with pytest.raises((TypeError, ValueError), match=told):
        attach(Desk())


def test_inputs_that_have_not_spoken_are_named_and_told_in_the_status(run_on_dds: Run) -> None:
    component = Component("listener", inputs=[LEVEL, Topic(name="/words", msg_type="String")])
    alive = run_on_dds(component)
    status_comes(alive, HEALTHY, "waiting for /level, /words")
    assert component.get_missing_inputs() == ["level", "words"]
    alive.publisher(Float32, "/level").publish(Float32(data=1.0))
    status_comes(alive, HEALTHY, "waiting for /words")
    assert component.got_all_inputs(inputs_to_check=["level"])
    assert component.got_all_inputs(inputs_to_exclude=["/words"])
    assert not component.got_all_inputs()
    with pytest.raises(ValueError, match="no input uses 'lvel'"):
        component.got_all_inputs(inputs_to_check=["lvel"])
    alive.publisher(String, "/words").publish(String(data="x"))
    wait_until(lambda: last(alive).msg == "Running - Healthy", 5, "nothing to wait for")


@pytest.mark.parametrize(
    ("say", "level", "sources"),
    [
        (lambda h: h.set_fail_algorithm(algorithm_names=["A"]), ALGORITHM, "src_algorithms"),
        (lambda h: h.set_fail_component(component_names=["A"]), COMPONENT, "src_components"),
        (lambda h: h.set_fail_system(topic_names=["A"]), SYSTEM, "src_topics"),
        (lambda h: h.set_fail_system(component_names=["A"]), SYSTEM, "src_components"),
        (lambda h: h.set_failure("something"), GENERAL, ""),
    ],
)
def test_health_is_said_under_the_names_that_older_components_use(
    run_on_dds: Run, say: Callable[[Any], None], level: int, sources: str
) -> None:
    component = Component("moody")
    alive = run_on_dds(component)
    status_comes(alive, HEALTHY)
    say(component.health_status)
    status_comes(alive, level)
    assert not sources or list(getattr(last(alive), sources)) == ["A"]
    flags = ("is_algorithm_fail", "is_component_fail", "is_system_fail", "is_general_fail")
    told = [getattr(component.health_status, flag) for flag in flags]
    assert told == [number == level for number in range(1, 5)]
    assert component.health_status.value == level
    component.health_status.value = HEALTHY
    status_comes(alive, HEALTHY)


@pytest.mark.parametrize(("value", "error"), [(7, ValueError), ("bad", TypeError)])
def test_a_level_that_there_is_not_is_refused(value: Any, error: type[Exception]) -> None:
    with pytest.raises(error, match=r"health_status\.value"):
        Component("moody").health_status.value = value


class Restarting(Component):
    """Changes itself in its first step, as older components do."""

    def __init__(self) -> None:
        super().__init__("restarting", inputs=[LEVEL])
        self.fired, self.caught, self.value = False, False, 0
        self.problem: Exception | None = None
        self.state_inside = self.state_after = -1
        self.steps_after = 0

    def _execution_step(self) -> None:
        if self.fired:
            self.steps_after += 1
            return
        self.fired = True
        try:
            with self.safe_restart():
                self.state_inside = self.lifecycle_state
                self.value = 42
                if self.problem is not None:
                    raise self.problem
        except ValueError:
            self.caught = True
        self.state_after = self.lifecycle_state


@pytest.mark.parametrize("problem", [None, ValueError("on purpose")])
def test_safe_restart_is_down_in_its_body_and_up_after_it_whatever_happens_there(
    run_on_dds: Run, problem: Exception | None
) -> None:
    component = Restarting()
    component.problem = problem
    run_on_dds(component)
    wait_until(lambda: component.steps_after > 3, 5, "steps after the restart")
    assert component.value == 42
    assert component.state_inside == State.PRIMARY_STATE_UNCONFIGURED
    assert component.state_after == State.PRIMARY_STATE_ACTIVE
    assert component.caught is (problem is not None)


def test_a_safe_restart_that_does_not_come_up_is_an_error_and_a_failure(run_on_dds: Run) -> None:
    class Gone(Restarting):
        gone = False

        def _execution_step(self) -> None:
            self.gone = True
            super()._execution_step()

        def custom_on_configure(self) -> None:
            if self.gone:
                raise OSError("the device is gone")

    alive = run_on_dds(Gone())
    status_comes(alive, COMPONENT, "not active again after safe_restart")
    assert "the device is gone" in last(alive).msg


def test_a_safe_restart_on_the_thread_of_a_goal_is_refused(run_on_dds: Run) -> None:
    class Restless(Component):
        def main_action_callback(self, goal_handle: Any) -> Any:
            with self.safe_restart():
                pass

    alive = run_on_dds(Restless("restless", main_action_type=MotionRecording))
    goals = Goals(alive, MotionRecording, "/restless/motion_recording")
    ended = goals.result(goals.send())
    assert ended.status == ABORTED
    assert "make main_action_callback an 'async def'" in ended.result.message
    assert alive.component.is_active


def test_an_error_in_a_transition_is_told_to_the_component(run_on_dds: Run) -> None:
    class Told(Component):
        told = 0

        def custom_on_configure(self) -> None:
            raise OSError("no device")

        def custom_on_error(self) -> None:
            self.told += 1

    component = Told("told")
    alive = run_on_dds(component, activate=False)
    assert not alive.execute("start").success
    assert component.told == 1
    component.get_logger().info("and its logger is at hand")


class Settings(BaseComponentConfig):
    """Settings of one's own."""

    limit: float = Field(default=0.2, gt=0.0, lt=1.0, description="share of the battery")


def test_settings_of_ones_own_are_checked(run_on_dds: Run) -> None:
    class Configured(Component):
        config: Settings
        config_class = Settings

    with pytest.raises(ValueError, match="limit"):
        Settings(limit=2.0)
    component = Configured("configured", config=Settings(limit=0.3))
    with pytest.raises(ValueError, match="limit"):
        component.config.limit = -1.0
    assert component.config.limit == 0.3


def test_a_field_of_attrs_is_no_setting_and_is_refused_with_what_to_write() -> None:
    counting = type("_CountingAttr", (), {"__module__": "attr._make"})
    with pytest.raises(TypeError, match=r"Mine\.limit is a field of attrs.*Field\(default"):
        type(
            "Mine",
            (BaseComponentConfig,),
            {"__annotations__": {"limit": float}, "limit": counting(), "__module__": __name__},
        )


def test_the_run_type_is_no_setting_and_says_where_it_belongs() -> None:
    with pytest.raises(ValueError, match=r"component\.run_type = \"Server\""):
        BaseComponentConfig(**cast(Any, {"_run_type": "Server"}))
