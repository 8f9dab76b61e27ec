"""The rules of a running robot are edited as one edits them on a running robot: nothing is lost."""

import json
import os
import signal as signals
import statistics
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from kompass_interfaces.srv import ApplyRules, ExplainRule, GetRules
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from std_msgs.msg import Bool, Int32, String

from kompass.rules.schema.table import Table
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot
from tests.support.rules import Rules, compare, rule, signal
from tests.support.stack import Stack

pytestmark = pytest.mark.ros
LAB = Path(__file__).parents[1] / "recipes" / "rules_lab.py"
RELIABLE = QoSProfile(depth=5000, reliability=ReliabilityPolicy.RELIABLE)
Request = ApplyRules.Request


def await_listener(robot: Robot, publisher: Any) -> None:
    """Wait until the monitor listens, and does so reliably, as the publisher does."""
    topic = publisher.topic_name

    def reliable() -> bool:
        readers = robot.node.get_subscriptions_info_by_topic(topic)
        monitors = [each for each in readers if each.node_name == "monitor"]
        wanted = ReliabilityPolicy.RELIABLE
        return any(each.qos_profile.reliability == wanted for each in monitors)

    wait_until(reliable, 10, f"a reliable listener to {topic}")
    wait_until(lambda: publisher.get_subscription_count() == 1, 10, "the end of the first one")


class Stream:
    """Publishes 1, 2, 3 … on a topic, a thousand times a second, until it is left."""

    def __init__(self, robot: Robot, topic: str, period: float = 0.001) -> None:
        self.sent = 0
        self._period = period
        self._robot = robot
        self._publisher = robot.node.create_publisher(Int32, topic, RELIABLE)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def __enter__(self) -> "Stream":
        await_listener(self._robot, self._publisher)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _run(self) -> None:
        begun = time.monotonic()
        while not self._ended.is_set():
            self.sent += 1
            self._publisher.publish(Int32(data=self.sent))
            time.sleep(max(0.0, begun + self.sent * self._period - time.monotonic()))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("lab")


@pytest.fixture(scope="module")
def stack(folder: Path) -> Iterator[Stack]:
    with closing(Stack.active(LAB, LAB_FOLDER=str(folder), KOMPASS_ROBOT_NAME="lab")) as running:
        yield running


@pytest.fixture(scope="module")
def robot(stack: Stack) -> Iterator[Robot]:
    with closing(Robot(stack.domain)) as client:
        yield client


@pytest.fixture(scope="module")
def rules(robot: Robot) -> Rules:
    return Rules(robot)


def say(robot: Robot, kind: Any, topic: str, data: Any) -> None:
    """Publish one message, once the monitor listens."""
    # Left to the end: destroyed under the executor that spins the node, it would end that thread.
    publisher = robot.node.create_publisher(kind, topic, RELIABLE)
    await_listener(robot, publisher)
    publisher.publish(kind(data=data))
    wait_until(lambda: publisher.wait_for_all_acked(), 5, "the message's arrival")


def in_force(rules: Rules) -> tuple[int, int, Table]:
    view = rules.view()
    return view.revision, view.confirmed, view.table


def lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


def phases(rules: Rules, rule_id: str, phase: str) -> int:
    return sum(f.rule_id == rule_id and f.phase == phase for f in rules.firings)


def fired(rules: Rules, rule_id: str) -> list[Any]:
    return [f for f in rules.firings if f.rule_id == rule_id and f.phase == "fired"]


def test_a_message_that_is_cut_short_takes_no_rules_away(
    stack: Stack, robot: Robot, rules: Rules
) -> None:
    rules.add(rule("cut", compare("cut", "==", 7)))
    monitor = stack.pid_of("monitor")
    numbers = robot.node.create_publisher(Int32, "/cut", RELIABLE)
    await_listener(robot, numbers)
    whole = serialize_message(Int32(data=7))
    numbers.publish(whole[:4])
    numbers.publish(whole)
    wait_until(lambda: fired(rules, "cut"), 5, "the firing by the whole message")
    told = "/cut: a message was left out: 4 bytes are no std_msgs/msg/Int32"
    wait_until(lambda: told in stack.output, 5, "a word on the one that was cut")
    assert stack.pid_of("monitor") == monitor


