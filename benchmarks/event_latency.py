"""From a message to the start of what a rule does about it, beside the floor of the middleware.

The floor is one rclpy publish → callback between two processes on the events executor, measured in
the same run, turn by turn with the others. A rule's function runs in the monitor: message → rule →
thread. A component's method runs in a process of its own: message → rule → service call.

Aims: function p50 ≤ 1.5 x floor, method p50 ≤ 3 x floor, both p99 ≤ 10 ms, with 1, 50 and 1,000
rules on other fields of the same topic.

Run: python benchmarks/event_latency.py [TURNS]
"""

import os
import signal
import sys
import tempfile
import time
from multiprocessing import get_context
from pathlib import Path

from common import percentile
from recipe_run import prepare_environment, running

CROWDS = (1, 50, 1000)
PAUSE = 0.01  # s between two messages
KINDS = ("floor", "function", "method")
WARM_UP = 20  # turns that do not count


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


def send(turns: int) -> dict[str, int]:
    """Publish to all three in turn; when each message was sent [ns], by its id."""
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
    sent = {}
    for turn in range(turns):
        for kind in KINDS:
            message = TwistStamped()
            message.header.frame_id = f"{kind}-{turn}"
            message.twist.linear.x = float(kind == "function")
            message.twist.linear.y = float(kind == "method")
            publisher = floor if kind == "floor" else event
            sent[message.header.frame_id] = time.monotonic_ns()
            publisher.publish(message)
            time.sleep(PAUSE)
    time.sleep(0.5)
    node.destroy_node()
    context.try_shutdown()
    return sent


def run(rules: int, turns: int) -> dict[str, list[float]]:
    """Latencies in ms by kind."""
    with tempfile.TemporaryDirectory() as out, running("latency.py", RULES=str(rules), OUT=out):
        listener = get_context("spawn").Process(target=listen, args=(out,))
        listener.start()
        try:
            sent = send(turns + WARM_UP)
        finally:
            assert listener.pid is not None
            os.kill(listener.pid, signal.SIGKILL)
            listener.join()
        found: dict[str, list[float]] = {}
        for kind in KINDS:
            arrived = dict(line.split() for line in (Path(out) / kind).read_text().splitlines())
            found[kind] = [
                (int(arrived[key]) - at) / 1e6
                for key, at in list(sent.items())[WARM_UP * len(KINDS) :]
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
                f"p99 {percentile(values, 0.99):7.3f} ms   lost {turns - len(values)}"
            )


if __name__ == "__main__":
    main()
