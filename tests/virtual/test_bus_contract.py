"""What a node promises, whichever bus it is on: rclpy on DDS, or virtual time.

Where rclpy surprises it is right, and virtual time follows.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Iterator
from itertools import count, product
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from kompass_interfaces.action import PlanPath
from lifecycle_msgs.msg import Transition, TransitionEvent
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from nav_msgs.msg import Odometry
from rclpy.action import CancelResponse, GoalResponse
from rclpy.duration import Duration
from rclpy.exceptions import InvalidHandle, InvalidTopicNameException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.node import NodeNameNonExistentError
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.task import Future
from std_msgs.msg import Float32, Int32, String
from std_srvs.srv import SetBool, Trigger
from unique_identifier_msgs.msg import UUID

from kompass.bus.node import LifecycleNode, Node
from kompass.rclpy_ext.deferred_service import create_deferred_service
from kompass.rclpy_ext.timers import Timers
from tests.virtual.buses import Bus, bus_of

RCLError = rclpy_implementation.RCLError
RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
LATCHED, VOLATILE = DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE

KINDS = [pytest.param("rclpy", marks=pytest.mark.ros), "virtual"]
_numbers = count()


@pytest.fixture(scope="module", params=KINDS)
def bus(request: pytest.FixtureRequest) -> Iterator[Bus]:
    with bus_of(request.param) as bus:
        yield bus


@pytest.fixture(autouse=True)
def errors(bus: Bus) -> Iterator[list[Exception]]:
    """What callbacks raised; a test that expects some takes them away."""
    yield bus.errors
    left, bus.errors[:] = list(bus.errors), []
    assert left == []


@pytest.fixture(scope="module")
def one(bus: Bus) -> Node:
    return bus.node("one")


@pytest.fixture(scope="module")
def other(bus: Bus) -> Node:
    return bus.node("other", "/robot")


def qos(
    depth: int = 10,
    reliability: ReliabilityPolicy = RELIABLE,
    durability: DurabilityPolicy = VOLATILE,
) -> QoSProfile:
    return QoSProfile(depth=depth, reliability=reliability, durability=durability)


@pytest.fixture
def name() -> str:
    """A name that no other test uses."""
    return f"/name_{next(_numbers)}"


def node_names(asks: Node) -> list[str]:
    """Of those whom a node knows."""
    return [each for each, _ in asks.get_node_names_and_namespaces()]


class Heard(list[Any]):
    """Messages that came."""

    def __init__(
        self, node: Node, kind: Any, topic: str, profile: Any, *, raw: bool = False
    ) -> None:
        super().__init__()
        self.subscription = node.create_subscription(kind, topic, self.append, profile, raw=raw)

    @property
    def data(self) -> list[Any]:
        return [message.data for message in self]


# -- topics -----------------------------------------------------------------------------------


def test_messages_come_in_the_order_in_which_they_were_sent(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    publisher = one.create_publisher(Int32, name, qos(200))
    heard = Heard(other, Int32, name, qos(200))
    bus.until(publisher.get_subscription_count)
    for number in range(100):
        publisher.publish(Int32(data=number))
    bus.until(lambda: len(heard) == 100)
    assert heard.data == list(range(100))


def test_a_listener_has_a_copy_of_its_own_as_the_wire_makes_it(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    publisher = one.create_publisher(Float32, name, 10)
    first, second = Heard(other, Float32, name, 10), Heard(one, Float32, name, 10)
    bus.until(lambda: publisher.get_subscription_count() == 2)
    message = Float32(data=0.1)
    publisher.publish(message)
    message.data = 5.0
    bus.until(lambda: first and second)
    assert first.data == second.data == [float(np.float32(0.1))]
    assert first[0] is not second[0]


def test_a_late_joiner_gets_the_last_messages_of_a_latched_topic(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    publisher = one.create_publisher(Int32, name, qos(2, durability=LATCHED))
    for number in range(5):
        publisher.publish(Int32(data=number))
    bus.rest(0.1)
    heard = Heard(other, Int32, name, qos(10, durability=LATCHED))
    last = Heard(other, Int32, name, qos(1, durability=LATCHED))
    fresh = Heard(other, Int32, name, qos(10))
    bus.until(lambda: len(heard) == 2 and last.data[-1:] == [4])
    assert heard.data == [3, 4]
    publisher.publish(Int32(data=5))
    bus.until(lambda: fresh)
    assert fresh.data == [5], "who did not ask for what was before gets what comes"


def test_what_a_listener_does_not_read_in_time_is_lost_from_the_oldest(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    publisher = one.create_publisher(Int32, name, qos(100))
    heard = Heard(other, Int32, name, qos(3))
    bus.until(publisher.get_subscription_count)
    bus.hold(other)
    for number in range(20):
        publisher.publish(Int32(data=number))
    bus.rest(0.3)
    bus.go_on(other)
    bus.until(lambda: len(heard) == 3)
    bus.rest(0.1)
    assert heard.data == [17, 18, 19]


def test_who_asks_for_more_than_is_offered_hears_nothing(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    kinds = list(product((RELIABLE, BEST_EFFORT), (VOLATILE, LATCHED)))
    pairs = [(offered, asked) for offered in kinds for asked in kinds]
    heard: list[Heard] = []
    publishers = []
    for number, (offered, asked) in enumerate(pairs):
        publishers.append(one.create_publisher(Int32, f"{name}/t{number}", qos(5, *offered)))
        heard.append(Heard(other, Int32, f"{name}/t{number}", qos(5, *asked)))
    fits = [
        not (asked[0] == RELIABLE and offered[0] == BEST_EFFORT)
        and not (asked[1] == LATCHED and offered[1] == VOLATILE)
        for offered, asked in pairs
    ]
    bus.until(lambda: [p.get_subscription_count() for p in publishers] == list(map(int, fits)))
    bus.until(lambda: all(one.count_subscribers(f"{name}/t{n}") for n in range(len(pairs))))
    for publisher in publishers:
        publisher.publish(Int32())
    bus.until(lambda: [len(each) for each in heard] == list(map(int, fits)))
    bus.rest(0.1)
    assert [len(each) for each in heard] == list(map(int, fits))


def test_other_types_do_not_match(bus: Bus, one: Node, other: Node, name: str) -> None:
    publisher = one.create_publisher(Int32, name, 10)
    Heard(other, String, name, 10)
    bus.until(lambda: one.count_subscribers(name) == 1)
    bus.until(lambda: len(dict(one.get_topic_names_and_types())[name]) == 2)
    assert publisher.get_subscription_count() == 0
    assert sorted(dict(one.get_topic_names_and_types())[name]) == [
        "std_msgs/msg/Int32",
        "std_msgs/msg/String",
    ]


def test_one_process_has_one_type_of_a_name(one: Node, name: str) -> None:
    publisher = one.create_publisher(Int32, name, 10)
    with pytest.raises(RCLError):
        one.create_publisher(String, name, 10)
    one.destroy_publisher(publisher)
    one.create_publisher(String, name, 10)


def test_bytes_are_sent_and_heard_as_they_are(bus: Bus, one: Node, other: Node, name: str) -> None:
    publisher = one.create_publisher(Odometry, name, 10)
    raw, heard = Heard(other, Odometry, name, 10, raw=True), Heard(other, Odometry, name, 10)
    bus.until(lambda: publisher.get_subscription_count() == 2)
    message = Odometry(child_frame_id="base")
    publisher.publish(serialize_message(message))
    bus.until(lambda: raw and heard)
    assert raw == [serialize_message(message)]
    assert heard == [message] == [deserialize_message(raw[0], Odometry)]


def test_a_few_fields_are_heard_and_the_whole_message_when_it_is_asked_for(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    publisher = one.create_publisher(Odometry, name, 10)
    heard: list[tuple[Any, Any]] = []
    paths = (("header", "frame_id"), ("pose", "pose", "position", "x"), ("twist", "covariance"))
    other.create_partial_subscription(
        Odometry, name, lambda fields, make: heard.append((fields, make)), 10, paths
    )
    bus.until(publisher.get_subscription_count)
    message = Odometry(child_frame_id="base_link")
    message.header.frame_id = "odom"
    message.pose.pose.position.x = 1.5
    message.twist.covariance = np.arange(36.0)
    publisher.publish(message)
    publisher.publish(serialize_message(message))
    bus.until(lambda: len(heard) == 2)
    for fields, make in heard:
        assert fields.header.frame_id == "odom"
        assert fields.pose.pose.position.x == 1.5
        assert list(fields.twist.covariance) == list(range(36))
        assert not hasattr(fields, "child_frame_id")
        assert make() == message


def test_bytes_that_are_laid_out_otherwise_are_read_as_a_whole(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    publisher = one.create_publisher(Float32, name, 10)
    heard: list[float] = []
    other.create_partial_subscription(
        Float32, name, lambda fields, _: heard.append(fields.data), 10, [("data",)]
    )
    bus.until(publisher.get_subscription_count)
    publisher.publish(b"\x00\x00\x00\x00" + struct.pack(">f", 0.5))  # big endian
    bus.until(lambda: heard)
    assert heard == [0.5]


def test_bytes_that_are_cut_short_are_left_out_and_told_of(
    bus: Bus, one: Node, other: Node, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[str] = []
    monkeypatch.setattr(other, "write_log", lambda _, text: told.append(text))
    publisher = one.create_publisher(Odometry, name, 10)
    heard: list[float] = []
    other.create_partial_subscription(
        Odometry,
        name,
        lambda fields, _: heard.append(fields.pose.pose.position.x),
        10,
        [("pose", "pose", "position", "x")],
    )
    bus.until(publisher.get_subscription_count)
    message = Odometry()
    whole = serialize_message(message)
    publisher.publish(whole[:60])
    publisher.publish(whole[:-8])  # behind what is read
    message.pose.pose.position.x = 1.5
    publisher.publish(message)
    bus.until(lambda: heard)
    assert heard == [1.5]
    assert told == [
        f"{name}: a message was left out: 60 bytes are no nav_msgs/msg/Odometry; "
        "look at who publishes there"
    ]


def test_fields_that_cannot_be_read_alone_are_refused(one: Node, name: str) -> None:
    with pytest.raises(ValueError, match=f"{name}: Odometry cannot be read in part"):
        one.create_partial_subscription(Odometry, name, print, 10, [("pose", "pose")])


def test_a_message_of_another_type_is_refused(one: Node, name: str) -> None:
    with pytest.raises(TypeError, match="Int32"):
        one.create_publisher(Int32, name, 10).publish(String())


def test_what_a_callback_raises_is_told_and_the_next_message_comes(
    bus: Bus, one: Node, other: Node, name: str, errors: list[Exception]
) -> None:
    heard: list[int] = []

    def hear(message: Int32) -> None:
        heard.append(message.data)
        if message.data == 1:
            raise ValueError("as expected")

    publisher = one.create_publisher(Int32, name, 10)
    other.create_subscription(Int32, name, hear, 10)
    bus.until(publisher.get_subscription_count)
    bus.rest(0.1)  # what is there already when its executor finds it comes as one to rclpy
    for number in (1, 2):
        publisher.publish(Int32(data=number))
    bus.until(lambda: heard == [1, 2])
    assert [str(error) for error in errors] == ["as expected"]
    errors.clear()


def test_what_was_destroyed_hears_and_says_nothing(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    publisher = one.create_publisher(Int32, name, 10)
    gone, there = Heard(other, Int32, name, 10), Heard(one, Int32, name, 10)
    bus.until(lambda: publisher.get_subscription_count() == 2)
    bus.rest(0.1)  # its executor listens now
    bus.hold(other)
    publisher.publish(Int32(data=1))
    bus.until(lambda: there)
    bus.rest(0.1)  # it is waiting now
    assert other.destroy_subscription(gone.subscription)
    bus.go_on(other)
    bus.until(lambda: publisher.get_subscription_count() == 1)
    publisher.publish(Int32(data=2))
    bus.until(lambda: len(there) == 2)
    bus.rest(0.1)
    assert gone == [], "nor what was waiting for it"
    assert one.destroy_publisher(publisher)
    with pytest.raises(InvalidHandle):
        publisher.publish(Int32())
    bus.until(lambda: not other.get_publishers_info_by_topic(name))


def test_all_is_acknowledged_by_who_is_there(bus: Bus, one: Node, other: Node, name: str) -> None:
    publisher = one.create_publisher(Int32, name, 10)
    heard = Heard(other, Int32, name, 10)
    bus.until(publisher.get_subscription_count)
    publisher.publish(Int32())
    # DDS repeats after 3 s what a reader could not take yet that hears of its writer later.
    assert publisher.wait_for_all_acked(Duration(seconds=10.0))
    bus.until(lambda: heard)


# -- services ---------------------------------------------------------------------------------


def test_a_service_answers_each_of_its_clients(bus: Bus, one: Node, other: Node, name: str) -> None:
    def answer(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success, response.message = request.data, "heard"
        return response

    one.create_service(SetBool, name, answer)
    clients = [node.create_client(SetBool, name) for node in (one, other)]
    bus.until(lambda: all(client.service_is_ready() for client in clients))
    # The same number of each client's requests asks for something else.
    wishes = list(zip(clients * 2, (True, False, False, True), strict=True))
    calls = [client.call_async(SetBool.Request(data=data)) for client, data in wishes]
    bus.until(lambda: all(call.done() for call in calls))
    assert [call.result().success for call in calls] == [True, False, False, True]
    assert {call.result().message for call in calls} == {"heard"}


def test_a_request_before_there_is_a_server_is_lost(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    client = other.create_client(Trigger, name)
    assert not client.service_is_ready()
    lost = client.call_async(Trigger.Request())
    bus.rest(0.1)
    one.create_service(Trigger, name, lambda _, response: response)
    bus.until(client.service_is_ready)
    heard = client.call_async(Trigger.Request())
    bus.until(heard.done)
    assert not lost.done()
    client.remove_pending_request(lost)


def test_a_server_that_dies_never_answers_and_is_believed_in(bus: Bus, other: Node) -> None:
    kill = bus.dying_server()
    client = other.create_client(Trigger, "/dying")
    try:
        bus.until(client.service_is_ready, 15.0)
        # Its name comes on a topic of its own, and may come later than its service.
        bus.until(lambda: "dying_server" in node_names(other), 15.0)
        call = client.call_async(Trigger.Request())
        bus.rest(0.1)
    finally:
        kill()
    bus.rest(1.0)
    assert not call.done()
    assert client.service_is_ready(), "as DDS believes in the dead for a while"
    assert "dying_server" in node_names(other)
    bus.until(lambda: not client.service_is_ready(), 25.0)
    assert other.count_services("/dying") == 0
    other.destroy_client(client)


def test_an_answer_may_take_its_time(bus: Bus, one: Node, other: Node, name: str) -> None:
    made: list[Future] = []

    async def answer(_: Any, response: Trigger.Response) -> Trigger.Response:
        made.append(Future(executor=one.executor))
        response.message = await made[0]
        return response

    create_deferred_service(one, Trigger, name, answer)
    client = other.create_client(Trigger, name)
    bus.until(client.service_is_ready)
    call = client.call_async(Trigger.Request())
    bus.until(lambda: made)
    bus.rest(0.1)
    assert not call.done()
    made[0].set_result("at last")
    bus.until(call.done)
    assert call.result().message == "at last"


def test_what_a_service_raises_is_told_and_not_answered(
    bus: Bus, one: Node, other: Node, name: str, errors: list[Exception]
) -> None:
    def answer(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if not request.data:
            raise ValueError("as expected")
        return response

    one.create_service(SetBool, name, answer)
    client = other.create_client(SetBool, name)
    bus.until(client.service_is_ready)
    bus.rest(0.1)
    calls = [client.call_async(SetBool.Request(data=data)) for data in (False, True)]
    bus.until(calls[1].done)
    assert not calls[0].done()
    assert [str(error) for error in errors] == ["as expected"]
    errors.clear()
    client.remove_pending_request(calls[0])


def test_what_hears_of_an_answer_runs_on_the_executor(
    bus: Bus, one: Node, other: Node, name: str, errors: list[Exception]
) -> None:
    def fail(_: Future) -> None:
        raise ValueError("as expected")

    one.create_service(Trigger, name, lambda _, response: response)
    client = other.create_client(Trigger, name)
    bus.until(client.service_is_ready)
    client.call_async(Trigger.Request()).add_done_callback(fail)
    bus.until(lambda: errors)
    assert [str(error) for error in errors] == ["as expected"]
    errors.clear()


def test_a_request_of_another_type_is_refused(one: Node, name: str) -> None:
    with pytest.raises(TypeError):
        one.create_client(Trigger, name).call_async(SetBool.Request())


def test_a_service_of_another_type_is_not_found(
    bus: Bus, one: Node, other: Node, name: str
) -> None:
    one.create_service(Trigger, name, lambda _, response: response)
    client = other.create_client(SetBool, name)
    bus.until(lambda: other.count_services(name) == 1)
    bus.until(lambda: len(dict(other.get_service_names_and_types())[name]) == 2)
    assert not client.service_is_ready()
    of_node = other.get_service_names_and_types_by_node
    bus.until(lambda: _told(name, lambda: of_node("one", "/")))
    alone = dict(of_node("one", "/"))[name]
    assert alone == ["std_srvs/srv/Trigger"], "of one node, its services count alone"


# -- actions ----------------------------------------------------------------------------------


class Server:
    """An action whose goals end when the test says so."""

    def __init__(self, bus: Bus, node: Node, name: str) -> None:
        self._bus, self._node = bus, node
        self.handles: list[Any] = []
        self.ends: list[Future] = []
        self.on_goal: Any = lambda _: GoalResponse.ACCEPT
        self.on_cancel: Any = lambda _: CancelResponse.ACCEPT
        self.server = node.create_action_server(
            PlanPath,
            name,
            self._execute,
            goal_callback=lambda goal: self.on_goal(goal),
            cancel_callback=lambda handle: self.on_cancel(handle),
        )

    async def _execute(self, handle: Any) -> Any:
        self.handles.append(handle)
        self.ends.append(Future(executor=self._node.executor))
        end = await self.ends[-1]
        end(handle)
        return PlanPath.Result(message="it is over")

    def accepted(self, client: Any, **options: Any) -> Any:
        """Send a goal; the client's handle once it is executed."""
        before = len(self.handles)
        self._bus.until(client.server_is_ready)
        sent = client.send_goal_async(PlanPath.Goal(), **options)
        self._bus.until(lambda: sent.done() and len(self.handles) > before)
        assert sent.result().accepted
        return sent.result()