def test_a_rule_added_while_messages_rain_down_is_effective_within_50_ms(
    robot: Robot, rules: Rules
) -> None:
    rules.add(rule("rain-never", compare("rain", "<", 0)))
    delays = []
    with Stream(robot, "/rain"):
        for number in range(10):
            table, revision = rules.rules(), rules.view().revision
            new = rule(f"rain-{number}", compare("rain", ">", 0), cooldown=100.0)
            begun = time.monotonic()
            rules.begin_apply([*table, new], revision)
            wait_until(lambda: fired(rules, f"rain-{number}"), 5, "its firing")  # noqa: B023
            at = next(
                when
                for when, f in zip(rules.arrived, rules.firings, strict=False)
                if f.rule_id == f"rain-{number}"
            )
            delays.append(at - begun)

    # The best of ten: the machine of a test may be busy with something else.
    assert min(delays) < patient(0.05)
    rules.remove("rain-never", *(f"rain-{number}" for number in range(10)))


def test_swaps_under_load_neither_miss_nor_double_a_message(robot: Robot, rules: Rules) -> None:
    every = {"kind": "changed", "signal": signal("flood")}
    rules.add(rule("every", every, cooldown=1000.0), rule("other", compare("flood", "<", -1)))
    table, revision = rules.rules(), rules.view().revision
    pauses = []
    with Stream(robot, "/flood") as stream:
        for number in range(30):
            table[-1] = rule("other", compare("flood", "<", -2 - number))
            answer = rules.apply(table, revision)
            assert answer.outcome == Request.APPLIED, answer.message
            report = json.loads(answer.answer)
            assert report["effect"]["reset"] == ["other"]
            assert "every" in report["effect"]["carried"]
            revision = answer.revision
            pauses.append(report["pause"])
    wait_until(lambda: rules.status("every").evaluated >= stream.sent, 10, "the last message")
    found = rules.status("every")
    # A message that is missed is not counted; one that is taken twice changes nothing.
    assert (found.evaluated, found.true) == (stream.sent, stream.sent - 1)

    assert statistics.median(pauses) < patient(0.001)
    rules.remove("every", "other")


def test_of_messages_that_a_rule_publishes_once_none_is_lost(robot: Robot, rules: Rules) -> None:
    heard: list[int] = []
    robot.node.create_subscription(
        Int32, "/answer", lambda message: heard.append(message.data), RELIABLE
    )
    answer = {"kind": "publish", "topic": "answer", "type": "std_msgs/msg/Int32"}
    publisher = robot.node.create_publisher(Int32, "/asked", RELIABLE)
    told: list[str] = []
    for round_ in range(5):
        # Each time the publisher of the rule is another, and the first message its first.
        name = f"shot-{round_}"
        condition = {"kind": "received", "signal": signal("asked")}
        rules.add(rule(name, condition, answer | {"message": {"data": "$msg.data"}}))
        await_listener(robot, publisher)
        for number in range(20):
            publisher.publish(Int32(data=20 * round_ + number))
            wait_until(lambda: phases(rules, name, "action") > number, 5, "its answer")  # noqa: B023
        told += [f.text for f in rules.firings if (f.rule_id, f.phase) == (name, "action")]
        rules.remove(name)
    wait_until(lambda: len(heard) >= 100, 5, "the last answer")
    assert heard == list(range(100))
    assert told == ["published to 1 listener"] * 100


def test_a_byte_or_a_number_that_does_not_fit_is_refused_when_it_is_checked(rules: Rules) -> None:
    publish = {"kind": "publish", "topic": "answer", "type": "std_msgs/msg/UInt8"}
    wrong = rule("wrong", compare("a", ">", 1), publish | {"message": {"data": 300}})
    answer = rules.apply([*rules.rules(), wrong], rules.view().revision)
    assert answer.outcome != Request.APPLIED
    for word in ("wrong", "actions[0].message.data", "uint8: 0 to 255"):
        assert word in answer.message


