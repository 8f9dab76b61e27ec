"""From the press of STOP to the zero twist and to standstill, on a robot at full speed under load.

The load: twenty pages that watch, back-tests without a pause, and a disk on which no file of the
stack can grow any more. Pressed over HTTP, as the page does. Aims: zero twist p99 50 ms, standstill
0.3 s.

With --map, a map of 2,000 by 2,000 cells is published before each press, up to 0.3 s.

.venv/bin/python benchmarks/stop_latency.py [PRESSES] [--idle] [--map]
"""

import math
import os
import random
import resource
import signal
import subprocess
import sys
import threading
import time
from array import array
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import httpx
import numpy as np
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid
from websockets.sync.client import connect

from benchmarks.common import percentile
from benchmarks.standstill import Watched, full_speed
from kompass.rclpy_ext.topic import LATCHED
from tests.recorder.reality import Reality, reality_table
from tests.support.processes import children, wait_until
from tests.support.stack import TOKEN, Stack

VIEWERS = 20
RECORDED = 20.0  # s before the disk is full, so that there is something to back-test
STANDING = 0.01  # m/s


SIDE = 2000  # cells of the large map
JUST_BEFORE = 0.3  # s


class Listener(Watched):
    """Notes when a zero twist came in."""

    def __init__(self, domain: int) -> None:
        super().__init__(domain)
        self.zeros: list[float] = []
        self.node.create_subscription(Twist, "/cmd_vel", self._command, 10)

    def _command(self, message: Twist) -> None:
        if message == Twist():
            self.zeros.append(time.monotonic())


def log_in(url: str) -> httpx.Client:
    """An operator's client."""
    client = httpx.Client(base_url=url, headers={"Origin": url}, timeout=10.0)
    client.post("/api/login", json={"token": TOKEN, "user": "tester"}).raise_for_status()
    return client


def watch(url: str) -> None:
    """Pages that read all they are sent, until the end of this process."""
    with closing(log_in(url)) as client:
        cookie = "; ".join(f"{name}={value}" for name, value in client.cookies.items())

    def read() -> None:
        address = url.replace("http", "ws") + "/api/state"
        with connect(address, origin=url, additional_headers={"Cookie": cookie}) as socket:
            for _ in socket:
                pass

    threads = [threading.Thread(target=read) for _ in range(VIEWERS)]
    for thread in threads:
        thread.start()
    print("watching", flush=True)
    for thread in threads:
        thread.join()


@contextmanager
def load(stack: Stack, robot: Listener) -> Iterator[dict[str, int]]:
    """Viewers, back-tests and a full disk; how many back-tests came to their end."""
    count = {"back-tests": 0}
    viewers = subprocess.Popen(
        [sys.executable, __file__, "--watch", stack.url], stdout=subprocess.PIPE, text=True
    )
    ended = threading.Event()
    reality = Reality(robot)
    table = reality_table(0.45).model_dump_json()

    def backtest() -> None:
        while not ended.is_set():
            handle = reality.send(table, "", 0.0, lambda _: None)
            if handle.accepted and reality.result(handle, 300).success:
                count["back-tests"] += 1

    thread = threading.Thread(target=backtest)
    try:
        assert viewers.stdout is not None
        viewers.stdout.readline()
        time.sleep(RECORDED)
        for pid in children(stack.process.pid):
            resource.prlimit(pid, resource.RLIMIT_FSIZE, (4096, 4096))
        thread.start()
        yield count
    finally:
        ended.set()
        if thread.ident is not None:
            thread.join()
        reality.close()
        viewers.kill()
        viewers.wait()
        assert viewers.stdout is not None
        viewers.stdout.close()


