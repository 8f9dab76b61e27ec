"""From a message to the start of what a rule does about it, beside the floor of the middleware.

The floor is one rclpy publish → callback between two processes on the events executor, measured in
the same run, turn by turn with the others. A rule's function runs in the monitor: message → rule →
thread. A component's method runs in a process of its own: message → rule → request on its channel.

In the end, a rule of the safety lane while twelve slow rules (3 s each) run.

Aims: function p50 ≤ 1.5 x floor, method p50 ≤ 3 x floor, both p99 ≤ 10 ms, with 1, 50 and 1,000
rules on other fields of the same topic; emergency ≤ 20 ms. A message that comes while the rule's
last run is not over yet starts none, and is counted.

Run: python benchmarks/event_latency.py [TURNS]
"""

import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benchmarks.common import percentile
from benchmarks.recipe_run import prepare_environment, running

CROWDS = (1, 50, 1000)
PAUSE = 0.01  # s between two messages
KINDS = ("floor", "function", "method")
WARM_UP = 20  # turns that do not count
EMERGENCIES = 20  # during one time of the slow rules


def listen(out: str) -> None:
    """The other end of the floor."""
    import rclpy
    from geometry_msgs.msg import TwistStamped
    from rclpy.experimental import EventsExecutor

    rclpy.init()
    node = rclpy.create_node("floor_listener")
    descriptor = os.open(f"{out}/floor", os.O_WRONLY | os.O_CREAT | os.O_APPEND)

    def take(message: TwistStamped) -> None:
        at = time.monotonic_ns()
        os.write(descriptor, f"{message.header.frame_id} {at}\n".encode())

    node.create_subscription(TwistStamped, "/bench/floor", take, 100)
    executor = EventsExecutor()
    executor.add_node(node)
    while True:
        executor.spin_once(timeout_sec=0.1)


@contextmanager
def sender() -> Iterator[tuple[Any, Any, Any]]:
    """Message type, and the publishers of floor and event, once somebody listens to both."""
    import rclpy
    from geometry_msgs.msg import TwistStamped

    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("sender", context=context)
    floor = node.create_publisher(TwistStamped, "/bench/floor", 100)
    event = node.create_publisher(TwistStamped, "/bench/event", 100)
    deadline = time.monotonic() + 10
    while floor.get_subscription_count() + event.get_subscription_count() < 2:
        if time.monotonic() > deadline:
            raise RuntimeError("nobody listens")
        time.sleep(0.05)
    time.sleep(2.0)  # the monitor changes to a reliable reader; services find each other
    yield TwistStamped, floor, event
    time.sleep(0.5)
    node.destroy_node()
    context.try_shutdown()


def send(turns: int) -> dict[str, int]:
    """Publish to all three in turn; when each message was sent [ns], by its id."""
    sent = {}
    with sender() as (kind_of_message, floor, event):
        for turn in range(turns):
            for kind in KINDS:
                message = kind_of_message()
                message.header.frame_id = f"{kind}-{turn}"
                message.twist.linear.x = float(kind == "function")
                message.twist.linear.y = float(kind == "method")
                publisher = floor if kind == "floor" else event
                sent[message.header.frame_id] = time.monotonic_ns()
                publisher.publish(message)
                time.sleep(PAUSE)
    return sent


def send_emergencies(turns: int) -> dict[str, int]:
    """Publish emergencies while all slow rules run; when each was sent [ns], by its id."""
    sent = {}
    with sender() as (kind_of_message, _, event):
        for turn in range(turns):
            if turn % EMERGENCIES == 0:
                time.sleep(0.0 if turn == 0 else 4.0)  # the last of the slow ones have cooled down
                message = kind_of_message()
                message.twist.linear.z = 1.0
                event.publish(message)
                time.sleep(0.5)
            message = kind_of_message()
            message.header.frame_id = f"emergency-{turn}"
            message.twist.angular.x = 1.0
            sent[message.header.frame_id] = time.monotonic_ns()
            event.publish(message)
            time.sleep(10 * PAUSE)
    return sent


def run(
    rules: int,
    turns: int,
    send: Callable[[int], dict[str, int]] = send,
    kinds: tuple[str, ...] = KINDS,
) -> dict[str, list[float]]:
    """Latencies in ms by kind."""
    with tempfile.TemporaryDirectory() as out, running("latency.py", RULES=str(rules), OUT=out):
        listener = get_context("spawn").Process(target=listen, args=(out,))
        listener.start()
        try:
            sent = send(WARM_UP + turns)
        finally:
            assert listener.pid is not None
            os.kill(listener.pid, signal.SIGKILL)
            listener.join()
        found: dict[str, list[float]] = {}
        for kind in kinds:
            arrived = dict(line.split() for line in (Path(out) / kind).read_text().splitlines())
            found[kind] = [
                (int(arrived[key]) - at) / 1e6
                for key, at in list(sent.items())[WARM_UP * len(kinds) :]
                if key.startswith(kind) and key in arrived
            ]
        return found


def main() -> None:
    prepare_environment()
    turns = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    for rules in CROWDS:
        found = run(rules, turns)
        floor = percentile(found["floor"], 0.5)
        print(f"{rules} rules on other fields of the topic")
        for kind in KINDS:
            values = found[kind]
            half = percentile(values, 0.5)
            print(
                f"  {kind:10} p50 {half:6.3f} ms ({half / floor:5.2f} x floor)   "
                f"p99 {percentile(values, 0.99):7.3f} ms   started none: {turns - len(values)}"
            )
    found = run(1, EMERGENCIES, send_emergencies, ("emergency",))
    values = found["emergency"]
    print(
        f"emergency with 12 slow rules running: p50 {percentile(values, 0.5):.3f} ms   "
        f"worst {max(values):.3f} ms   lost {EMERGENCIES - len(values)} of {EMERGENCIES} (aim: 20)"
    )


if __name__ == "__main__":
    main()
