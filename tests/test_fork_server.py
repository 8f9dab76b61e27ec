"""What is forked for a test is a process as a command of its own is one."""

import os
import re
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.fork_server import Forked, ForkServer
from tests.support.patience import patient
from tests.support.processes import wait_until

pytestmark = pytest.mark.slow

PATROL = Path(__file__).parents[1] / "recipes" / "08_patrol.py"


@pytest.fixture(scope="module")
def server() -> Iterator[ForkServer]:
    server = ForkServer(os.environ)
    yield server
    server.close()


def run(server: ForkServer, *arguments: str) -> tuple[int, str]:
    process = server.start(arguments, os.environ)
    with process.stdout:
        output = process.stdout.read()
    return process.wait(patient(10.0)), output


def test_it_says_and_ends_with_what_a_command_of_its_own_would(server: ForkServer) -> None:
    code, output = run(server, "run", "nowhere.py")
    assert code == 2
    assert "there is no recipe nowhere.py" in output
    assert run(server, "--help")[0] == 0


@pytest.fixture
def robot(server: ForkServer, tmp_path: Path) -> Iterator[Forked]:
    command = ("run", str(PATROL), "--sim", "--no-browser", "--port", "0", "--data-dir")
    process = server.start([*command, str(tmp_path)], os.environ)
    yield process
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGINT)
        process.wait(patient(20.0))
    process.stdout.close()


def said(process: Forked, text: str) -> str:
    output = ""
    for line in process.stdout:
        output += line
        if text in line:
            return output
    raise AssertionError(output)


def test_it_has_a_session_of_its_own_and_ends_by_ctrl_c(robot: Forked) -> None:
    said(robot, "all components active")
    assert robot.poll() is None
    assert os.getsid(robot.pid) == os.getpgid(robot.pid) == robot.pid
    with pytest.raises(subprocess.TimeoutExpired):
        robot.wait(0.01)
    os.killpg(robot.pid, signal.SIGINT)
    assert robot.wait(patient(20.0)) == 0


def test_what_it_leaves_behind_is_found(robot: Forked, server: ForkServer) -> None:
    guard = int(re.findall(r"guard is process (\d+)", said(robot, "all components active"))[-1])
    os.kill(guard, signal.SIGSTOP)  # who ends the others
    os.kill(robot.pid, signal.SIGKILL)
    assert robot.wait(patient(5.0)) == -signal.SIGKILL
    wait_until(lambda: any(line.startswith(f"{guard}:") for line in server.left()), 5, "it")
    os.kill(guard, signal.SIGCONT)
    wait_until(lambda: not server.left(), 20, "that all have ended")