@pytest.fixture
def server(bus: Bus, one: Node, name: str) -> Server:
    return Server(bus, one, name)


def test_a_goal_is_followed_to_its_end(bus: Bus, other: Node, server: Server, name: str) -> None:
    client = other.create_action_client(PlanPath, name)
    feedback: list[Any] = []
    goal = server.accepted(client, feedback_callback=feedback.append)
    handle = server.handles[0]
    assert handle.is_active
    assert handle.status == GoalStatus.STATUS_EXECUTING
    assert bytes(handle.goal_id.uuid) == bytes(goal.goal_id.uuid)
    assert handle.request == PlanPath.Goal()
    handle.publish_feedback(PlanPath.Feedback())
    bus.until(lambda: feedback)
    assert bytes(feedback[0].goal_id.uuid) == bytes(goal.goal_id.uuid)
    assert feedback[0].feedback == PlanPath.Feedback()
    # A status that comes before the answer to the goal is lost; all are told again with the next.
    server.accepted(client)
    bus.until(lambda: goal.status == GoalStatus.STATUS_EXECUTING)
    server.ends[1].set_result(lambda handle: handle.succeed())
    ended = goal.get_result_async()
    bus.rest(0.05)
    assert not ended.done()
    server.ends[0].set_result(lambda handle: handle.succeed())
    bus.until(ended.done)
    assert ended.result().status == GoalStatus.STATUS_SUCCEEDED
    assert ended.result().result.message == "it is over"
    assert not handle.is_active
    bus.until(lambda: goal.status == GoalStatus.STATUS_SUCCEEDED)
    again = goal.get_result_async()
    bus.until(again.done)
    assert again.result().result.message == "it is over"


