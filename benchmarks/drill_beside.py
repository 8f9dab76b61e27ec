"""What a drill on the robot's own computer takes from the robot: jitter of commands, event latency.

The stack drives from click to click, in turns with a drill beside it (as the page begins one) and
without. Jitter is how far the time between two commands is from its median; latency is
from a click's publishing to the news that its rule has fired. What measures runs before all
others, where it may (as root): it is no part of the robot's session, and would wait for the drill.

.venv/bin/python benchmarks/drill_beside.py [SECONDS] [TURNS]
"""

from __future__ import annotations

import itertools
import os
import signal
import statistics
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import httpx
import rclpy
from geometry_msgs.msg import PointStamped, Twist
from kompass_interfaces.msg import RuleFiring
from rclpy.signals import SignalHandlerOptions

from benchmarks.common import percentile
from kompass.rclpy_ext.executor import TaskExecutor
from kompass.rclpy_ext.node import PlainNode
from tests.support.stack import TOKEN, Stack

RECIPE = Path(__file__).parents[1] / "recipes" / "03_events_and_actions.py"
PLACES = ((1.9, 0.0), (-1.0, 1.6), (0.0, -1.7))
CLICK = 1.0  # s between two
STANDSTILL = 0.5  # s; longer intervals are between two ways, and not of the control loop
WARM_UP = 10.0  # s for a drill to have its processes, and for the first way to begin
AIM = 1.1  # with the drill, over without


class Measured:
    """Times of one kind of stretch, with a drill or without."""

    def __init__(self) -> None:
        self.intervals: list[float] = []
        self.latencies: list[float] = []

    @property
    def jitter(self) -> float:
        """99th percentile of how far an interval is from the median [ms]."""
        usual = statistics.median(self.intervals)
        return 1000 * percentile([abs(each - usual) for each in self.intervals], 0.99)

    def latency(self, share: float) -> float:
        """A percentile of them [ms]."""
        return 1000 * percentile(self.latencies, share)


class Watch:
    """Clicks, and takes the times of what comes of it."""

    def __init__(self, node: PlainNode, executor: TaskExecutor) -> None:
        self._executor = executor
        self._into: Measured | None = None
        self._commanded = self._clicked = 0.0
        self._places = itertools.cycle(PLACES)
        self._clicks = node.create_publisher(PointStamped, "/clicked_point", 10)
        node.create_subscription(Twist, "/cmd_vel", self._on_command, 10)
        node.create_subscription(RuleFiring, "/monitor/firings", self._on_firing, 10)
        node.create_timer(CLICK, self._click)

    def take(self, seconds: float, into: Measured | None) -> None:
        """Let time pass, and note it."""
        self._into, self._commanded, self._clicked = into, 0.0, 0.0
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.1)

    def _click(self) -> None:
        message = PointStamped()
        message.header.frame_id = "map"
        message.point.x, message.point.y = next(self._places)
        self._clicked = time.monotonic()
        self._clicks.publish(message)

    def _on_command(self, _: Twist) -> None:
        now = time.monotonic()
        interval = now - self._commanded
        if self._into is not None and interval < STANDSTILL:
            self._into.intervals.append(interval)
        self._commanded = now

    def _on_firing(self, firing: RuleFiring) -> None:
        if firing.rule_id == "click-to-goal" and firing.phase == "fired" and self._clicked:
            if self._into is not None:
                self._into.latencies.append(time.monotonic() - self._clicked)
            self._clicked = 0.0


def _measure_first() -> None:
    """Have this process, and the threads that it is going to have, wait for nobody."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except PermissionError:
        _say("what measures may wait for the drill, too: only root can have it run before")


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    turns = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    signal.signal(signal.SIGTERM, _end)  # so that what was started ends, too
    takes = WARM_UP + turns * (WARM_UP + 2 * seconds)
    _say(f"{turns} turns of {seconds:g} s without a drill and {seconds:g} s with: {takes:.0f} s")
    stack = Stack.simulated("--sim=hexagon", recipe=RECIPE)
    _measure_first()
    console = httpx.Client(base_url=stack.url, headers={"Origin": stack.url}, timeout=30.0)
    console.post("/api/login", json={"token": TOKEN, "user": "measured"}).raise_for_status()
    context = rclpy.Context()
    options = SignalHandlerOptions.NO
    rclpy.init(args=[], context=context, domain_id=stack.domain, signal_handler_options=options)
    node = PlainNode("watch", context=context)
    executor = TaskExecutor(context)
    executor.add_node(node)
    watch, without, beside = Watch(node, executor), Measured(), Measured()
    try:
        watch.take(WARM_UP, None)
        for turn in range(turns):
            watch.take(seconds, without)
            _say(f"turn {turn + 1} of {turns}: without a drill, load {os.getloadavg()[0]:.1f}")
            with _drill(console) as drill:
                watch.take(WARM_UP, None)
                watch.take(seconds, beside)
                told = console.get(f"/api/drills/{drill}").json()
                if told["state"] != "running" or not told["done"]:
                    raise RuntimeError(f"the drill does not drive: {told}")
            load = os.getloadavg()[0]
            _say(f"turn {turn + 1} of {turns}: with one, load {load:.1f}, {told['done']} drives")
    finally:
        executor.shutdown()
        node.destroy_node()
        console.close()
        context.try_shutdown()
        stack.close()
    counts = f"{len(without.latencies)} clicks without, {len(beside.latencies)} beside a drill"
    print(f"{counts}; with a hundred or so their p99 is the second largest of them")
    for name, alone, with_drill in (
        ("jitter of commands, p99", without.jitter, beside.jitter),
        *(
            (f"event latency, p{share:.0%}"[:-1], without.latency(share), beside.latency(share))
            for share in (0.5, 0.9, 0.99)
        ),
    ):
        ratio = with_drill / alone
        mark = "" if ratio <= AIM else " ✗"
        print(
            f"{name}: {alone:.1f} ms without, {with_drill:.1f} ms beside a drill: "
            f"{ratio:.2f} × (aim {AIM} ×{mark})"
        )


@contextmanager
def _drill(console: httpx.Client) -> Iterator[str]:
    """More drives than there is time for, begun as the page begins them; the drill's id."""
    table = console.get("/api/rules").json()["table"]
    answer = console.post("/api/drills", json={"table": table, "drives": 200})
    answer.raise_for_status()
    drill = str(answer.json()["id"])
    try:
        yield drill
    finally:
        console.delete(f"/api/drills/{drill}").raise_for_status()


def _end(number: int, _: object) -> None:
    raise SystemExit(128 + number)


def _say(text: str) -> None:
    print(text, flush=True)


if __name__ == "__main__":
    main()