def test_an_emergency_is_answered_while_twelve_slow_rules_run(
    robot: Robot, rules: Rules, folder: Path
) -> None:
    publisher = robot.node.create_publisher(Bool, "/emergency", RELIABLE)
    await_listener(robot, publisher)
    notes = folder / "emergency"
    slow = [f"slow-{number}" for number in range(12)]
    say(robot, Bool, "/slow", True)
    wait_until(lambda: all(fired(rules, rule_id) for rule_id in slow), 5, "the slow rules")
    delays: list[float] = []
    over: list[str] = []
    while len(delays) < 5 and not over:
        begun = time.monotonic()
        publisher.publish(Bool(data=True))
        wait_until(lambda: len(lines(notes)) > len(delays), 2, "the emergency's action")
        delays.append(float(lines(notes)[-1]) - begun)
        # What comes before the run is known to have ended is dropped, as the mode says.
        wait_until(lambda: phases(rules, "emergency", "done") == len(delays), 5, "its end")
        over = [f.rule_id for f in rules.firings if f.rule_id in slow and f.phase == "done"]
    assert min(delays) < patient(0.02)


def test_of_two_writers_one_wins_and_the_other_sees_both_diffs(rules: Rules) -> None:
    table, revision = rules.rules(), rules.view().revision
    mine = [*table, rule("mine", compare("a", ">", 1))]
    yours = [*table, rule("yours", compare("a", ">", 2))]
    first, second = rules.begin_apply(mine, revision), rules.begin_apply(yours, revision)
    answers = [rules.robot.await_future(each, 10, "an answer") for each in (first, second)]
    assert sorted(each.outcome for each in answers) == [Request.APPLIED, Request.CONFLICT]
    lost = next(each for each in answers if each.outcome == Request.CONFLICT)
    conflict = json.loads(lost.answer)
    changed = {
        side: [change["rule_id"] for change in conflict[side]["changes"]]
        for side in ("theirs", "yours")
    }
    assert sorted([changed["theirs"], changed["yours"]]) == [["mine"], ["yours"]]
    assert conflict["author"] == "tester"
    present = {each["id"] for each in rules.rules()} & {"mine", "yours"}
    assert len(present) == 1
    rules.remove("mine", "yours")


def test_what_nobody_confirms_is_taken_back_and_says_so(rules: Rules) -> None:
    before = rules.view()
    new = [*rules.rules(), rule("doubtful", compare("a", ">", 1))]
    revision = rules.must_apply(new, probation=0.7)
    assert rules.view().confirmed == before.revision
    assert 0 < rules.view().probation_left <= 0.7
    wait_until(lambda: rules.view().revision > revision, 5, "the end of the probation")
    now = rules.view()
    assert now.table == before.table
    assert (now.confirmed, now.probation_left) == (now.revision, 0.0)
    assert f"revision {revision} was taken back" in now.notice
    wait_until(lambda: rules.state.revision == now.revision, 5, "the new state")
    assert rules.state.notice == now.notice
    assert any(now.notice == each.text for each in rules.journal())
    newest = rules.history().revisions[:2]
    assert [each.origin for each in newest] == ["taken back", "edit"]
    assert newest[1].outcome == "taken back"


def test_what_is_confirmed_stays_and_can_be_rolled_back(rules: Rules) -> None:
    before = rules.view()
    probation = patient(0.7)
    new = [*rules.rules(), rule("kept", compare("a", ">", 1))]
    revision = rules.must_apply(new, probation=probation)
    assert not rules.confirm(revision, role="viewer").success
    assert rules.confirm(revision).success
    time.sleep(probation)  # nothing happens: there is nothing else to wait for
    assert rules.view().revision == revision
    assert rules.roll_back(role="viewer").outcome == Request.REFUSED
    answer = rules.roll_back()
    assert answer.outcome == Request.APPLIED, answer.message
    now = rules.view()
    assert now.table == before.table
    assert now.confirmed == now.revision == revision + 1