def test_a_goal_may_be_refused(bus: Bus, other: Node, server: Server, name: str) -> None:
    client = other.create_action_client(PlanPath, name)
    server.on_goal = lambda _: GoalResponse.REJECT
    bus.until(client.server_is_ready)
    sent = client.send_goal_async(PlanPath.Goal())
    bus.until(sent.done)
    assert not sent.result().accepted
    assert server.handles == []


def fail(_: Any) -> Any:
    raise ValueError("as expected")


def test_a_goal_whose_callback_raises_is_refused_and_the_next_one_taken(
    bus: Bus, other: Node, server: Server, name: str
) -> None:
    client = other.create_action_client(PlanPath, name)
    server.on_goal = fail
    bus.until(client.server_is_ready)
    sent = client.send_goal_async(PlanPath.Goal())
    bus.until(sent.done)
    assert not sent.result().accepted
    server.on_goal = lambda _: GoalResponse.ACCEPT
    assert server.accepted(client).accepted


def test_a_goal_goes_on_whose_cancel_or_feedback_callback_raises(
    bus: Bus, other: Node, server: Server, name: str
) -> None:
    client = other.create_action_client(PlanPath, name)
    heard: list[Any] = []

    def hear(message: Any) -> None:
        heard.append(message)
        fail(message)

    goal = server.accepted(client, feedback_callback=hear)
    server.on_cancel = fail
    refused = goal.cancel_goal_async()
    bus.until(refused.done)
    assert not refused.result().goals_canceling
    server.handles[0].publish_feedback(PlanPath.Feedback())
    bus.until(lambda: heard)
    ended = goal.get_result_async()
    server.ends[0].set_result(lambda handle: handle.succeed())
    bus.until(ended.done)
    assert ended.result().status == GoalStatus.STATUS_SUCCEEDED


