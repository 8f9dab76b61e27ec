"""Whether a trigger is ever lost at 1,000 messages a second, and what a message costs the monitor.

Every tenth message is an edge of the rule that fires; its function writes the message's id down.
Then the same with 1,000 rules on that field, of which that one matches.

Aims: 0 lost in 30 s; CPU time per message with 1,000 rules ≤ 3 x that with 1.

Run: python benchmarks/lost_triggers.py [SECONDS]
"""

import json
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.common import cpu_seconds
from benchmarks.recipe_run import prepare_environment, running

RATE = 1000  # messages/s
EVERY = 10
ROUNDS = 2  # of each, in turn: the machine has other work to do


def send(seconds: float, monitor: int) -> tuple[int, int, float]:
    """Publish; how many messages, how many of them the engine saw, CPU seconds of the monitor."""
    import rclpy
    from geometry_msgs.msg import TwistStamped
    from kompass_interfaces.msg import RulesState
    from rclpy.qos import DurabilityPolicy, QoSProfile

    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("sender", context=context)
    publisher = node.create_publisher(TwistStamped, "/bench/event", 1000)
    deadline = time.monotonic() + 10
    while not publisher.get_subscription_count():
        if time.monotonic() > deadline:
            raise RuntimeError("nobody listens")
        time.sleep(0.05)
    time.sleep(2.0)  # the monitor changes to a reliable reader
    count = int(RATE * seconds)
    messages = [TwistStamped() for _ in range(2)]
    messages[1].twist.linear.x = 1.0
    before = cpu_seconds(monitor)
    begin = time.monotonic()
    for number in range(count):
        message = messages[number % EVERY == 0]
        message.header.frame_id = str(number)
        publisher.publish(message)
        time.sleep(max(0.0, begin + (number + 1) / RATE - time.monotonic()))
    time.sleep(2.0)
    busy = cpu_seconds(monitor) - before
    seen: list[int] = []

    def take(state: RulesState) -> None:
        rules = json.loads(state.rules)
        seen.extend(rule["evaluated"] for rule in rules if rule["rule_id"] == "edge")

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(RulesState, "/monitor/rules_state", take, latched)
    from rclpy.executors import SingleThreadedExecutor

    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    deadline = time.monotonic() + 3.0
    while time.monotonic() < deadline:
        executor.spin_once(timeout_sec=0.1)
    node.destroy_node()
    context.try_shutdown()
    return count, max(seen, default=0), busy


def run(rules: int, seconds: float) -> float:
    """CPU time of the monitor per message [s]."""
    with tempfile.TemporaryDirectory() as out:
        with running("triggers.py", RULES=str(rules), OUT=out) as recipe:
            sent, seen, busy = send(seconds, recipe.pids["monitor"])
        fired = (Path(out) / "fired").read_text().split()
    wanted = {str(number) for number in range(0, sent, EVERY)}
    print(
        f"{rules:5} rules: {sent} messages, {sent - seen} not seen; {len(wanted)} triggers, "
        f"{len(wanted - set(fired))} lost, {len(fired) - len(set(fired))} twice; "
        f"{1e6 * busy / sent:.0f} us of CPU per message"
    )
    return busy / sent


def main() -> None:
    prepare_environment()
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 30.0
    costs: dict[int, list[float]] = {1: [], 1000: []}
    for _ in range(ROUNDS):
        for rules, found in costs.items():
            found.append(run(rules, seconds))
    print(f"1,000 rules cost {min(costs[1000]) / min(costs[1]):.2f} x one rule (aim: 3)")


if __name__ == "__main__":
    main()
