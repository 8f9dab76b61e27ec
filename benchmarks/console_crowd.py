"""What a crowd costs the console: twenty pages with live scenes, and everything that misbehaves.

For all the time: twenty operators' pages, each with its scene and its state, on a robot that drives
from goal to goal; a page that is frozen (its sockets are never read), one on a slow line (20 kB/s),
one that floods its scene, and five hundred connections that say nothing. Aims for the console: at
most 60 % of a core, at most 20 MiB more, which it gives back, and for the others a state that is at
most 150 ms old (p95).

.venv/bin/python benchmarks/console_crowd.py [MINUTES]
"""

import asyncio
import contextlib
import json
import logging
import random
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
import httpx
import msgspec
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import WebSocketException

from benchmarks.common import cpu_seconds, percentile, pss
from benchmarks.stop_latency import log_in
from tests.console.scene_client import camera_message
from tests.support.robot import Robot
from tests.support.stack import Stack

PAGES = 20  # of which the first costs most: what it needs is loaded then, and stays
IDLE = 500
SLOW = 20_000  # bytes/s
FLOOD = msgspec.msgpack.encode({"type": "ViewerCameraMessage", "wxyz": b"x" * 7_900_000})
LOOK_EVERY = 10.0  # s
EXTENT = 2.2  # m, half of what goals are chosen in


class Page:
    """One browser: its session, its view and its two sockets."""

    def __init__(self, url: str) -> None:
        self._url = url
        with contextlib.closing(log_in(url)) as client:
            self._cookie = "; ".join(f"{name}={value}" for name, value in client.cookies.items())
            self._view = client.post("/api/views").json()["id"]

    def state(self, **more: int) -> connect:
        """Open the socket of states."""
        return self._open("/api/state", **more)

    def scene(self, **more: int) -> connect:
        """Open the socket of the scene."""
        return self._open(f"/scene/{self._view}", subprotocols=["viser-v1.1.1"], **more)

    def _open(self, path: str, **more: object) -> connect:
        return connect(
            self._url.replace("http", "ws") + path,
            origin=self._url,
            additional_headers={"Cookie": self._cookie},
            compression=None,
            max_size=None,
            open_timeout=30,
            close_timeout=0.5,
            **more,
        )


async def again(attempt: Callable[[], Awaitable[None]]) -> None:
    """What is closed comes back, as a page does."""
    while True:
        with contextlib.suppress(WebSocketException, OSError):
            await attempt()
        await asyncio.sleep(0.5)


async def attend(page: Page, ages: list[float]) -> None:
    """Read states and scene, and look round now and then."""

    async def states() -> None:
        async with page.state() as socket:
            async for message in socket:
                state = json.loads(message)
                if state["type"] == "state":
                    ages.append(time.time() - state["time"])

    async def scene() -> None:
        async with page.scene() as socket:
            await socket.send(msgspec.msgpack.encode(camera_message()))
            async for _ in socket:
                pass

    await asyncio.gather(again(states), again(scene))


async def freeze(page: Page) -> None:
    """Never read what comes."""

    async def hold(opened: connect) -> None:
        async with opened as socket:
            socket.transport.pause_reading()
            await asyncio.sleep(3600)

    await asyncio.gather(
        again(lambda: hold(page.state(max_queue=1))), again(lambda: hold(page.scene(max_queue=1)))
    )


async def crawl(page: Page) -> None:
    """Read as a slow line does."""

    async def scene() -> None:
        async with page.scene(max_queue=1) as socket:
            async for message in socket:
                await asyncio.sleep(len(message) / SLOW)

    await again(scene)


async def flood(page: Page) -> None:
    """Send what a page never sends, as fast as the console takes it."""

    async def send(socket: ClientConnection) -> None:
        while True:
            await socket.send(FLOOD)

    async def scene() -> None:
        async with page.scene() as socket:
            await send(socket)

    await again(scene)


async def idle(url: str) -> None:
    """Hold connections open that say nothing; another for each that is closed."""
    host, _, port = url.removeprefix("http://").partition(":")

    async def hold() -> None:
        reader, writer = await asyncio.open_connection(host, int(port))
        try:
            while await reader.read(1000):
                pass
        finally:
            writer.close()

    await asyncio.gather(*(again(hold) for _ in range(IDLE)))


async def crowd(url: str, pages: int, nuisances: bool) -> None:
    """Be the crowd, and say every some seconds how old the states were."""
    logging.getLogger("websockets.client").setLevel(logging.CRITICAL)
    ages: list[float] = []
    everybody: list[Awaitable[None]] = [attend(Page(url), ages) for _ in range(pages)]
    if nuisances:
        everybody += [freeze(Page(url)), crawl(Page(url)), flood(Page(url)), idle(url)]

    async def tell() -> None:
        while True:
            await asyncio.sleep(LOOK_EVERY)
            print(json.dumps(ages), flush=True)
            ages.clear()

    await asyncio.gather(tell(), *everybody)


def attended(
    stack: Stack, client: httpx.Client, pages: int, nuisances: bool, minutes: float
) -> None:
    """Let a crowd come, and say what it cost."""
    chance = random.Random(3)
    pid = stack.pid_of("console")
    before = most = pss(pid)
    process = subprocess.Popen(
        [sys.executable, __file__, "--crowd", stack.url, str(pages), str(nuisances)],
        stdout=subprocess.PIPE,
        text=True,
    )
    ages: list[float] = []
    try:
        assert process.stdout is not None
        process.stdout.readline()  # while all come in
        began, used = time.monotonic(), cpu_seconds(pid)
        while time.monotonic() - began < minutes * 60:
            place = {"x": chance.uniform(-EXTENT, EXTENT), "y": chance.uniform(-EXTENT, EXTENT)}
            client.post("/api/goals", json=place)  # refused where there is a pillar
            ages += json.loads(process.stdout.readline())
            most = max(most, pss(pid))
        busy = (cpu_seconds(pid) - used) / (time.monotonic() - began)
    finally:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()
    time.sleep(20.0)
    median, late, worst = (1000 * percentile(ages, share) for share in (0.5, 0.95, 1.0))
    grown = f"at most {most - before:+.0f}, afterwards {pss(pid) - before:+.0f}"
    print(
        f"| {pages}{' and nuisances' if nuisances else ''} | {100 * busy:.0f} % | "
        f"{before:.0f} MiB, {grown} | {median:.0f} ms, {late:.0f}, {worst:.0f} | {len(ages)} |",
        flush=True,
    )


def main() -> None:
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    stack = Stack.simulated()
    try:
        with contextlib.closing(Robot(stack.domain)) as robot:
            robot.ready()
        print("| pages | of a core | memory | age of states: median, p95, worst | states |")
        print("|---|---|---|---|---|", flush=True)
        with contextlib.closing(log_in(stack.url)) as client:
            for pages, nuisances in ((1, False), (PAGES, False), (PAGES, True)):
                attended(stack, client, pages, nuisances, minutes if nuisances else 0.5)
    finally:
        stack.close()


if __name__ == "__main__":
    if sys.argv[1:2] == ["--crowd"]:
        asyncio.run(crowd(sys.argv[2], int(sys.argv[3]), sys.argv[4] == "True"))
    else:
        main()