def test_a_goal_is_cancelled_by_who_sent_it(
    bus: Bus, other: Node, server: Server, name: str
) -> None:
    client = other.create_action_client(PlanPath, name)
    goal = server.accepted(client)
    ended, handle = goal.get_result_async(), server.handles[0]
    server.on_cancel = lambda _: CancelResponse.REJECT
    refused = goal.cancel_goal_async()
    bus.until(refused.done)
    assert not refused.result().goals_canceling
    assert not handle.is_cancel_requested
    server.on_cancel = lambda _: CancelResponse.ACCEPT
    cancelled = goal.cancel_goal_async()
    bus.until(cancelled.done)
    assert [bytes(each.goal_id.uuid) for each in cancelled.result().goals_canceling] == [
        bytes(goal.goal_id.uuid)
    ]
    assert handle.is_cancel_requested
    assert handle.is_active
    server.ends[0].set_result(lambda handle: handle.canceled())
    bus.until(ended.done)
    assert ended.result().status == GoalStatus.STATUS_CANCELED


def test_all_goals_are_cancelled_by_the_name_of_the_action(
    bus: Bus, other: Node, server: Server, name: str
) -> None:
    client = other.create_action_client(PlanPath, name)
    goals = [server.accepted(client) for _ in "ab"]
    service = other.create_client(CancelGoal, f"{name}/_action/cancel_goal")
    bus.until(service.service_is_ready)

    def cancel(goal_id: UUID | None = None) -> Any:
        info = GoalInfo() if goal_id is None else GoalInfo(goal_id=goal_id)
        call = service.call_async(CancelGoal.Request(goal_info=info))
        bus.until(call.done)
        return call.result()

    answer = cancel()
    assert answer.return_code == CancelGoal.Response.ERROR_NONE
    assert len(answer.goals_canceling) == 2
    assert all(handle.is_cancel_requested for handle in server.handles)
    again = cancel()
    assert (again.return_code, list(again.goals_canceling)) == (0, [])
    assert cancel(goals[0].goal_id).return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED
    stranger = cancel(UUID(uuid=[7] * 16))
    assert stranger.return_code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID
    ends = [goal.get_result_async() for goal in goals]
    for end in server.ends:
        end.set_result(lambda handle: handle.canceled())
    bus.until(lambda: all(end.done() for end in ends))
    assert cancel(goals[0].goal_id).return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED


