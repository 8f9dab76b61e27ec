"""Wear on a running stack: rules that fire, edits, back-tests, and others that come, go and die.

    python benchmarks/monitor_soak.py [MINUTES] [FOLDER]

A simulated robot drives to and fro. All at once its rules are changed and rolled back, its ring is
back-tested (to the end, cancelled, and for a client that is killed), everything is looked at,
publishers come with another quality of service and are killed, clients are killed before their
answer comes, and pages open and drop their sockets.

Aim: no process dies, and none of them grows for ever. What the stack said is left in FOLDER, and a
core if there was a crash.
"""

import itertools
import json
import logging
import os
import random
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parents[1]))

import httpx
from kompass_interfaces.srv import DescribeGraph, SaveRecording, SetFault
from websockets.sync.client import connect

from tests.recorder.reality import SCAN, Reality, compare, reality_table, rule
from tests.support.robot import Robot
from tests.support.rules import Rules
from tests.support.stack import TOKEN, Stack

ROOT = Path(__file__).parents[1]
WATCHED = ("monitor", "recorder", "console")
PERIOD = 30.0  # s between two looks at the processes
TOPICS = [f"soak_{number}" for number in range(8)]
TALKERS = 4
GROWTH = 1.1  # of memory, from the second quarter of the run to the last
# Of what the stack says, what tells of a death or of a trouble.
TELLING = re.compile(
    r"is process|is up|Console:|all components|killed|starts again|given up|stuck|Fatal|File \"|"
    r"Traceback|Error|refused something|ended with|nothing is recorded|lost so far"
)


class SoakStack(Stack):
    """Writes what is said to a file, and keeps the telling lines."""

    log: Path

    def _read(self) -> None:
        assert self.process.stdout is not None
        with self.log.open("w") as file:
            for line in self.process.stdout:
                file.write(line)
                if TELLING.search(line):
                    self.output += line


class Look(NamedTuple):
    """A process at one moment; memory in MiB."""

    memory: float
    descriptors: int
    threads: int


def look(pid: int) -> Look:
    """Look at a process."""
    status = Path(f"/proc/{pid}/status").read_text()
    found = dict(re.findall(r"^(VmRSS|Threads):\s+(\d+)", status, re.MULTILINE))
    descriptors = len(list(Path(f"/proc/{pid}/fd").iterdir()))
    return Look(int(found["VmRSS"]) / 1024, descriptors, int(found["Threads"]))