def test_actions_of_a_rule_that_goes_are_cancelled_or_left_as_asked(
    robot: Robot, rules: Rules
) -> None:
    heard: list[str] = []
    robot.node.create_subscription(String, "/chatter", lambda m: heard.append(m.data), 10)
    talk = {
        "kind": "publish",
        "topic": "chatter",
        "type": "std_msgs/msg/String",
        "message": {"data": "still here"},
        "rate": 50.0,
        "timeout": None,
    }
    rules.add(rule("talk", compare("begin", "==", True, type_name="Bool"), talk, trigger="edge"))
    say(robot, Bool, "/begin", True)
    wait_until(lambda: len(heard) > 5, 5, "the chatter")
    kept = [each for each in rules.rules() if each["id"] != "talk"]
    report = json.loads(rules.check(json.dumps({"rules": kept})).answer)
    assert report["effect"]["running"] == ["talk"]
    rules.must_apply(kept)
    count = len(heard)
    wait_until(lambda: len(heard) > count + 5, 5, "the chatter to go on")
    # Put back, it is another rule; the old run ends with it when that is asked for.
    rules.add(rule("talk", compare("begin", "==", True, type_name="Bool"), talk, trigger="edge"))
    assert rules.roll_back(cancel_running=True).outcome == Request.APPLIED
    rules.add(rule("talk", compare("begin", "==", False, type_name="Bool"), talk, trigger="edge"))
    say(robot, Bool, "/begin", False)
    wait_until(lambda: rules.status("talk").state == "running", 5, "the second run")
    rules.remove("talk", cancel_running=True)
    entry = rules.journal("talk")[0]
    wait_until(lambda: rules.journal("talk")[0].ended is not None, 5, "the end of the run")
    entry = rules.journal("talk")[0]
    assert entry.ok is False
    assert "cancelled: tester put revision" in entry.error


def test_a_shadow_is_recorded_and_does_not_act(robot: Robot, rules: Rules, folder: Path) -> None:
    call = {"kind": "method", "component": "lamp", "method": "switch", "kwargs": {"on": True}}
    rules.add(
        rule("dark", compare("dusk", ">", 0), call, trigger="edge", shadow=True),
        rule("light", compare("dawn", ">", 0), call, trigger="edge"),
    )
    say(robot, Int32, "/dusk", 1)
    wait_until(lambda: rules.journal("dark"), 5, "the shadow's entry")
    assert rules.journal("dark")[0].kind == "shadow"
    assert not (folder / "lamp").exists()
    say(robot, Int32, "/dawn", 1)
    wait_until(lambda: (folder / "lamp").exists(), 5, "the lamp")
    entry = rules.journal("light")[0]
    wait_until(lambda: rules.journal("light")[0].ok, 5, "the end of the run")
    entry = rules.journal("light")[0]
    assert [each.action for each in entry.actions] == ["lamp.switch"]
    then = rules.explain("light", entry.run_id, entry.epoch)
    assert [(leaf.text, leaf.value, leaf.verdict) for leaf in then.leaves] == [
        ("dawn.data > 0", 1, True)
    ]
    assert then.firing is not None
    assert then.firing.message == {"data": 1}
    rules.remove("dark", "light")


def test_the_more_severe_rule_gets_its_component(robot: Robot, rules: Rules) -> None:
    def shine(colour: str) -> dict[str, Any]:
        kwargs = {"on": True, "colour": colour}
        return {"kind": "method", "component": "lamp", "method": "switch", "kwargs": kwargs}

    rules.add(
        rule("calm", compare("quarrel", ">", 0), shine("green"), trigger="edge", severity="info"),
        rule("stern", compare("quarrel", ">", 0), shine("red"), trigger="edge", severity="error"),
    )
    say(robot, Int32, "/quarrel", 1)
    wait_until(lambda: rules.journal("calm"), 5, "the loser's entry")
    lost = rules.journal("calm")[0]
    assert lost.kind == "outranked"
    assert lost.text == "the more severe rule 'stern' has lamp"
    assert rules.status("calm").outranked == 1
    wait_until(lambda: rules.journal("stern")[0].ok, 5, "the winner's end")
    rules.remove("calm", "stern")


