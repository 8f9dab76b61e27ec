"""Who has no key of the robot changes nothing over ROS, unless it was started to allow that."""

from __future__ import annotations

import contextlib
import copy
import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import httpx
import pytest
from automatika_ros_sugar.srv import (
    ChangeParameter,
    ChangeParameters,
    ConfigureFromFile,
    ExecuteMethod,
    ReplaceTopic,
)
from kompass_interfaces.srv import (
    ApplyRules,
    ChangeMissions,
    ChangePlaces,
    ChangeZones,
    ConfirmRules,
    GetHistory,
    GetRules,
    ReleaseStop,
    ResetRule,
    RollbackRules,
    SaveRecording,
    SignedCall,
    StopRobot,
)
from lifecycle_msgs.srv import ChangeState
from rclpy.task import Future
from std_msgs.msg import String

from kompass.access.gatekeeper import STALE
from kompass.access.ros_control import ROS_CONTROL, ros_control
from kompass.access.signer import Signer
from kompass.components import Component, DriveManager
from kompass.rclpy_ext.reply import NoAnswer, Reply
from kompass.signing.key import RobotKey
from kompass.signing.proof import Verifier, announce, make_proof, read_answer
from kompass.store.robot_key import GIVEN, known_keys, robot_key
from kompass_console.schema.roles import Role
from tests.components.alive import LATCHED, Alive
from tests.components.conftest import data_folder, run_on_dds
from tests.console.conftest import running, serving
from tests.support.domains import give_back, next_domain
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import TOKEN, Stack

__all__ = ["data_folder", "run_on_dds"]  # fixtures

pytestmark = pytest.mark.ros
REFUSED, APPLIED = ApplyRules.Request.REFUSED, ApplyRules.Request.APPLIED
Run = Callable[..., Alive]
NOTHING = json.dumps({"rules": []})


class Neighbour(NamedTuple):
    """Somebody on the domain of a monitor, which has its key in a folder."""

    robot: Robot
    domain: int
    key: Path

    def ask(self, request: Any) -> Any:
        """Without the key."""
        kind, name = SERVICES[type(request)]
        return self.robot.call_unsigned(kind, f"/monitor/{name}", request)

    def ask_signed(self, request: Any) -> Any:
        """With it."""
        kind, name = SERVICES[type(request)]
        return self.robot.call(kind, f"/monitor/{name}", request)

    def rules(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
        """``kompass-console rules …``."""
        command = str(Path(sys.executable).with_name("kompass-console"))
        return subprocess.run(
            [command, "rules", *arguments, "--timeout", "20", "--domain-id", str(self.domain)],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=patient(40),
            check=False,
        )


SERVICES: dict[type, tuple[Any, str]] = {
    kind.Request: (kind, name)
    for kind, name in {
        ApplyRules: "apply_rules",
        RollbackRules: "rollback_rules",
        ConfirmRules: "confirm_rules",
        ResetRule: "reset_rule",
        SaveRecording: "save_recording",
        ChangeMissions: "change_missions",
        ChangePlaces: "change_places",
        ChangeZones: "change_zones",
        GetRules: "get_rules",
        GetHistory: "get_history",
    }.items()
}


@contextlib.contextmanager
def monitor(mode: str, folder: Path) -> Iterator[Neighbour]:
    """The real monitor, on a domain of its own."""
    domain = next_domain()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(ROS_CONTROL, mode)
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        with running("tests.console.fake_monitor", str(folder)):
            robot = Robot(domain)
            try:
                neighbour = Neighbour(robot, domain, Path(os.environ[GIVEN]))
                assert neighbour.ask_signed(GetRules.Request()).success
                yield neighbour
            finally:
                robot.close()
                give_back(domain)


@pytest.fixture(scope="module")
def reading(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Neighbour]:
    """Of a monitor as it is when nobody says anything."""
    with monitor("", tmp_path_factory.mktemp("read")) as neighbour:
        yield neighbour


@pytest.fixture(scope="module")
def closed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Neighbour]:
    with monitor("off", tmp_path_factory.mktemp("off")) as neighbour:
        yield neighbour


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Neighbour]:
    with monitor("full", tmp_path_factory.mktemp("full")) as neighbour:
        yield neighbour


