"""Components that share a process do not fall with each other, nor silently."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from automatika_ros_sugar.msg import ComponentStatus
from automatika_ros_sugar.srv import ExecuteMethod
from lifecycle_msgs.srv import GetState
from std_msgs.msg import String
from std_srvs.srv import Trigger

from kompass.rclpy_ext.reply import NoAnswer
from tests.support.domains import next_domain
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot

pytestmark = pytest.mark.ros

PROGRAM = """
from std_srvs.srv import Trigger

from kompass.components import Component
from kompass.rclpy_ext.topic import AllowedTopics, Topic
from kompass.launcher import Launcher


class Fragile(Component):
    '''Raises when it is told to: in a callback of a topic, of a service, of a timer.'''

    allowed_inputs = {"words": AllowedTopics(["String"])}

    def create_interfaces(self):
        self.node.create_service(Trigger, f"{self.node_name}/raise", self.on_trigger)

    def custom_on_activate(self):
        self.steps = 0
        self.input("words").on_message = self.on_word

    def on_word(self, message):
        if message.data == "timer":
            self.create_timer(0.01, self.on_timer)
        else:
            raise ValueError(message.data)

    def on_timer(self):
        raise KeyError("timer")

    def on_trigger(self, request, response):
        raise RuntimeError("service")


names = ["fragile", "sturdy"]
components = [
    Fragile(name, inputs={"words": Topic(name=f"{name}/words", msg_type="String")})
    for name in names
]
launcher = Launcher(namespace="robot1", enable_monitoring=False)
launcher.kompass(components, multi_processing=False)
launcher.bringup()
"""


class Statuses(Robot):
    """A client that hears what both components say of themselves."""

    def __init__(self, domain: int) -> None:
        super().__init__(domain)
        self.heard: dict[str, list[ComponentStatus]] = {"fragile": [], "sturdy": []}
        for name, heard in self.heard.items():
            self.node.create_subscription(
                ComponentStatus, f"/robot1/{name}/status", heard.append, LATCHED
            )
        self._words = self.node.create_publisher(String, "/robot1/fragile/words", 10)
        self._trigger = self.node.create_client(Trigger, "/robot1/fragile/raise")

    def say(self, word: str) -> None:
        wait_until(lambda: self._words.get_subscription_count() > 0, 10, "a listener")
        self._words.publish(String(data=word))

    def ask(self) -> None:
        """Call the service that never answers."""
        wait_until(self._trigger.service_is_ready, 10, "the service")
        self._trigger.call_async(Trigger.Request())

    def state(self, name: str) -> str:
        """Of the lifecycle; empty when the answer was lost with a process that died."""
        try:
            answer = self.call(
                GetState, f"/robot1/{name}/get_state", GetState.Request(), timeout=1.0
            )
        except NoAnswer:
            return ""
        return str(answer.current_state.label)

    def failures(self, name: str) -> list[str]:
        return [status.msg for status in self.heard[name] if status.status == 2]


@pytest.fixture(scope="module")
def process(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[int, Path, int]]:
    domain = next_domain()
    output = tmp_path_factory.mktemp("host") / "output"
    program = output.with_name("recipe.py")
    program.write_text(PROGRAM)
    with output.open("w") as file:
        running = subprocess.Popen(
            [sys.executable, str(program)],
            stdout=file,
            stderr=subprocess.STDOUT,
            env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        )
        try:
            wait_until(lambda: "all components active" in output.read_text(), 30, "a process")
            yield domain, output, running.pid
        finally:
            running.send_signal(signal.SIGINT)
            running.wait(10)


@pytest.fixture(scope="module")
def client(process: tuple[int, Path, int]) -> Iterator[Statuses]:
    made = Statuses(process[0])
    try:
        wait_until(lambda: all(made.heard.values()), 10, "both statuses")
        yield made
    finally:
        made.close()


@pytest.mark.parametrize("place", ["topic", "service", "timer"])
def test_an_exception_becomes_a_status_and_ends_nothing(
    client: Statuses, process: tuple[int, Path, int], place: str
) -> None:
    if place == "service":
        client.ask()
    else:
        client.say(place)
    wait_until(lambda: any(place in text for text in client.failures("fragile")), 10, "its failure")
    after = {name: len(heard) for name, heard in client.heard.items()}
    wait_until(
        lambda: all(len(client.heard[name]) > after[name] + 3 for name in after), 10, "more words"
    )
    assert client.failures("sturdy") == []
    output = process[1].read_text()
    assert "a callback failed: " in output
    assert "recipe.py" in output
    assert "ended with" not in output


def test_what_was_stopped_stays_stopped_when_its_process_dies(
    client: Statuses, process: tuple[int, Path, int]
) -> None:
    request = ExecuteMethod.Request(name="stop", kwargs_json="{}")
    assert client.call(ExecuteMethod, "/robot1/sturdy/execute_method", request).success
    output = process[1]
    pid = int(output.read_text().split("components is process ")[-1].split()[0])
    os.kill(pid, signal.SIGKILL)
    wait_until(lambda: output.read_text().count("components is up") == 2, 15, "a second life")
    expected = {"fragile": "active", "sturdy": "unconfigured"}
    wait_until(lambda: {name: client.state(name) for name in expected} == expected, 20, "states")
