"""An hour of work: a goal every fifteen seconds, an edit of the rules every minute, a page open.

Looks every half minute at the memory and the handles of every process of the stack. Aim: from the
fifth minute to the end each stays within 3 MiB, with as many handles and threads.

.venv/bin/python benchmarks/working_hour.py [MINUTES] [FOLDER]
"""

import math
import random
import re
import statistics
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parents[1]))
import httpx
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from benchmarks.monitor_soak import SoakStack
from benchmarks.stop_latency import log_in
from tests.recorder.reality import SCAN, compare, rule
from tests.support.robot import Robot

GOAL_EVERY = 15.0  # s
EDIT_EVERY = 60.0  # s
LOOK_EVERY = 30.0  # s
SETTLED = 5.0  # min, after which nothing may grow
GROWTH = 3.0  # MiB
EXTENT = 2.4  # m, half of what goals are chosen in


class Look(NamedTuple):
    """A process at one moment: its own memory [MiB], handles, threads."""

    memory: float
    handles: int
    threads: int


def look(pid: int) -> Look:
    """Look at a process. What it shares with others, and maps of files, are not its own."""
    status = Path(f"/proc/{pid}/status").read_text()
    found = {name: int(value) for name, value in re.findall(r"^(\w+):\s+(\d+)", status, re.M)}
    own = (found["RssAnon"] + found["RssShmem"] + found["VmSwap"]) / 1024
    return Look(own, len(list(Path(f"/proc/{pid}/fd").iterdir())), found["Threads"])


class Work:
    """A person at the page."""

    def __init__(self, url: str) -> None:
        self.url, self.client = url, log_in(url)
        self.done: Counter[str] = Counter()
        self._chance = random.Random(11)
        self._ending = threading.Event()
        self._threads = [
            threading.Thread(target=self._again, args=(self.send_goal, GOAL_EVERY)),
            threading.Thread(target=self._again, args=(self.edit, EDIT_EVERY)),
            *[
                threading.Thread(target=self._watch, args=(path,))
                for path in ("state", "rules/live")
            ],
        ]

    def begin(self) -> None:
        """Start working."""
        for thread in self._threads:
            thread.start()

    def end(self) -> None:
        """Stop working."""
        self._ending.set()
        for thread in self._threads:
            thread.join()
        self.client.close()

    def _again(self, work: Callable[[], str], every: float) -> None:
        due = time.monotonic()
        while not self._ending.wait(max(due - time.monotonic(), 0.0)):
            due += every
            try:
                self.done[work()] += 1
            except httpx.HTTPError as error:
                self.done[f"{work.__name__}: {error}"[:200]] += 1

    def send_goal(self) -> str:
        """To a free place, with a heading."""
        for _ in range(20):
            goal = {
                "x": self._chance.uniform(-EXTENT, EXTENT),
                "y": self._chance.uniform(-EXTENT, EXTENT),
                "yaw": self._chance.uniform(-math.pi, math.pi),
            }
            if self.client.post("/api/goals/check", json=goal).json().get("ok"):
                answer = self.client.post("/api/goals", json=goal)
                return f"goal {answer.status_code}"
        return "no free place found"

    def edit(self) -> str:
        """Another threshold in a rule of one's own, each time; now and then back."""
        asked = self.client.get("/api/rules")
        asked.raise_for_status()
        view: dict[str, Any] = asked.json()
        table, based = view["table"], {"expected_revision": view["revision"]}
        if view["revision"] > 1 and self._chance.random() < 0.2:
            return f"roll back {self.client.post('/api/rules/rollback', json=based).status_code}"
        nearest = {**SCAN, "path": ["ranges"], "aggregate": "min"}
        near = compare(nearest, "<", round(self._chance.uniform(0.2, 0.3), 3))
        made = rule("hourly", near, actions=[{"kind": "log", "text": "near"}])
        table["rules"] = [*(one for one in table["rules"] if one["id"] != "hourly"), made]
        body = {**based, "table": table, "probation": 0, "reason": "an edit of the working hour"}
        answer = self.client.post("/api/rules/apply", json=body)
        return f"edit {answer.status_code}" + ("" if answer.is_success else f" {answer.text[:150]}")

    def _watch(self, path: str) -> None:
        cookie = "; ".join(f"{name}={value}" for name, value in self.client.cookies.items())
        while not self._ending.is_set():
            with connect(
                f"{self.url.replace('http', 'ws')}/api/{path}",
                origin=self.url,
                additional_headers={"Cookie": cookie},
            ) as socket:
                try:
                    while not self._ending.is_set():
                        try:
                            socket.recv(timeout=1.0)
                        except TimeoutError:
                            continue
                except ConnectionClosed:
                    self.done[f"socket {path} was closed"] += 1


def report(looks: dict[str, list[tuple[float, Look]]]) -> bool:
    """A line per process; whether each stayed flat."""
    good = True
    print("| process | own memory at 5 min | at the end | slope | handles | threads |")
    print("|---|---|---|---|---|---|")
    for name, all_ in sorted(looks.items()):
        settled = [one for minute, one in all_ if minute >= SETTLED] or [all_[-1][1]]
        minutes = [minute for minute, _ in all_ if minute >= SETTLED] or [0.0]
        few = max(len(settled) // 10, 1)
        before = statistics.median(one.memory for one in settled[:few])
        after = statistics.median(one.memory for one in settled[-few:])
        slope = 0.0
        if len(settled) > 2:
            fit = statistics.linear_regression(minutes, [one.memory for one in settled])
            slope = 60 * fit.slope
        handles = [one.handles for one in settled]
        threads = [one.threads for one in settled]
        flat = after - before <= GROWTH
        good = good and flat
        print(
            f"| {name} | {before:.1f} MiB | {after:.1f} MiB{'' if flat else ' (grows)'} | "
            f"{slope:+.1f} MiB/h | {min(handles)} … {max(handles)} | "
            f"{min(threads)} … {max(threads)} |"
        )
    return good


def main() -> None:
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    folder = Path(sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp(prefix="hour-"))
    folder.mkdir(parents=True, exist_ok=True)
    SoakStack.log = folder / "stack.log"
    stack = SoakStack.simulated(KOMPASS_ROBOT_NAME="hour")
    looks: dict[str, list[tuple[float, Look]]] = {}
    try:
        with closing(Robot(stack.domain)) as robot:
            robot.ready()
            work = Work(stack.url)
            work.begin()
            began = time.monotonic()
            try:
                while (passed := time.monotonic() - began) < minutes * 60:
                    time.sleep(min(LOOK_EVERY, minutes * 60 - passed))
                    minute = (time.monotonic() - began) / 60
                    pids = dict(re.findall(r"(\w+) is process (\d+)", stack.output))
                    line = [f"{minute:5.1f} min"]
                    for name, pid in {"supervisor": stack.process.pid, **pids}.items():
                        found = look(int(pid))
                        looks.setdefault(name, []).append((minute, found))
                        line.append(f"{name} {found.memory:.1f} {found.handles} {found.threads}")
                    print(" | ".join(line), flush=True)
            finally:
                work.end()
            print(dict(work.done), f"{robot.contacts} contacts", sep="\n")
            restarts = stack.output.count("starts again")
            print(f"{restarts} restarts")
            good = report(looks) and not restarts
    finally:
        stack.close()
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