def apply(author: str, role: str, expected: int) -> ApplyRules.Request:
    return ApplyRules.Request(
        table=NOTHING, author=author, role=role, expected_revision=expected, probation=0.0
    )


def proved(neighbour: Neighbour, request: Any) -> Any:
    """The request as who has the key would send it."""
    robot = neighbour.robot
    signer = robot.do(lambda: Signer(robot.node, "/monitor", known_keys()))
    wait_until(lambda: signer.is_ready, 10, "a challenge")
    signed = signer.sign(f"/monitor/{SERVICES[type(request)][1]}", request)
    robot.do(signer.close)
    assert signed.proof
    return signed


# -- the rules -----------------------------------------------------------------------------------

CHANGES = [
    *(apply("chief", role, 1) for role in ("engineer", "operator", "viewer")),
    RollbackRules.Request(author="chief", role="engineer"),
    ConfirmRules.Request(revision=1, author="chief", role="engineer"),
    ResetRule.Request(rule_id="near", author="chief", role="engineer"),
    SaveRecording.Request(name="mine"),
    ChangeMissions.Request(
        change='{"kind":"start","id":1,"version":1}', author="chief", role="engineer"
    ),
    *(
        kind.Request(change='{"kind":"restore","id":1}', author="chief", role="engineer")
        for kind in (ChangePlaces, ChangeZones)
    ),
]


@pytest.mark.parametrize("mode", ["reading", "closed"])
@pytest.mark.parametrize("request_", CHANGES, ids=lambda one: f"{type(one).__name__} {one}"[:60])
def test_an_unsigned_change_is_refused_and_told_the_remedy(
    mode: str, request_: Any, request: pytest.FixtureRequest
) -> None:
    neighbour: Neighbour = request.getfixturevalue(mode)
    before = neighbour.ask_signed(GetRules.Request())
    answer = neighbour.ask(copy.copy(request_))
    assert not getattr(answer, "success", False)
    assert getattr(answer, "outcome", REFUSED) == REFUSED
    assert "it is not signed" in answer.message
    assert "--robot-key" in answer.message
    assert "--ros-control full" in answer.message
    assert neighbour.ask_signed(GetRules.Request()).answer == before.answer


def test_unsigned_questions_are_answered_unless_ros_is_off(
    reading: Neighbour, closed: Neighbour
) -> None:
    assert reading.ask(GetRules.Request()).success
    refused = closed.ask(GetRules.Request())
    assert not refused.success
    assert not refused.answer
    assert "not signed with the robot's key, and this robot gives answers only" in refused.message
    assert closed.ask_signed(GetRules.Request()).success


def test_a_request_that_was_changed_on_the_way_is_refused(reading: Neighbour) -> None:
    revision = json.loads(reading.ask(GetRules.Request()).answer)["active"]
    for field, value in (("role", "engineer"), ("author", "ava"), ("probation", 5.0)):
        signed = proved(reading, apply("ben", "viewer", revision))
        setattr(signed, field, value)
        answer = reading.ask(signed)
        assert answer.outcome == REFUSED
        assert "its proof does not fit; it was changed on the way" in answer.message


def test_a_request_that_was_overheard_is_refused_the_second_time(reading: Neighbour) -> None:
    revision = json.loads(reading.ask(GetRules.Request()).answer)["active"]
    signed = proved(reading, apply("ava", "operator", revision + 1000))
    first, second = reading.ask(signed), reading.ask(signed)
    assert "there is no such revision" in first.message  # it was let in
    assert second.outcome == REFUSED
    assert "its proof was used before" in second.message