def test_a_goal_whose_pursuit_raises_is_aborted(
    bus: Bus, other: Node, server: Server, name: str
) -> None:
    def fail(handle: Any) -> None:
        raise ValueError("as expected")

    goal = server.accepted(other.create_action_client(PlanPath, name))
    ended = goal.get_result_async()
    server.ends[0].set_result(fail)
    bus.until(ended.done)
    assert ended.result().status == GoalStatus.STATUS_ABORTED
    assert ended.result().result == PlanPath.Result()


def test_a_goal_of_which_nobody_says_how_it_ended_is_aborted(
    bus: Bus, other: Node, server: Server, name: str
) -> None:
    goal = server.accepted(other.create_action_client(PlanPath, name))
    ended = goal.get_result_async()
    server.ends[0].set_result(lambda handle: None)
    bus.until(ended.done)
    assert ended.result().status == GoalStatus.STATUS_ABORTED
    assert ended.result().result.message == "it is over"


def test_a_goal_ends_once_and_is_canceled_only_when_that_was_asked_for(
    bus: Bus, other: Node, server: Server, name: str
) -> None:
    refused: list[str] = []

    def end(handle: Any) -> None:
        for how in ("canceled", "abort", "succeed"):
            try:
                getattr(handle, how)()
            except RCLError:
                refused.append(how)

    goal = server.accepted(other.create_action_client(PlanPath, name))
    ended = goal.get_result_async()
    server.ends[0].set_result(end)
    bus.until(ended.done)
    assert refused == ["canceled", "succeed"]
    assert ended.result().status == GoalStatus.STATUS_ABORTED


def test_statuses_of_goals_reach_late_joiners(
    bus: Bus, other: Node, server: Server, name: str
) -> None:
    goal = server.accepted(other.create_action_client(PlanPath, name))
    ended = goal.get_result_async()
    server.ends[0].set_result(lambda handle: handle.abort())
    bus.until(ended.done)
    heard = Heard(other, GoalStatusArray, f"{name}/_action/status", qos(1, durability=LATCHED))
    bus.until(lambda: heard)
    [status] = heard[-1].status_list
    assert status.status == GoalStatus.STATUS_ABORTED
    assert bytes(status.goal_info.goal_id.uuid) == bytes(goal.goal_id.uuid)
    assert status.goal_info.stamp.sec > 0


def test_an_action_is_found_by_name_and_by_node(
    bus: Bus, one: Node, other: Node, server: Server, name: str
) -> None:
    found = (name, ["kompass_interfaces/action/PlanPath"])
    bus.until(lambda: found in map(_plain, other.get_action_names_and_types()))
    of_node = other.get_action_server_names_and_types_by_node
    bus.until(lambda: _told(name, lambda: of_node("one", "/")))
    assert found in map(_plain, of_node("one", "/"))
    assert found not in map(_plain, of_node("other", "/robot"))
    client = other.create_action_client(PlanPath, name)
    bus.until(client.server_is_ready)
    server.server.destroy()
    bus.until(lambda: not client.server_is_ready())
    client.destroy()
    with pytest.raises(NodeNameNonExistentError):
        of_node("nobody", "/")


def _told(name: str, ask: Callable[[], Iterable[Any]]) -> bool:
    """Whether the graph says so of a node; it learns of nodes apart from what there is of them."""
    try:
        return name in dict(ask())
    except (NodeNameNonExistentError, RCLError):
        return False


def _plain(found: Any) -> tuple[str, list[str]]:
    name, types = found
    return name, list(types)


# -- time -------------------------------------------------------------------------------------