class Soak:
    """The stack, and those that wear on it, each in a thread of its own."""

    def __init__(self, stack: Stack, robot: Robot) -> None:
        self.stack, self.robot = stack, robot
        self.rules, self.reality = Rules(robot), Reality(robot)
        self.done: Counter[str] = Counter()
        self.problems: Counter[str] = Counter()
        self.chance = random.Random(7)
        self._ended = threading.Event()
        self._threads: list[threading.Thread] = []

    def begin(self, *wears: tuple[Callable[[], None], float]) -> None:
        """Have each called again and again, with a pause of some seconds."""
        for wear, pause in wears:
            thread = threading.Thread(target=self._again, args=(wear, pause))
            thread.start()
            self._threads.append(thread)

    def end(self) -> None:
        """Wait for all to come to their end."""
        self._ended.set()
        for thread in self._threads:
            thread.join()

    def _again(self, wear: Callable[[], None], pause: float) -> None:
        name = wear.__name__
        while not self._ended.wait(pause * self.chance.uniform(0.5, 1.5)):
            try:
                wear()
                self.done[name] += 1
            except Exception as error:  # noqa: BLE001 - counted; the stack is what is tested
                self.problems[f"{name}: {type(error).__name__}: {str(error)[:200]}"] += 1

    # -- edits --------------------------------------------------------------------------------

    def edit(self) -> None:
        """Put another table in force, with other topics; now and then go back."""
        if self.chance.random() < 0.2:
            self.rules.roll_back(cancel_running=self.chance.random() < 0.5)
            return
        table = json.loads(reality_table(0.45).model_dump_json())["rules"]
        table += [self._rule(number) for number in range(self.chance.randint(5, 25))]
        answer = self.rules.apply(
            table,
            probation=self.chance.choice([0.0, 0.0, 3.0]),
            cancel_running=self.chance.random() < 0.3,
        )
        if answer.outcome != 0:
            raise RuntimeError(answer.message)

    def _rule(self, number: int) -> dict[str, Any]:
        pick = self.chance.choice
        topic = {"topic": pick(TOPICS), "type": "std_msgs/msg/Int32"}
        value = {**topic, "path": ["data"]}
        condition = pick(
            [
                compare(value, ">", self.chance.randint(0, 100)),
                {"kind": "changed", "signal": value},
                {"kind": "absent", "signal": topic, "seconds": self.chance.uniform(0.3, 2.0)},
                {"kind": "rate", **topic, "below": 20.0, "window": 1.0},
                compare({**SCAN, "path": ["ranges"], "aggregate": "min"}, "<", 0.6),
            ]
        )
        note = {"kind": "publish", "topic": "/note", "type": "std_msgs/msg/String"}
        actions = pick(
            [
                [{**note, "message": {"data": "soak"}}],
                [{"kind": "raise_alarm", "alarm": f"a{number}"}],
                [{"kind": "raise_alarm", "alarm": "b"}, {"kind": "clear_alarm", "alarm": "b"}],
                [{"kind": "method", "component": "planner", "method": "broadcast_status"}],
                [{"kind": "call_service", "service": "nobody", "type": "std_srvs/srv/Empty"}],
            ]
        )
        how = {"trigger": pick(["edge", "level"]), "cooldown": self.chance.uniform(0.3, 3.0)}
        made = rule(f"soak-{number}", condition, **how, actions=actions)
        return {**made, "shadow": self.chance.random() < 0.2, "severity": pick(["info", "error"])}

    # -- back-tests ---------------------------------------------------------------------------

    def backtest(self) -> None:
        """All of the ring, to the end or cancelled half-way."""
        table = reality_table(self.chance.uniform(0.3, 0.6)).model_dump_json()
        half = threading.Event()

        def hear(share: float) -> None:
            if share > 0.4:
                half.set()

        handle = self.reality.send(table, "", 0.0, hear)
        if not handle.accepted:
            raise RuntimeError("refused")
        if self.chance.random() < 0.4:
            half.wait(20)
            self.robot.cancel(handle)
            self.reality.result(handle)
        else:
            result = self.reality.result(handle, 300)
            if not result.success:
                raise RuntimeError(result.message)

    def killed_backtest(self) -> None:
        """For a client that is killed half-way."""
        self._killed("backtester", str(self.stack.domain), after=self.chance.uniform(0.3, 3.0))

    # -- looks --------------------------------------------------------------------------------

    def looks(self) -> None:
        """Everything that one can ask."""
        for each in self.rules.view().table.rules[:6]:
            self.rules.explain(each.id)
        self.rules.history()
        self.rules.journal()
        self.rules.call(DescribeGraph.Request())

    def save(self) -> None:
        """Keep a stretch, and throw it away."""
        answer = self.robot.call(
            SaveRecording, "/monitor/save_recording", SaveRecording.Request(seconds=20.0), 60
        )
        if not answer.success:
            raise RuntimeError(answer.message)
        Path(answer.path).unlink()

    def killed_client(self) -> None:
        """One that asks a lot and is killed before all answers have come."""
        self._killed("asker", str(self.stack.domain), after=self.chance.uniform(0.0, 1.0))

    def _killed(self, *role: str, after: float) -> None:
        with _role(*role) as process:
            assert process.stdout is not None
            process.stdout.readline()  # it has begun
            time.sleep(after)
            process.kill()

    # -- others -------------------------------------------------------------------------------

    def talker(self) -> None:
        """A publisher with a quality of service of its own, killed after a while."""
        topic = self.chance.choice(TOPICS)
        reliable, latched = (str(self.chance.randint(0, 1)) for _ in range(2))
        with _role("talker", str(self.stack.domain), topic, reliable, latched) as process:
            self._ended.wait(self.chance.uniform(3.0, 12.0))
            process.kill()

    def drive(self) -> None:
        """To the next corner; now and then blind for a moment."""
        self.robot.click(
            *self.chance.choice([(-0.5, -0.55), (-1.6, 0.5), (-0.5, 0.55)]), taker="planner"
        )
        if self.chance.random() < 0.3:
            request = SetFault.Request(fault="lidar_unplugged", on=True, duration=1.0)
            self.robot.call(SetFault, "/simulator/set_fault", request)

    def page(self) -> None:
        """A page that watches, probes, looks up, and drops its sockets."""
        url = self.stack.url
        origin = {"Origin": url}
        with httpx.Client(base_url=url, headers=origin, timeout=20.0) as client:
            client.post("/api/login", json={"token": TOKEN}).raise_for_status()
            cookie = "; ".join(f"{name}={value}" for name, value in client.cookies.items())
            sockets = [
                connect(
                    url.replace("http", "ws") + path,
                    origin=url,
                    additional_headers={"Cookie": cookie},
                    close_timeout=0.2,
                )
                for path in ("/api/state", "/api/rules/live", "/api/rules/probe")
            ]
            for number, topic in enumerate(self.chance.sample(TOPICS, 3)):
                signal = {"topic": topic, "type": "std_msgs/msg/Int32", "path": ["data"]}
                probe = {"id": str(number), "condition": compare(signal, ">", 3)}
                sockets[2].send(json.dumps(probe))
            for path in ("/api/rules", "/api/rules/graph", "/api/firings"):
                client.get(path)
            for socket in sockets:
                socket.recv(timeout=10)
            time.sleep(self.chance.uniform(0.0, 2.0))
            for socket in sockets:
                if self.chance.random() < 0.5:
                    socket.socket.close()  # as when a tablet goes out of reach
                socket.close()