@pytest.mark.slow
def test_a_proof_of_another_service_or_another_key_is_refused(
    reading: Neighbour, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    signed = proved(reading, ConfirmRules.Request(revision=1, author="ava", role="engineer"))
    moved = ResetRule.Request(rule_id="near", author="ava", role="engineer", proof=signed.proof)
    assert "its proof does not fit" in reading.ask(moved).message
    file = tmp_path / "other.key"
    file.write_text(RobotKey.new().text)
    file.chmod(0o600)
    shown = reading.rules("reset", "near", **{GIVEN: str(file)})
    assert shown.returncode == 1
    assert "it is not signed" in shown.stderr


def test_what_a_signed_request_changed_bears_the_name_alone(reading: Neighbour) -> None:
    revision = json.loads(reading.ask(GetRules.Request()).answer)["active"]
    assert reading.ask_signed(apply("ava", "engineer", revision)).outcome == REFUSED  # protected
    kept = json.dumps(
        {"rules": [json.loads(reading.ask(GetRules.Request()).answer)["table"]["rules"][1]]}
    )
    request = apply("ava", "engineer", revision)
    request.table = kept
    answer = reading.ask_signed(request)
    assert answer.outcome == APPLIED, answer.message
    history = json.loads(reading.ask(GetHistory.Request()).answer)
    assert history["revisions"][0]["author"] == "ava"


@pytest.mark.slow
def test_where_all_is_allowed_unsigned_changes_are_marked_wherever_they_are_shown(
    opened: Neighbour, tmp_path: Path
) -> None:
    view = json.loads(opened.ask(GetRules.Request()).answer)
    request = apply("chief", "engineer", view["active"])
    request.table = json.dumps({"rules": view["table"]["rules"][1:]})
    answer = opened.ask(request)
    assert answer.outcome == APPLIED, answer.message
    assert opened.ask(ConfirmRules.Request(revision=1, author="x", role="viewer")).message
    history = json.loads(opened.ask(GetHistory.Request()).answer)
    assert history["revisions"][0]["author"] == "chief (unverified)"
    shown = opened.rules("history")
    assert "chief (unverified) (engineer)" in " ".join(shown.stdout.split()), shown.stdout
    # And to the next one who begins from an older revision.
    conflict = opened.ask(apply("ben", "engineer", view["active"]))
    assert "chief (unverified) was faster" in conflict.message
    with serving(tmp_path / "audit", opened.domain) as console, console.client(Role.VIEWER) as page:

        def revisions() -> list[dict[str, Any]]:
            answer = page.get("/api/rules/history")
            return answer.json()["revisions"] if answer.is_success else []

        wait_until(revisions, 20, "the history on the page")
        assert revisions()[0]["author"] == "chief (unverified)"


def test_a_damaged_proof_is_refused_even_where_none_is_needed(opened: Neighbour) -> None:
    request = apply("chief", "engineer", 1)
    request.proof = "nonsense"
    assert "its proof is too old" in opened.ask(request).message


# -- consoles ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["reading", "closed"])
def test_the_command_line_of_the_robots_user_works_and_that_of_others_says_what_to_do(
    mode: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    neighbour: Neighbour = request.getfixturevalue(mode)
    stranger = {GIVEN: "", "KOMPASS_DATA_DIR": str(tmp_path)}
    refused = neighbour.rules("reset", "silent", **stranger)
    assert refused.returncode == 1
    assert "--robot-key" in refused.stderr
    assert "--ros-control full" in refused.stderr
    shown = neighbour.rules("show", **stranger)
    assert shown.returncode == (0 if mode == "reading" else 1), shown.stderr
    brought = neighbour.rules("reset", "silent", "--robot-key", str(neighbour.key), **stranger)
    assert brought.returncode == 0, brought.stderr
    assert "starts afresh" in brought.stdout
    own = tmp_path / "r1"
    own.mkdir()
    (own / "robot.key").write_text(neighbour.key.read_text())
    (own / "robot.key").chmod(0o600)
    found = neighbour.rules("reset", "silent", **stranger)
    assert found.returncode == 0, found.stderr


@pytest.mark.slow
def test_a_console_without_the_key_tells_its_people_what_to_do(
    reading: Neighbour, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(GIVEN, "")
    monkeypatch.setenv("KOMPASS_DATA_DIR", str(tmp_path))
    with (
        serving(tmp_path / "audit", reading.domain) as console,
        console.client(Role.ENGINEER) as page,
    ):
        wait_until(lambda: page.get("/api/rules").is_success, 20, "the rules")
        answer = page.post("/api/rules/near/reset")
        assert not answer.is_success
        assert "--robot-key" in answer.text


@pytest.mark.slow
def test_a_key_that_cannot_be_used_is_refused_when_the_command_is_read(
    reading: Neighbour, tmp_path: Path
) -> None:
    missing = reading.rules("show", "--robot-key", str(tmp_path / "none"))
    assert missing.returncode == 2
    assert f"--robot-key: the key {tmp_path / 'none'} cannot be read" in missing.stderr
    (tmp_path / "open").write_text("0" * 64)
    (tmp_path / "open").chmod(0o644)
    loose = reading.rules("show", "--robot-key", str(tmp_path / "open"))
    assert loose.returncode == 2
    assert "chmod 600" in loose.stderr


@pytest.mark.parametrize("mode", ["none", "FULL", "on"])
def test_a_mode_that_is_none_is_refused(mode: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(ROS_CONTROL, mode)
    with pytest.raises(ValueError, match=f"{ROS_CONTROL}='{mode}' is none of off, read, full"):
        ros_control()


@pytest.mark.slow
def test_with_ros_off_the_robots_own_console_does_what_it_always_did() -> None:
    stack = Stack.simulated("--ros-control", "off", KOMPASS_ROBOT_KEY="")
    try:
        assert "is not even answered (--ros-control off)" in stack.output
        robot = Robot(stack.domain)
        page = httpx.Client(base_url=stack.url, headers={"Origin": stack.url}, timeout=30.0)
        with contextlib.closing(robot), page:
            robot.ready()
            assert page.post("/api/login", json={"token": TOKEN}).is_success
            wait_until(lambda: page.get("/api/rules").is_success, 20, "the rules")
            view = page.get("/api/rules").json()
            body = {
                "table": {**view["table"], "rules": []},
                "expected_revision": view["revision"],
                "probation": 0,
            }
            assert page.post("/api/rules/apply", json=body).is_success
            request = StopRobot.Request(operator_name="neighbour")
            assert robot.call_unsigned(StopRobot, "/drive_manager/stop", request).success
            release = ReleaseStop.Request(operator_name="neighbour")
            name = "/drive_manager/release_stop"
            assert "not signed" in robot.call_unsigned(ReleaseStop, name, release).message
            answer = page.post("/api/stop/release")
            assert answer.is_success, answer.text
            assert answer.json()["accepted"], answer.text
            goal = {"x": 0.5, "y": 0.0, "yaw": None, "view": None}
            sent = lambda: page.post("/api/goals", json=goal).is_success  # noqa: E731
            wait_until(sent, 20, "a planner that the console has found")
            wait_until(lambda: robot.distance_to(0.5, 0.0) < 0.15, 40, "the arrival")
    finally:
        stack.close()


# -- components ----------------------------------------------------------------------------------


@pytest.fixture
def mode(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    chosen: str = getattr(request, "param", "")
    monkeypatch.setenv(ROS_CONTROL, chosen)
    return chosen


def unsigned(alive: Alive, kind: Any, name: str, request: Any) -> Any:
    """Call a service of a component as who has no key."""
    client = alive.node.create_client(kind, f"{alive.component.node_name}/{name}")
    wait_until(client.service_is_ready, 10, f"service {name}")
    future = client.call_async(request)
    wait_until(future.done, 10, f"answer of {name}")
    return future.result()


@pytest.mark.parametrize("mode", ["", "read", "off"], indirect=True)
@pytest.mark.usefixtures("mode")
def test_anybody_stops_the_robot_and_only_who_has_the_key_releases_it(run_on_dds: Run) -> None:
    gate = DriveManager()
    alive = run_on_dds(gate)
    assert unsigned(alive, StopRobot, "stop", StopRobot.Request(operator_name="neighbour")).success
    refused = unsigned(alive, ReleaseStop, "release_stop", ReleaseStop.Request(operator_name="ava"))
    assert not refused.success
    assert "it is not signed" in refused.message
    signer = Signer(alive.node, "/drive_manager", known_keys())
    wait_until(lambda: signer.is_ready, 10, "a challenge")
    name = "/drive_manager/release_stop"
    signed = signer.sign(name, ReleaseStop.Request(operator_name="ava"))
    changed = ReleaseStop.Request(operator_name="eve", proof=signed.proof)
    assert "its proof does not fit" in unsigned(alive, ReleaseStop, "release_stop", changed).message
    released = unsigned(alive, ReleaseStop, "release_stop", signed)
    assert (released.success, released.message) == (True, "released")
    assert alive.call(StopRobot, "stop", StopRobot.Request(operator_name="ava")).success
    again = unsigned(alive, ReleaseStop, "release_stop", signed)
    assert not again.success
    assert "its proof was used before" in again.message
    assert gate._latch.is_set


@pytest.mark.parametrize("mode", ["full"], indirect=True)
@pytest.mark.usefixtures("mode")
def test_where_all_is_allowed_an_unsigned_release_is_marked_in_the_log(
    run_on_dds: Run, capfd: pytest.CaptureFixture[str]
) -> None:
    alive = run_on_dds(DriveManager())
    unsigned(alive, StopRobot, "stop", StopRobot.Request(operator_name="ava"))
    request = ReleaseStop.Request(operator_name="chief")
    assert unsigned(alive, ReleaseStop, "release_stop", request).success
    wait_until(
        lambda: "STOP released by chief (unverified)" in capfd.readouterr().err, 5, "the log"
    )


SETTERS = [
    (
        ChangeParameter,
        "update_config_parameter",
        ChangeParameter.Request(name="disable_safety_stop", value="true", keep_alive=True),
    ),
    (
        ChangeParameters,
        "update_config_parameters",
        ChangeParameters.Request(names=["disable_safety_stop"], values=["true"], keep_alive=True),
    ),
    (ConfigureFromFile, "configure_from_file", ConfigureFromFile.Request(path_to_file="/x.yaml")),
    (
        ReplaceTopic,
        "change_topic",
        ReplaceTopic.Request(
            direction=0, old_name="/scan", new_name="/mine", new_msg_type="LaserScan"
        ),
    ),
    (ExecuteMethod, "execute_method", ExecuteMethod.Request(name="stop")),
]


@pytest.mark.parametrize("mode", ["", "off"], indirect=True)
@pytest.mark.usefixtures("mode")
def test_nobody_changes_a_component_without_the_key(run_on_dds: Run) -> None:
    gate = DriveManager()
    alive = run_on_dds(gate)
    before = repr(gate.config)
    for kind, name, request in SETTERS:
        answer = unsigned(alive, kind, name, request)
        told = answer.error_msg if isinstance(answer.error_msg, str) else answer.error_msg[0]
        assert "it is not signed" in told, name
        assert answer.success in (False, [False]), name
    transition = ChangeState.Request()
    transition.transition.id = 4  # deactivate
    assert not unsigned(alive, ChangeState, "change_state", transition).success
    bare = SignedCall.Request(service="execute_method")
    assert "it is not signed" in unsigned(alive, SignedCall, "signed_call", bare).message
    assert gate.is_active
    assert repr(gate.config) == before
    kind, name, request = SETTERS[0]
    assert alive.call(kind, name, request).success
    assert gate.config.disable_safety_stop
    assert alive.call(ChangeState, "change_state", transition).success
    assert not gate.is_active


@pytest.mark.parametrize("mode", ["full"], indirect=True)
@pytest.mark.usefixtures("mode")
def test_where_all_is_allowed_other_ros_tools_change_components(run_on_dds: Run) -> None:
    alive = run_on_dds(DriveManager())
    assert unsigned(alive, *SETTERS[0]).success
    transition = ChangeState.Request()
    transition.transition.id = 4
    assert unsigned(alive, ChangeState, "change_state", transition).success


def test_a_service_that_is_none_is_refused_by_name(run_on_dds: Run) -> None:
    alive = run_on_dds(Component(component_name="lamp"))
    signer = Signer(alive.node, "/lamp", known_keys())
    wait_until(lambda: signer.is_ready, 10, "a challenge")
    call = signer.sign("/lamp/signed_call", SignedCall.Request(service="explode"))
    answer = unsigned(alive, SignedCall, "signed_call", call)
    assert not answer.success
    assert "'explode': there is none; known are update_config_parameter, " in answer.message


RELEASE = "/drive_manager/release_stop"


def stopped(run_on_dds: Run) -> tuple[DriveManager, Alive]:
    gate = DriveManager()
    alive = run_on_dds(gate)
    assert unsigned(alive, StopRobot, "stop", StopRobot.Request()).success
    return gate, alive


def release(alive: Alive, signer: Signer, limit: float = 10.0) -> Reply[ReleaseStop.Response]:
    client = alive.node.create_client(ReleaseStop, RELEASE)
    wait_until(lambda: signer.is_ready and client.service_is_ready(), 10, "the service")
    request = ReleaseStop.Request(operator_name="ava")
    reply: Reply[Any] = signer.call(client, RELEASE, request, patient(limit))
    return reply


def test_a_request_that_crosses_a_restart_is_signed_anew(run_on_dds: Run) -> None:
    gate, alive = stopped(run_on_dds)
    signer = Signer(alive.node, "/drive_manager", known_keys())
    wait_until(lambda: signer.is_ready, 10, "a challenge")
    # Nobody has heard what the new one says on its topic.
    gate._gatekeeper._verifier = Verifier(robot_key(), time.monotonic())
    assert release(alive, signer).wait().success
    assert not gate._latch.is_set


def test_a_request_that_was_given_up_is_not_made_later(run_on_dds: Run) -> None:
    _, alive = stopped(run_on_dds)
    signer = Signer(alive.node, "/drive_manager", known_keys())
    calls: list[Future] = []

    class Client:
        """Of a server that takes its time."""

        def service_is_ready(self) -> bool:
            return True

        def call_async(self, request: Any) -> Future:
            calls.append(Future())
            self.proof = request.proof
            return calls[-1]

        def remove_pending_request(self, call: Future) -> None:
            assert call is calls[-1]

    wait_until(lambda: signer.is_ready, 10, "a challenge")
    client = Client()
    reply: Reply[Any] = signer.call(client, RELEASE, ReleaseStop.Request(), 0.1)
    with pytest.raises(NoAnswer, match="did not answer within"):
        reply.wait()
    late = Verifier(robot_key(), 0.0).answer(client.proof)
    calls[0].set_result(ReleaseStop.Response(message=f"{STALE} [{late}]"))
    time.sleep(0.1)
    assert len(calls) == 1


@pytest.mark.parametrize("word", ["nonsense", "forged", "old"])
def test_who_repeats_or_invents_challenges_locks_nobody_out(run_on_dds: Run, word: str) -> None:
    gate, alive = stopped(run_on_dds)
    old = gate._gatekeeper._verifier.announcement
    gate._gatekeeper._verifier = Verifier(robot_key(), time.monotonic())
    gate._gatekeeper._publish()
    said = {"nonsense": "nonsense", "forged": announce(RobotKey.new(), "mine"), "old": old}[word]
    heard = alive.hear(String, "/drive_manager/challenge", LATCHED)
    liar = alive.publisher(String, "/drive_manager/challenge", LATCHED)
    ended = threading.Event()

    def lie() -> None:
        while not ended.wait(0.005):
            liar.publish(String(data=said))

    thread = threading.Thread(target=lie)
    thread.start()
    try:
        wait_until(lambda: any(each.data == said for each in heard), 10, "what the liar says")
        for _ in range(5):
            signer = Signer(alive.node, "/drive_manager", known_keys())
            assert release(alive, signer).wait().success
            assert not gate._latch.is_set
            assert unsigned(alive, StopRobot, "stop", StopRobot.Request()).success
    finally:
        ended.set()
        thread.join()


def test_an_answer_to_another_proof_is_not_believed() -> None:
    key = robot_key()
    verifier = Verifier(key, 0.0)
    asked, other = (make_proof(key, "old", RELEASE, ReleaseStop.Request()) for _ in range(2))
    answer = verifier.answer(asked)
    assert read_answer(answer, asked, key) == answer.partition(".")[0]
    assert read_answer(answer, other, key) is None
    assert read_answer(answer, asked, RobotKey.new()) is None
    challenge, _, mark = answer.partition(".")
    assert read_answer(f"{challenge[::-1]}.{mark}", asked, key) is None