def test_a_timer_calls_until_it_is_cancelled_and_again_after_a_reset(bus: Bus, one: Node) -> None:
    calls: list[float] = []
    timer = one.create_timer(0.05, lambda: calls.append(one.clock.monotonic()))
    begun = one.clock.monotonic()
    bus.until(lambda: len(calls) == 3)
    assert calls[0] - begun >= 0.045
    timer.cancel()
    assert timer.is_canceled()
    bus.rest(0.2)
    assert len(calls) == 3
    timer.reset()
    assert not timer.is_canceled()
    begun = one.clock.monotonic()
    bus.until(lambda: len(calls) == 4)
    assert calls[3] - begun >= 0.045
    assert one.destroy_timer(timer)
    bus.rest(0.2)
    assert len(calls) == 4


def test_a_timer_that_is_due_may_still_be_cancelled_or_put_off(bus: Bus, one: Node) -> None:
    calls: list[str] = []
    cancelled = one.create_timer(0.1, lambda: calls.append("cancelled"))
    put_off = one.create_timer(0.1, lambda: calls.append("put off"))
    bus.hold(one)
    bus.rest(0.15)
    cancelled.cancel()
    put_off.reset()
    bus.go_on(one)
    bus.rest(0.06)
    assert calls == []
    bus.until(lambda: calls == ["put off"])
    one.destroy_timer(cancelled)
    one.destroy_timer(put_off)


def test_periods_that_were_missed_are_made_up_for_by_one_call(bus: Bus, one: Node) -> None:
    calls: list[float] = []
    timer = one.create_timer(0.2, lambda: calls.append(one.clock.monotonic()))
    bus.until(lambda: calls)
    bus.hold(one)
    bus.rest(0.9)
    bus.go_on(one)
    bus.until(lambda: len(calls) == 3)
    one.destroy_timer(timer)
    held, after = calls[1] - calls[0], calls[2] - calls[1]
    assert held >= 0.85
    assert 0.01 < after < 0.19, "the next comes when it would have come"


def test_what_a_timer_raises_is_told_and_it_goes_on(
    bus: Bus, one: Node, errors: list[Exception]
) -> None:
    def fail() -> None:
        raise ValueError("as expected")

    timer = one.create_timer(0.02, fail)
    bus.until(lambda: len(errors) >= 2)
    one.destroy_timer(timer)
    assert {str(error) for error in errors} == {"as expected"}
    errors.clear()


def test_timers_of_the_executor_fire_when_they_are_due(bus: Bus, one: Node) -> None:
    fired: list[str] = []
    timers = Timers(one)

    def begin() -> None:
        timers.after(0.1, lambda: fired.append("later"))
        timers.after(0.02, lambda: fired.append("sooner"))
        timers.after(0.05, lambda: fired.append("never")).cancel()

    one.executor.create_task(begin)
    bus.until(lambda: len(fired) == 2)
    assert fired == ["sooner", "later"]


def test_time_goes_on_and_headers_have_that_of_the_wall(bus: Bus, one: Node) -> None:
    monotonic, wall = one.clock.monotonic(), one.clock.wall()
    stamp = one.get_clock().now().to_msg()
    assert abs(stamp.sec + stamp.nanosec * 1e-9 - wall) < 1.0
    bus.rest(0.2)
    assert one.clock.monotonic() - monotonic >= 0.19
    assert one.clock.wall() - wall >= 0.19
    assert abs(one.clock.monotonic_ns() * 1e-9 - one.clock.monotonic()) < 1.0


# -- tasks ------------------------------------------------------------------------------------


def test_functions_and_coroutines_run_on_the_executor(bus: Bus, one: Node) -> None:
    awaited = Future(executor=one.executor)

    async def wait(more: int) -> int:
        return int(await awaited) + more

    async def outer() -> int:
        inner: int = await one.executor.create_task(wait, 2)
        return inner + 10

    results = [
        one.executor.create_task(lambda a, b: a + b, 1, b=2),
        one.executor.create_task(wait, more=1),
        one.executor.create_task(wait(5)),
        one.executor.create_task(outer),
    ]
    bus.until(results[0].done)
    bus.rest(0.02)
    assert [result.done() for result in results] == [True, False, False, False]
    awaited.set_result(40)
    bus.until(lambda: all(result.done() for result in results))
    assert [result.result() for result in results] == [3, 41, 45, 52]


def test_what_a_function_raises_is_told_and_of_a_coroutine_where_it_is_awaited(
    bus: Bus, one: Node, errors: list[Exception]
) -> None:
    def fail() -> None:
        raise ValueError("of a function")

    async def fail_later() -> None:
        raise ValueError("of a coroutine")

    function, coroutine = one.executor.create_task(fail), one.executor.create_task(fail_later)
    bus.until(lambda: function.done() and coroutine.done())
    assert str(function.exception()) == "of a function"
    assert str(coroutine.exception()) == "of a coroutine"
    bus.until(lambda: errors)
    assert [str(error) for error in errors] == ["of a function"]
    errors.clear()


