"""Processes live and die as an operator expects: nothing is lost, nothing is left behind."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import httpx
import pytest

from tests.support.domains import give_back, next_domain
from tests.support.patience import patient
from tests.support.processes import children, wait_until
from tests.support.robot import Robot
from tests.support.stack import RECIPE, TOKEN, Stack

pytestmark = pytest.mark.ros


@pytest.fixture
def fresh() -> Iterator[Stack]:
    """A stack to be ended; what it must outlive is tried on the one of the module."""
    with closing(Stack.simulated()) as running:
        yield running


def alive(pid: int) -> bool:
    return Path(f"/proc/{pid}").exists()


def answers(url: str) -> bool:
    try:
        return httpx.get(url, timeout=1.0).status_code == 200
    except httpx.HTTPError:
        return False


def test_ctrl_c_ends_all_processes_within_three_seconds(fresh: Stack) -> None:
    wait_until(lambda: answers(fresh.url), 20, "the page")
    pids = [fresh.process.pid, *children(fresh.process.pid)]
    assert len(pids) >= 8
    began = time.monotonic()
    fresh.interrupt()
    assert fresh.process.wait(patient(5)) == 0, fresh.output
    assert time.monotonic() - began < patient(3.0)
    assert not [pid for pid in pids if alive(pid)]
    assert "killed" not in fresh.output


def test_a_run_of_the_tests_that_is_killed_leaves_no_stack_behind(tmp_path: Path) -> None:
    domain = next_domain(stack=True)
    program = (
        "from tests.support.stack import RECIPE, Stack; import time; "
        "command = ('run', str(RECIPE), '--sim', '--no-browser', '--port', '0'); "
        f"stack = Stack(*command, domain={domain}); "
        "stack.wait_for_line('all components active', 20); "
        "print(stack.process.pid, flush=True); time.sleep(60)"
    )
    # Its folder of data is nobody's to remove then.
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    run = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, env=environment
    )
    assert run.stdout is not None
    with run.stdout:
        supervisor = int(run.stdout.readline())
    pids = [supervisor, *children(supervisor)]
    run.kill()
    run.wait()
    wait_until(lambda: not [pid for pid in pids if alive(pid)], 5, "the end of the stack")
    give_back(domain)


def test_a_killed_console_does_not_stop_the_robot_and_comes_back(
    stack: Stack, robot: Robot
) -> None:
    wait_until(lambda: answers(stack.url), 20, "the page")
    handle = robot.send_goal(0.5, 0.5)
    wait_until(lambda: robot.speed > 0.1, 10, "motion")
    os.kill(stack.pid_of("console"), signal.SIGKILL)
    wait_until(lambda: answers(stack.url), 20, "the page again")
    attached = Stack("attach", "--no-browser", "--port", "0", domain=stack.domain)
    try:
        wait_until(lambda: answers(attached.url), 20, "the attached page")
        login = httpx.post(
            f"{attached.url}/api/login", json={"token": TOKEN}, headers={"Origin": attached.url}
        )
        assert login.status_code == 200
    finally:
        assert attached.close() == 0
    assert robot.result(handle).status == 4


def test_a_dead_drive_manager_halts_the_robot(stack: Stack, robot: Robot) -> None:
    robot.send_goal(-1.5, 0.5)
    wait_until(lambda: robot.speed > 0.1, 10, "motion")
    os.kill(stack.pid_of("drive_manager"), signal.SIGSTOP)
    try:
        wait_until(lambda: robot.speed < 0.01, 2, "a halt")
    finally:
        os.kill(stack.pid_of("drive_manager"), signal.SIGCONT)


def test_a_second_stack_on_the_domain_is_refused(stack: Stack) -> None:
    second = Stack("run", str(RECIPE), "--no-browser", "--port", "0", domain=stack.domain)
    assert second.wait() == 1
    assert "another stack already runs" in second.output
    assert "Traceback" not in second.output
    assert stack.process.poll() is None


def test_stop_survives_the_death_of_the_drive_manager(stack: Stack, robot: Robot) -> None:
    # STOP stays: nothing after this drives.
    robot.stop()
    os.kill(stack.pid_of("drive_manager"), signal.SIGKILL)
    stack.wait_for_line("drive_manager killed by SIGKILL", 5)
    robot.newest.pop("/drive_state", None)
    wait_until(lambda: "/drive_state" in robot.newest, 15, "a drive manager again")
    assert robot.newest["/drive_state"].stopped
    assert robot.newest["/drive_state"].stopped_by == "tester"


def test_children_do_not_outlive_a_killed_supervisor(stack: Stack) -> None:
    """The last test of the module: its stack ends."""
    pids = list(children(stack.process.pid))
    assert len(pids) >= 8
    os.kill(stack.process.pid, signal.SIGKILL)
    wait_until(lambda: not [pid for pid in pids if alive(pid)], 5, "the end of all children")