def test_alarms_are_shown_until_they_are_cleared(robot: Robot, rules: Rules) -> None:
    robot.subscribe(String, "/monitor/alarms", LATCHED)
    bell = {"kind": "raise_alarm", "alarm": "bell", "text": "somebody is at the door"}
    rules.add(
        rule("ring", compare("door", ">", 0), bell, trigger="edge"),
        rule("hush", compare("door", "<", 0), {"kind": "clear_alarm", "alarm": "bell"}),
    )

    def alarms() -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = json.loads(robot.newest["/monitor/alarms"].data)
        return found

    wait_until(lambda: "/monitor/alarms" in robot.newest, 5, "the list of alarms")
    assert alarms() == []
    say(robot, Int32, "/door", 1)
    wait_until(alarms, 5, "the alarm")
    assert (alarms()[0]["text"], alarms()[0]["rule_id"]) == ("somebody is at the door", "ring")
    say(robot, Int32, "/door", -1)
    wait_until(lambda: not alarms(), 5, "the end of the alarm")
    rules.remove("ring", "hush")


WRONG = (
    ("", "not JSON"),
    ("[1, 2", "not JSON"),
    ("{}" * 1_500_000, "more than"),
    ('{"rules": "all"}', "rules"),
    ('{"rules": [{"id": "a"}]}', "event"),
    (json.dumps({"rules": [rule(f"r{n}", compare("a", ">", n)) for n in range(10_000)]}), "more"),
    (json.dumps({"rules": [rule("x", compare("a", ">", 1, path="dta"))]}), "did you mean 'data'"),
    (json.dumps({"rules": [rule("x", compare("a", ">", "one"))]}), "integer"),
    (json.dumps({"rules": [rule("x", compare("a-b", ">", 1))]}), "must not contain"),
    (json.dumps({"rules": [rule("x", compare("a", ">", 1, type_name="Imt32"))]}), "no such"),
    (
        json.dumps(
            {
                "rules": [
                    rule(
                        "x",
                        compare("a", ">", 1),
                        {"kind": "method", "component": "lamp", "method": "swich", "kwargs": {}},
                    )
                ]
            }
        ),
        "switch",
    ),
)


@pytest.mark.parametrize(("text", "word"), WRONG, ids=range(len(WRONG)))
def test_what_is_no_table_is_refused_with_a_reason(rules: Rules, text: str, word: str) -> None:
    before = in_force(rules)
    request = {"role": "operator", "author": "tester", "expected_revision": before[0]}
    answer = rules.call(ApplyRules.Request(table=text, **request))
    assert answer.outcome == Request.REFUSED
    assert word in answer.message
    report = json.loads(answer.answer)
    assert report["ok"] is False
    assert any(finding["level"] == "error" and finding["remedy"] for finding in report["findings"])
    assert in_force(rules) == before


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(
                ["rules", "id", "event", "actions", "kind", "condition", "signal", "x"]
            ),
            inner,
            max_size=4,
        )
    ),
    max_leaves=20,
)