def test_threads_hand_back_what_came_of_it(bus: Bus, one: Node) -> None:
    threads = one.threads(2, "helpers")
    done: list[str] = []
    good = threads.submit(lambda text: text.upper(), "made")
    good.add_done_callback(lambda made: one.executor.create_task(done.append, made.result()))
    bad = threads.submit(lambda: 1 // 0)
    bus.until(lambda: done and bad.done())
    assert done == ["MADE"]
    assert isinstance(bad.exception(), ZeroDivisionError)
    threads.shutdown()
    with pytest.raises(RuntimeError, match="shutdown"):
        threads.submit(print)


# -- the life cycle ---------------------------------------------------------------------------


class Part:
    """A component that fails at what it is told to fail at."""

    def __init__(self) -> None:
        self.failing: set[str] = set()
        self.done: list[str] = []
        self.told: list[tuple[str, str]] = []
        self.node: LifecycleNode | None = None
        self.states: list[str] = []

    def _do(self, what: str) -> None:
        assert self.node is not None
        self.states.append(self.node.state)
        if what in self.failing:
            raise ValueError(f"{what} fails")
        self.done.append(what)

    def on_configure(self) -> None:
        self._do("configure")

    def on_activate(self) -> None:
        self._do("activate")

    def on_deactivate(self) -> None:
        self._do("deactivate")

    def on_cleanup(self) -> None:
        self._do("cleanup")

    def on_shutdown(self) -> None:
        self._do("shutdown")

    def on_callback_error(self, error: Exception) -> None:
        self.told.append(("callback", str(error)))

    def on_transition_error(self, transition: str, error: Exception) -> None:
        if "telling" in self.failing:
            raise ValueError("telling fails")
        self.told.append((transition, str(error)))


@pytest.fixture
def part(bus: Bus) -> Part:
    part = Part()
    part.node = bus.lifecycle(f"part_{next(_numbers)}", part)
    return part


def test_a_life_from_unconfigured_to_finalized(part: Part) -> None:
    node = part.node
    assert node is not None
    success = TransitionCallbackReturn.SUCCESS
    assert (node.state, node.state_id) == ("unconfigured", 1)
    for trigger, state, number in (
        (node.trigger_configure, "inactive", 2),
        (node.trigger_activate, "active", 3),
        (node.trigger_deactivate, "inactive", 2),
        (node.trigger_cleanup, "unconfigured", 1),
        (node.trigger_configure, "inactive", 2),
        (node.trigger_shutdown, "finalized", 4),
    ):
        assert trigger() == success
        assert (node.state, node.state_id) == (state, number)
    assert part.done == [
        "configure", "activate", "deactivate", "cleanup", "configure", "shutdown"
    ]  # fmt: skip
    assert part.states == [
        "configuring", "activating", "deactivating", "cleaningup", "configuring", "shuttingdown"
    ]  # fmt: skip
    with pytest.raises(RCLError):
        node.trigger_shutdown()


def test_a_transition_that_raises_fails_and_leaves_the_state(part: Part) -> None:
    node = part.node
    assert node is not None
    failure = TransitionCallbackReturn.FAILURE
    part.failing = {"configure", "activate", "deactivate", "cleanup", "shutdown"}
    for trigger, what, state in (
        (node.trigger_configure, "configure", "unconfigured"),
        (node.trigger_activate, "activate", "inactive"),
        (node.trigger_cleanup, "cleanup", "inactive"),
        (node.trigger_deactivate, "deactivate", "active"),
        (node.trigger_shutdown, "shutdown", "finalized"),
    ):
        assert trigger() == failure
        assert part.told[-1] == (what, f"{what} fails")
        assert node.state == state
        part.failing.discard(what)
        if what in ("configure", "activate") and state != "finalized":
            if what == "activate":
                continue
            trigger()
        if what == "cleanup":
            node.trigger_activate()


def test_a_transition_whose_failure_cannot_be_told_begins_anew(part: Part) -> None:
    node = part.node
    assert node is not None
    part.failing = {"configure", "telling"}
    assert node.trigger_configure() == TransitionCallbackReturn.ERROR
    assert node.state == "unconfigured"


def test_a_transition_that_does_not_begin_here_is_refused(part: Part) -> None:
    node = part.node
    assert node is not None
    for trigger in (node.trigger_activate, node.trigger_deactivate, node.trigger_cleanup):
        with pytest.raises(RCLError):
            trigger()
    assert node.state == "unconfigured"
    assert part.done == []


def test_services_carry_out_transitions_and_tell_states(
    bus: Bus, other: Node, part: Part, errors: list[Exception]
) -> None:
    node = part.node
    assert node is not None
    name = node.get_name()
    heard = Heard(other, TransitionEvent, f"/{name}/transition_event", 10)

    def ask(kind: Any, service: str, **fields: Any) -> Any:
        client = other.create_client(kind, f"/{name}/{service}")
        bus.until(client.service_is_ready)
        call = client.call_async(kind.Request(**fields))
        bus.until(lambda: call.done() or errors)
        other.destroy_client(client)
        return call.result() if call.done() else None

    def change(number: int, label: str = "") -> bool:
        transition = Transition(id=number, label=label)
        return bool(ask(ChangeState, "change_state", transition=transition).success)

    assert change(Transition.TRANSITION_CONFIGURE)
    bus.until(lambda: len(heard) == 2)
    assert [(each.start_state.label, each.goal_state.label) for each in heard] == [
        ("unconfigured", "configuring"),
        ("configuring", "inactive"),
    ]
    assert [each.transition.label for each in heard] == ["", ""]
    assert change(0, "activate")
    state = ask(GetState, "get_state").current_state
    assert (state.id, state.label) == (3, "active")
    assert not change(0, "activate")
    part.failing = {"deactivate"}
    assert not change(Transition.TRANSITION_DEACTIVATE)
    assert node.state == "active"
    states = ask(GetAvailableStates, "get_available_states").available_states
    assert [(each.id, each.label) for each in states][:5] == [
        (0, "unknown"), (1, "unconfigured"), (2, "inactive"), (3, "active"), (4, "finalized")
    ]  # fmt: skip
    assert [each.label for each in states][5:] == [
        "configuring", "cleaningup", "shuttingdown", "activating", "deactivating", "errorprocessing"
    ]  # fmt: skip
    there = ask(GetAvailableTransitions, "get_available_transitions").available_transitions
    assert [(t.transition.id, t.transition.label, t.goal_state.label) for t in there] == [
        (4, "deactivate", "deactivating"),
        (7, "shutdown", "shuttingdown"),
    ]
    graph = ask(GetAvailableTransitions, "get_transition_graph").available_transitions
    assert len(graph) == 25
    assert errors == []
    unknown = ask(ChangeState, "change_state", transition=Transition(id=99))
    assert unknown is None, "rclpy raises, and does not answer"
    assert [type(error) for error in errors] == [RCLError]
    errors.clear()


def test_what_guards_transitions_is_asked_first(bus: Bus, other: Node, part: Part) -> None:
    node = part.node
    assert node is not None
    asked: list[int] = []

    def guard(answer: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        def guarded(request: Any, response: Any) -> Any:
            asked.append(request.transition.id)
            if len(asked) == 1:
                response.success = False
                return response
            return answer(request, response)

        return guarded

    node.guard_transitions(guard)
    client = other.create_client(ChangeState, f"/{node.get_name()}/change_state")
    bus.until(client.service_is_ready)
    for expected in ("unconfigured", "inactive"):
        call = client.call_async(ChangeState.Request(transition=Transition(id=1)))
        bus.until(call.done)
        assert node.state == expected
    assert asked == [1, 1]
    other.destroy_client(client)


# -- the graph --------------------------------------------------------------------------------


def test_names_are_resolved_by_node_and_namespace(one: Node, other: Node) -> None:
    assert (one.get_name(), one.get_namespace()) == ("one", "/")
    assert (other.get_name(), other.get_namespace()) == ("other", "/robot")
    assert [other.resolve_topic_name(n) for n in ("a", "/a", "~/a")] == [
        "/robot/a", "/a", "/robot/other/a"
    ]  # fmt: skip
    assert other.resolve_service_name("b") == "/robot/b"
    assert one.resolve_topic_name("~/a") == "/one/a"
    assert (one.get_logger().name, other.get_logger().name) == ("one", "robot.other")
    with pytest.raises(InvalidTopicNameException):
        one.create_publisher(Int32, "not a name", 10)


def test_the_graph_tells_who_offers_what(bus: Bus, one: Node, other: Node, name: str) -> None:
    profile = qos(4, BEST_EFFORT, LATCHED)
    publisher = one.create_publisher(Int32, name, profile)
    second = other.create_publisher(Int32, name, 10)
    heard = Heard(one, Int32, name, qos(5, BEST_EFFORT))
    one.create_service(Trigger, f"{name}/ask", lambda _, response: response)
    # What a node is called arrives after its publishers and subscriptions.
    bus.until(lambda: _nodes(other.get_publishers_info_by_topic(name)) == ["one", "other"])
    bus.until(lambda: other.count_services(f"{name}/ask") == 1)
    infos = {info.node_name: info for info in other.get_publishers_info_by_topic(name)}
    info = infos["one"]
    assert (info.node_namespace, info.topic_type) == ("/", "std_msgs/msg/Int32")
    assert infos["other"].node_namespace == "/robot"
    assert info.qos_profile.reliability == BEST_EFFORT
    assert info.qos_profile.durability == LATCHED
    assert infos["other"].qos_profile.reliability == RELIABLE
    bus.until(lambda: _nodes(other.get_subscriptions_info_by_topic(name)) == ["one"])
    [listener] = other.get_subscriptions_info_by_topic(name)
    assert listener.topic_type == "std_msgs/msg/Int32"
    assert other.count_subscribers(name) == 1
    ids = [bytes(each.endpoint_gid) for each in (info, listener, infos["other"])]
    assert ids[0][:12] == ids[1][:12] != ids[2][:12], "the first 12 bytes name the process"
    assert len(set(ids)) == 3
    assert dict(other.get_topic_names_and_types())[name] == ["std_msgs/msg/Int32"]
    of_node = other.get_service_names_and_types_by_node
    bus.until(lambda: _told(f"{name}/ask", lambda: of_node("one", "/")))
    assert dict(of_node("one", "/"))[f"{name}/ask"] == ["std_srvs/srv/Trigger"]
    assert f"{name}/ask" not in dict(of_node("other", "/robot"))
    with pytest.raises(NodeNameNonExistentError):
        of_node("nobody", "/")
    bus.until(lambda: ("other", "/robot") in one.get_node_names_and_namespaces())
    assert ("one", "/") in one.get_node_names_and_namespaces()
    one.destroy_publisher(publisher)
    other.destroy_publisher(second)
    one.destroy_subscription(heard.subscription)
    bus.until(lambda: name not in dict(other.get_topic_names_and_types()))


def _nodes(infos: Iterable[Any]) -> list[str]:
    """Names of the nodes that publishers or subscriptions are of."""
    return sorted(info.node_name for info in infos)


def test_a_node_that_is_destroyed_leaves_nothing(bus: Bus, one: Node, name: str) -> None:
    node = bus.node("short_lived")
    heard = Heard(node, Int32, name, 10)
    node.create_service(Trigger, name, lambda _, response: response)
    publisher = one.create_publisher(Int32, name, 10)
    bus.until(publisher.get_subscription_count)
    bus.until(lambda: one.count_services(name) == 1)
    node.destroy_node()
    bus.until(lambda: one.count_services(name) == 0)
    bus.until(lambda: not publisher.get_subscription_count())
    publisher.publish(Int32())
    bus.rest(0.1)
    assert heard == []
    names = one.get_node_names_and_namespaces
    bus.until(lambda: "short_lived" not in [each for each, _ in names()])