def publish_maps(domain: int) -> None:
    """The map of the stack amid a large unknown one, once for each line that is read."""
    rclpy.init(args=[], domain_id=domain)
    node = rclpy.create_node("large_map")
    heard: list[OccupancyGrid] = []
    node.create_subscription(OccupancyGrid, "/map", heard.append, LATCHED.to_ros())
    publisher = node.create_publisher(OccupancyGrid, "/map", LATCHED.to_ros())
    while not heard:
        rclpy.spin_once(node, timeout_sec=0.1)
    small = heard[0]
    info = small.info
    cells = np.full((SIDE, SIDE), -1, dtype=np.int8)
    known = np.asarray(small.data, dtype=np.int8).reshape(info.height, info.width)
    up, right = (SIDE - info.height) // 2, (SIDE - info.width) // 2
    cells[up : up + info.height, right : right + info.width] = known
    large = OccupancyGrid(header=small.header, info=info)
    large.info.origin.position.x -= right * info.resolution
    large.info.origin.position.y -= up * info.resolution
    large.info.width = large.info.height = SIDE
    print("ready", flush=True)
    for number, _ in enumerate(sys.stdin):
        cells[0, number % SIDE] = 100  # another map each time, as of somebody who is mapping
        large.data = array("b", cells.tobytes())
        publisher.publish(large)
        print("published", flush=True)


@contextmanager
def large_maps(domain: int) -> Iterator[Callable[[], None]]:
    """What publishes the large map once, when it is called."""
    command = [sys.executable, __file__, "--publish-maps", str(domain)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as program:
        assert program.stdin is not None
        assert program.stdout is not None
        words, answers = program.stdin, program.stdout
        answers.readline()

        def publish() -> None:
            words.write("\n")
            words.flush()
            answers.readline()

        try:
            yield publish
        finally:
            program.kill()


def press(client: httpx.Client, robot: Listener) -> tuple[float, float, float]:
    """Time to the zero twist, to the answer, and to standstill [s]."""
    robot.zeros.clear()
    began = time.monotonic()
    client.post("/api/stop", json={"reason": "benchmark"}).raise_for_status()
    answered = time.monotonic() - began
    wait_until(lambda: robot.zeros, 5, "a zero twist")
    wait_until(lambda: robot.track[-1].speed < STANDING, 5, "standstill")
    stood = next(one.at for one in robot.track if one.at > began and one.speed < STANDING)
    return robot.zeros[0] - began, answered, stood - began


def main() -> None:
    presses = int(next((word for word in sys.argv[1:] if word.isdigit()), "100"))
    chance = random.Random(1)
    stack = Stack.simulated()
    robot = Listener(stack.domain)
    results = []
    try:
        robot.ready()
        with closing(log_in(stack.url)) as client:

            def run(before: Callable[[], None]) -> None:
                for _ in range(presses):
                    full_speed(robot, chance)
                    before()
                    results.append(press(client, robot))
                    client.post("/api/stop/release").raise_for_status()
                    robot.track.clear()

            with ExitStack() as more:
                publish = None
                if "--map" in sys.argv:
                    publish = more.enter_context(large_maps(stack.domain))

                def before() -> None:
                    if publish is not None:
                        publish()
                        time.sleep(chance.uniform(0.0, JUST_BEFORE))

                if "--idle" in sys.argv:
                    run(before)
                else:
                    with load(stack, robot) as count:
                        run(before)
                    print(
                        f"{VIEWERS} viewers, {count['back-tests']} back-tests done, files at 4 KiB"
                    )
        print(f"{'after the press [ms]':24} median   p99   worst  of {len(results)}")
        for name, values in zip(
            ("zero twist", "answer", "standstill"), zip(*results, strict=True), strict=True
        ):
            times = [1000 * value for value in values]
            median, late = percentile(times, 0.5), percentile(times, 0.99)
            print(f"{name:24} {median:6.0f} {late:5.0f} {math.ceil(max(times)):7d}")
    finally:
        robot.close()
        stack.close()


if __name__ == "__main__":
    if sys.argv[1:2] == ["--watch"]:
        signal.signal(signal.SIGTERM, lambda *_: os._exit(0))
        watch(sys.argv[2])
    elif sys.argv[1:2] == ["--publish-maps"]:
        publish_maps(int(sys.argv[2]))
    else:
        main()
