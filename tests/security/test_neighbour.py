"""Who is on the robot's network meets the robot only where its owner has said so."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.hosts import Host, two_hosts
from tests.support.patience import patient
from tests.support.stack import TOKEN, Stack

pytestmark = pytest.mark.ros
RECIPE = """
from kompass.actions import LogInfo
from kompass.components import Component
from kompass.ros import Event, Launcher, Topic

lamp = Component(component_name="lamp")
dark = Event(Topic(name="/dark", msg_type="Bool").msg.data == True, on_change=True)
dark.name = "dark"
launcher = Launcher()
launcher.kompass(components=[lamp], events_actions={dark: LogInfo(msg="it is dark")})
launcher.bringup()
"""
# Logs in to a console that runs on the same host, and asks it for the rules until it has them.
ASK_THE_CONSOLE = """
import sys, time, httpx
url, token, patience = sys.argv[1], sys.argv[2], float(sys.argv[3])
end = time.monotonic() + patience
with httpx.Client(base_url=url, headers={"Origin": url}, timeout=20) as page:
    while time.monotonic() < end:
        try:
            if page.post("/api/login", json={"token": token}).is_success:
                rules = page.get("/api/rules")
                if rules.is_success:
                    sys.exit(0 if '"dark"' in rules.text else rules.text)
        except httpx.TransportError:
            pass
        time.sleep(0.1)
sys.exit("the console never had the rules")
"""


@pytest.fixture(scope="module")
def hosts() -> Iterator[tuple[Host, Host]]:
    with two_hosts() as made:
        yield made


@pytest.fixture(scope="module")
def recipe(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recipe") / "lamp.py"
    path.write_text(RECIPE)
    return path


@contextlib.contextmanager
def robot_on(host: Host, recipe: Path, *options: str, **environment: str) -> Iterator[Stack]:
    """A stack on a host, ready."""
    started = Stack.active(recipe, *options, through=host.enter, **environment)
    with contextlib.closing(started) as stack:
        yield stack


class Asking:
    """``kompass-console rules show``, or another command of these, on a host, under way."""

    def __init__(
        self,
        host: Host,
        domain: int,
        *options: str,
        command: tuple[str, ...] = ("show",),
        **environment: str,
    ) -> None:
        program = str(Path(sys.executable).with_name("kompass-console"))
        self._process = subprocess.Popen(
            [*host.enter, program, "rules", *command, "--domain-id", str(domain), *options],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **environment},
        )

    def result(self) -> tuple[int, str]:
        """Its exit code and all that it printed."""
        out, error = self._process.communicate(timeout=patient(30))
        return self._process.returncode, out + error


def look(host: Host, domain: int, *ways: tuple[str, ...]) -> list[tuple[int, str]]:
    """Look for the robot in several ways at a time."""
    under_way = [Asking(host, domain, *options) for options in ways]
    return [each.result() for each in under_way]


def finds(answer: tuple[int, str]) -> bool:
    code, said = answer
    assert code in (0, 1), said
    assert ("dark" in said) if code == 0 else ("no monitor was found" in said), said
    return code == 0


def test_unless_it_is_asked_for_nobody_meets_the_robot_over_the_network(
    hosts: tuple[Host, Host], recipe: Path
) -> None:
    home, neighbour = hosts
    with robot_on(home, recipe) as robot:
        assert "on this machine only (--network local)" in robot.output
        on_its_machine = Asking(home, robot.domain)
        attached = attach(neighbour, robot.domain)
        seen = look(
            neighbour, robot.domain, (), ("--network", "subnet"), ("--network", home.address)
        )
        assert finds(on_its_machine.result())
        try:
            attached.wait_for_line("No robot is found", 15)
            attached.wait_for_line("--network subnet", 5)
        finally:
            attached.close()
    assert f"ROS domain {robot.domain}, on this machine only" in attached.output
    assert [finds(each) for each in seen] == [False, False, False]
    assert f"ROS domain {robot.domain}, on this machine only" in seen[0][1]
    assert f"ROS domain {robot.domain}, on the whole subnet" in seen[1][1]
    assert f"ROS domain {robot.domain}, on this machine and {home.address}" in seen[2][1]
    assert "give --network subnet" in seen[0][1]


def test_on_the_subnet_the_robot_is_met_by_whoever_looks_there(
    hosts: tuple[Host, Host], recipe: Path
) -> None:
    home, neighbour = hosts
    with robot_on(home, recipe, "--network", "subnet") as robot:
        assert "on the whole subnet (--network subnet)" in robot.output
        seen = look(
            neighbour, robot.domain, (), ("--network", "subnet"), ("--network", home.address)
        )
        assert [finds(each) for each in seen] == [False, True, True]
        attached = attach(neighbour, robot.domain, "--network", "subnet")
        try:
            shows_the_rules(neighbour, attached)
        finally:
            attached.close()


def test_a_robot_with_peers_calls_these_alone_and_answers_whoever_calls_it(
    hosts: tuple[Host, Host], recipe: Path
) -> None:
    home, neighbour = hosts
    peer = "198.51.100.77"  # not the neighbour
    with robot_on(home, recipe, "--network", peer) as robot:
        assert f"on this machine and {peer} (--network {peer})" in robot.output
        seen = look(
            neighbour, robot.domain, (), ("--network", "subnet"), ("--network", home.address)
        )
    # A list of peers is no lock: docs/security.md says so.
    assert [finds(each) for each in seen] == [False, False, True]


def test_who_is_on_the_network_needs_the_key_to_change_the_robot(
    hosts: tuple[Host, Host], recipe: Path, tmp_path: Path
) -> None:
    home, neighbour = hosts
    without = {"KOMPASS_ROBOT_KEY": "", "KOMPASS_DATA_DIR": str(tmp_path / "none")}
    with robot_on(home, recipe, "--network", "subnet", KOMPASS_ROBOT_KEY="") as robot:
        [key] = robot.data_dir.glob("*/robot.key")
        domain, reach = robot.domain, ["--network", "subnet"]
        change = ("disable", "dark", "--yes")
        code, said = Asking(neighbour, domain, *reach, command=change, **without).result()
        assert code == 1, said
        assert "it is not signed" in said
        assert "--robot-key" in said
        # What scp would do.
        brought = tmp_path / "desk-lamp.key"
        brought.touch(0o600)
        brought.write_text(key.read_text())
        reach += ["--robot-key", str(brought)]
        code, said = Asking(neighbour, domain, *reach, command=change, **without).result()
        assert code == 0, said
        # At home it is found.
        here = {"KOMPASS_ROBOT_KEY": "", "KOMPASS_DATA_DIR": str(robot.data_dir)}
        back = ("enable", "dark", "--yes")
        code, said = Asking(home, domain, command=back, **here).result()
        assert code == 0, said


def attach(host: Host, domain: int, *options: str) -> Stack:
    """A console alone."""
    command = ("attach", "--no-browser", "--port", "0", *options)
    return Stack(*command, domain=domain, through=host.enter)


def shows_the_rules(host: Host, console: Stack) -> None:
    """A page on that host has the rules of the robot."""
    asked = subprocess.run(
        [*host.enter, sys.executable, "-c", ASK_THE_CONSOLE, console.url, TOKEN, str(patient(20))],
        capture_output=True,
        text=True,
        timeout=patient(30),
        check=False,
    )
    assert asked.returncode == 0, asked.stderr + console.output