def is_table(text: str) -> bool:
    try:
        Table.model_validate_json(text)
    except ValueError:
        return False
    return True


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    data=JSON | st.text(max_size=30),
    role=st.sampled_from(["operator", "", "viewer", "x" * 10]),
    probation=st.floats(),
    expected=st.integers(0, 2**32 - 1),
    names=st.lists(st.text(max_size=5), max_size=3),
)
def test_the_services_answer_whatever_they_are_sent(
    rules: Rules, data: Any, role: str, probation: float, expected: int, names: list[str]
) -> None:
    before = in_force(rules)
    text = data if isinstance(data, str) else json.dumps(data)
    text = text.encode(errors="replace").decode().replace("\0", "")
    names = [name.encode(errors="replace").decode().replace("\0", "") for name in names]
    assume(not is_table(text))
    answer = rules.call(
        ApplyRules.Request(
            table=text, role=role, probation=probation, expected_revision=expected, reset=names
        )
    )
    assert answer.outcome in (Request.REFUSED, Request.CONFLICT)
    assert answer.message
    assert not rules.check(text, role).success
    for name in names:
        assert not rules.call(ExplainRule.Request(rule_id=name)).success
        assert not rules.reset(name).success
    assert not rules.confirm(expected, role).success or expected == before[0]
    assert not rules.call(GetRules.Request(revision=2**31 + expected % 1000)).success
    assert in_force(rules) == before


def await_another_monitor(stack: Stack, rules: Rules, pid: int) -> None:
    wait_until(lambda: stack.pid_of("monitor") != pid, 10, "another monitor")
    # DDS believes for a while that the dead one would answer: a question may get lost.
    futures: list[Any] = []

    def answered() -> bool:
        futures.append(rules.begin(GetRules.Request()))
        time.sleep(0.2)
        return any(future.done() for future in futures)

    wait_until(answered, 15, "an answer of the other monitor")


def test_what_was_acknowledged_survives_a_kill_amid_an_apply(stack: Stack, rules: Rules) -> None:
    base = rules.rules()
    revision = rules.view().revision
    acknowledged = 0
    for number in range(3):
        pid = stack.pid_of("monitor")
        for count in range(20):
            new = [*base, rule("edit", compare("a", ">", 100 * number + count))]
            future = rules.begin_apply(new, revision)
            if count == 2 + number:
                time.sleep(0.004 * number)
                os.kill(pid, signals.SIGKILL)
                break
            answer = rules.robot.await_future(future, 10, "the answer")
            assert answer.outcome == Request.APPLIED, answer.message
            acknowledged, revision = 100 * number + count, answer.revision
        await_another_monitor(stack, rules, pid)
        now = rules.rules()[-1]
        assert now["id"] == "edit"
        assert now["event"]["condition"]["value"] in (acknowledged, acknowledged + 1)
        assert revision <= rules.view().revision <= revision + 1
        revision = rules.view().revision
    rules.remove("edit")


def test_once_means_once_in_the_life_of_the_stack(
    stack: Stack, robot: Robot, rules: Rules, folder: Path
) -> None:
    publisher = robot.node.create_publisher(Bool, "/once", RELIABLE)

    def insist(until: Callable[[], bool], what: str) -> None:
        def again() -> bool:
            publisher.publish(Bool(data=True))
            return until()

        wait_until(again, 10, what)

    insist(lambda: bool(lines(folder / "once")), "the only firing")
    pid = stack.pid_of("monitor")
    os.kill(pid, signals.SIGKILL)
    await_another_monitor(stack, rules, pid)
    insist(lambda: rules.status("once-only").evaluated > 3, "more messages")
    assert rules.status("once-only").state == "used up"
    assert len(lines(folder / "once")) == 1
    assert rules.reset("once-only").success
    insist(lambda: len(lines(folder / "once")) == 2, "another firing")


def test_a_table_that_kills_the_monitor_is_taken_back(stack: Stack, rules: Rules) -> None:
    before = rules.view()
    crash = next(each for each in rules.rules() if each["id"] == "crash")
    silent = {"kind": "absent", "signal": signal("nothing_ever_comes"), "seconds": 0.3}
    silent["from_start"] = True
    pid = stack.pid_of("monitor")
    deadly = rule("deadly", silent, *crash["actions"])
    rules.add(deadly, probation=30.0)
    await_another_monitor(stack, rules, pid)
    now = rules.view()
    assert now.table == before.table
    assert "not confirmed before the monitor ended" in now.notice
    wait_until(lambda: rules.state.notice == now.notice, 5, "the notice")
    assert rules.history().revisions[1].outcome == "taken back"