def _role(*words: str) -> "subprocess.Popen[str]":
    command = [sys.executable, __file__, "--role", *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


# -- in processes of their own ------------------------------------------------------------------


def talk(domain: int, topic: str, reliable: bool, latched: bool) -> None:
    """Publish 50 times a second until killed."""
    import rclpy
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from std_msgs.msg import Int32

    rclpy.init(args=[], domain_id=domain)
    node = rclpy.create_node("talker")
    qos = QoSProfile(
        depth=10,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )
    publisher = node.create_publisher(Int32, topic, qos)
    for number in itertools.count():
        publisher.publish(Int32(data=number % 120))
        time.sleep(0.02)


def ask(domain: int) -> None:
    """Ask the monitor without end, and never wait for an answer."""
    robot = Robot(domain)
    rules = Rules(robot)
    from kompass_interfaces.srv import CheckRules, GetFirings, GetHistory, GetRules

    text = reality_table(0.4).model_dump_json()
    print("begun", flush=True)
    while True:
        rules.begin(GetRules.Request())
        rules.begin(CheckRules.Request(table=text, role="operator"))
        rules.begin(DescribeGraph.Request())
        rules.begin(GetFirings.Request(count=1000))
        rules.begin(GetHistory.Request(count=1000))
        time.sleep(0.1)


def backtest(domain: int) -> None:
    """Begin back-tests of the ring, and wait for their end."""
    reality = Reality(Robot(domain))
    table = reality_table(0.4).model_dump_json()
    print("begun", flush=True)
    while True:
        reality.result(reality.send(table, ""), 600)


# -- the run ------------------------------------------------------------------------------------


def main() -> None:
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 25.0
    folder = Path(sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp(prefix="soak-"))
    folder.mkdir(parents=True, exist_ok=True)
    # Of sockets that are dropped on purpose.
    logging.getLogger("websockets").setLevel(logging.CRITICAL)
    resource.setrlimit(resource.RLIMIT_CORE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    os.chdir(folder)
    SoakStack.log = folder / "stack.log"
    stack = SoakStack.simulated(KOMPASS_ROBOT_NAME="soak")
    robot = Robot(stack.domain)
    looks: dict[str, list[Look]] = {name: [] for name in WATCHED}
    try:
        robot.ready()
        soak = Soak(stack, robot)
        soak.begin(
            (soak.edit, 1.5),
            (soak.backtest, 10.0),
            (soak.killed_backtest, 20.0),
            (soak.killed_client, 15.0),
            (soak.looks, 2.0),
            (soak.save, 30.0),
            (soak.drive, 3.0),
            (soak.page, 4.0),
            *[(soak.talker, 1.0)] * TALKERS,
        )
        began = time.monotonic()
        try:
            while (passed := time.monotonic() - began) < minutes * 60:
                time.sleep(min(PERIOD, minutes * 60 - passed))
                line = [f"{(time.monotonic() - began) / 60:5.1f} min"]
                for name in WATCHED:
                    found = look(stack.pid_of(name))
                    looks[name].append(found)
                    line.append(f"{name} {found.memory:.0f} MiB {found[1]} fds {found[2]} thr")
                print(" | ".join(line), flush=True)
        finally:
            soak.end()
        sys.exit(0 if report(stack, soak, looks) else 1)
    finally:
        robot.close()
        stack.close()


def report(stack: Stack, soak: Soak, looks: dict[str, list[Look]]) -> bool:
    """Say what came of it; whether all is well."""
    print("done:", dict(soak.done))
    for problem, count in soak.problems.most_common(20):
        print(f"  {count} × {problem}")
    deaths = re.findall(r".*starts again.*", stack.output)
    print(f"{len(deaths)} restarts", *deaths, sep="\n  ")
    good = not deaths
    for name, all_ in looks.items():
        quarter = max(len(all_) // 4, 1)
        early, late = all_[quarter : 2 * quarter] or all_, all_[-quarter:]
        before, after = (
            Look(*map(statistics.median, zip(*part, strict=True))) for part in (early, late)
        )
        print(
            f"{name}: {before.memory:.0f} → {after.memory:.0f} MiB, "
            f"{before.descriptors:.0f} → {after.descriptors:.0f} descriptors, "
            f"{before.threads:.0f} → {after.threads:.0f} threads"
        )
        good = good and after.memory <= before.memory * GROWTH + 5.0
    return good


ROLES: dict[str, Callable[..., None]] = {
    "talker": lambda domain, topic, reliable, latched: talk(
        int(domain), topic, reliable == "1", latched == "1"
    ),
    "asker": lambda domain: ask(int(domain)),
    "backtester": lambda domain: backtest(int(domain)),
}

if __name__ == "__main__":
    if sys.argv[1:2] == ["--role"]:
        ROLES[sys.argv[2]](*sys.argv[3:])
    else:
        main()
