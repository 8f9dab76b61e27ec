"""From the death of a process, or its stop by a signal, to the standstill of a robot at full speed.

Each process of recipe 01 in turn gets SIGKILL, then SIGSTOP, while the embedded robot drives at
full speed; the supervisor, too, with the robot outside of the stack. Times and distances are those
of the simulation's ground truth. Aim: 0.3 s, where the robot has to stand at all: it drives on
without a mapper, a monitor or a page.

.venv/bin/python benchmarks/standstill.py [ROUNDS] [PROCESS …]
"""

import math
import os
import random
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parents[1]))
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

from tests.support.domains import give_back, next_domain
from tests.support.processes import wait_until
from tests.support.robot import Robot
from tests.support.stack import RECIPE, Stack

PROCESSES = ("controller", "drive_manager", "planner", "mapper", "monitor", "console")
FULL_SPEED = 0.2  # m/s; the recipe's robot does 0.22
STANDING = 0.01  # m/s
SETTLED = 0.2  # s without motion that count as standstill
WATCHED = 2.0  # s; who moves at their end drives on
EXTENT = 2.2  # m, half of what goals are chosen in
IN_A_ROW = 4  # signals to a process of one stack
LONG = 1.2  # m, a way on which full speed is reached


class Motion(NamedTuple):
    """The robot at a moment [s, m, m, m/s]."""

    at: float
    x: float
    y: float
    speed: float


class Halt(NamedTuple):
    """What a signal led to: time and way to the standstill [s, m]; None when it drove on."""

    time: float | None
    distance: float


class Watched(Robot):
    """A robot that keeps its track."""

    def __init__(self, domain: int) -> None:
        super().__init__(domain)
        self.track: list[Motion] = []
        self.node.create_subscription(Odometry, "/simulator/ground_truth", self._note, 50)

    def _note(self, message: Odometry) -> None:
        at, twist = message.pose.pose.position, message.twist.twist.linear
        self.track.append(Motion(time.monotonic(), at.x, at.y, math.hypot(twist.x, twist.y)))

    def after(self, number: signal.Signals, pid: int) -> Halt:
        """Send a signal and see what becomes of the motion."""
        self.track.clear()
        began = time.monotonic()
        os.kill(pid, number)
        wait_until(lambda: self.track and self.track[-1].at > began + WATCHED, 10, "the track")
        track = list(self.track)
        # What came back may have set the robot in motion again: the first rest counts.
        for one in track:
            while_at_rest = [other for other in track if 0 <= other.at - one.at <= SETTLED]
            if all(other.speed < STANDING for other in while_at_rest):
                return Halt(one.at - began, math.hypot(one.x - track[0].x, one.y - track[0].y))
        return Halt(None, 0.0)


def at_rest(robot: Watched) -> None:
    """End the goal under way: what follows sets out from a standstill."""
    robot.stop()
    wait_until(lambda: robot.speed < STANDING, 5, "a standstill")
    robot.release()
    robot.track.clear()


def full_speed(robot: Watched, chance: random.Random) -> None:
    """Drive somewhere, and return at full speed."""
    for _ in range(50):
        x, y = chance.uniform(-EXTENT, EXTENT), chance.uniform(-EXTENT, EXTENT)
        answer = robot.check(x, y)
        if not answer.reachable or answer.length < LONG:
            continue
        robot.send_goal(x, y)
        began = time.monotonic()
        while time.monotonic() - began < 8.0:
            recent = robot.track[-15:]
            if len(recent) == 15 and min(one.speed for one in recent) >= FULL_SPEED:
                return
            time.sleep(0.01)
    raise RuntimeError("the robot does not get to full speed")


def another_than(stack: Stack, name: str, pid: int) -> None:
    """Wait until a process was started again."""
    wait_until(lambda: stack.pid_of(name) != pid, 10, f"another {name}")


def of_process(name: str, number: signal.Signals, rounds: int) -> list[Halt]:
    """Signals to one process, on a new stack now and then: who dies often is waited for longer."""
    chance = random.Random(1)
    begun = range(0, rounds, IN_A_ROW)
    return [
        halt
        for done in begun
        for halt in _of_one_stack(name, number, min(IN_A_ROW, rounds - done), chance)
    ]


def _of_one_stack(
    name: str, number: signal.Signals, rounds: int, chance: random.Random
) -> list[Halt]:
    stack = Stack.simulated()
    halts = []
    try:
        for _ in range(rounds):
            # A new one each time: the one before still asks a planner that is dead.
            robot = Watched(stack.domain)
            try:
                robot.ready()
                at_rest(robot)
                full_speed(robot, chance)
                pid = stack.pid_of(name)
                halts.append(robot.after(number, pid))
            finally:
                robot.close()
            if number is signal.SIGSTOP:
                os.kill(pid, signal.SIGCONT)
            else:
                another_than(stack, name, pid)
            time.sleep(1.0)  # whoever came back is found by the others
    finally:
        stack.close()
    return halts


@contextmanager
def base() -> Iterator[int]:
    """The embedded robot as a process of its own, which no supervisor takes along; its domain."""
    domain = next_domain(stack=True)
    process = subprocess.Popen(
        [sys.executable, "-m", "kompass.simulation", "hexagon"],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        stderr=subprocess.DEVNULL,
    )
    try:
        yield domain
    finally:
        process.terminate()
        process.wait(10)
        give_back(domain)


def of_supervisor(rounds: int) -> list[Halt]:
    """The supervisor is killed: what drives the robot goes with it."""
    with TemporaryDirectory() as folder:
        # Commands come from here beside the controller, which the drive manager has to be told.
        recipe = Path(folder, RECIPE.name)
        text, begin = RECIPE.read_text(encoding="utf-8"), "launcher.bringup("
        assert begin in text
        told = f"driver.config.command_publishers = 2\n{begin}"
        recipe.write_text(text.replace(begin, told), encoding="utf-8")
        return [_of_one_supervisor(recipe) for _ in range(rounds)]


def _of_one_supervisor(recipe: Path) -> Halt:
    with base() as domain:
        stack = Stack("run", str(recipe), "--no-browser", "--port", "0", domain=domain)
        robot = Watched(domain)
        try:
            stack.wait_for_line("all components active", 20)
            commands = robot.node.create_publisher(Twist, "/control", 10)
            forward = Twist()
            forward.linear.x = 0.22
            robot.node.create_timer(0.05, lambda: commands.publish(forward))
            wait_until(lambda: robot.track and robot.track[-1].speed > FULL_SPEED, 20, "motion")
            return robot.after(signal.SIGKILL, stack.process.pid)
        finally:
            robot.close()
            stack.close()


def row(name: str, what: str, halts: list[Halt]) -> str:
    """A line of the table."""
    stood = [halt for halt in halts if halt.time is not None]
    times = [halt.time for halt in stood if halt.time is not None]
    count = f"{len(stood)} of {len(halts)}"
    if not times:
        return f"| {name} | {what} | {count} | drives on | |"
    way = [halt.distance for halt in stood]
    return (
        f"| {name} | {what} | {count} | {statistics.median(times):.2f} s, {max(times):.2f} | "
        f"{statistics.median(way):.3f} m, {max(way):.3f} |"
    )


def main() -> None:
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    chosen = sys.argv[2:] or [*PROCESSES, "supervisor"]
    print("| process | signal | stood | standstill: median, worst | way: median, worst |")
    print("|---|---|---|---|---|", flush=True)
    for name in chosen:
        if name == "supervisor":
            print(row(name, "SIGKILL", of_supervisor(rounds)), flush=True)
            continue
        for number in (signal.SIGKILL, signal.SIGSTOP):
            print(row(name, number.name, of_process(name, number, rounds)), flush=True)


if __name__ == "__main__":
    main()
