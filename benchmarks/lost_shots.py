"""Whether a message that a rule publishes once is ever lost, and what the journal says of it.

A rule answers each of 1,000 messages with one message; another process counts the answers, and
what the monitor says of each.

Aims: 0 lost; the journal says of each that one listened.

Run: python benchmarks/lost_shots.py [MESSAGES]
"""

import sys
import time
from collections import Counter

from benchmarks.recipe_run import prepare_environment, running

PERIOD = 0.01  # s
PATIENCE = 60.0  # s


def shoot(count: int) -> tuple[list[int], Counter[str]]:
    """Ask so often; which answers came, and what the journal says of them."""
    import rclpy
    from kompass_interfaces.msg import RuleFiring
    from rclpy.executors import SingleThreadedExecutor
    from std_msgs.msg import Int32

    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("asker", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    answers: list[int] = []
    told: Counter[str] = Counter()

    def hear(step: RuleFiring) -> None:
        if step.phase == "action":
            told[step.text] += 1

    node.create_subscription(Int32, "/bench/answer", lambda m: answers.append(m.data), 1000)
    node.create_subscription(RuleFiring, "/monitor/firings", hear, 10 * count)
    publisher = node.create_publisher(Int32, "/bench/asked", 1000)

    def is_heard_reliably() -> bool:
        readers = node.get_subscriptions_info_by_topic("/bench/asked")
        return any(each.qos_profile.reliability.name == "RELIABLE" for each in readers)

    def spin(until: float, enough: int = 0) -> None:
        while time.monotonic() < until and not (enough and told.total() >= enough):
            executor.spin_once(timeout_sec=0.005)

    deadline = time.monotonic() + 10.0
    while not is_heard_reliably():
        if time.monotonic() > deadline:
            raise RuntimeError("nobody listens")
        spin(time.monotonic() + 0.1)
    begin = time.monotonic()
    for number in range(count):
        publisher.publish(Int32(data=number))
        spin(begin + (number + 1) * PERIOD)
    spin(time.monotonic() + PATIENCE, enough=count)
    spin(time.monotonic() + 1.0)  # one more than asked for would be wrong, too
    node.destroy_node()
    context.try_shutdown()
    return answers, told


def main() -> None:
    prepare_environment()
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    with running("shots.py"):
        answers, told = shoot(count)
    lost, twice = count - len(set(answers)), len(answers) - len(set(answers))
    print(f"{count} messages published once: {lost} lost, {twice} twice; the journal says")
    for text, number in told.most_common():
        print(f"{number:6} x {text}")


if __name__ == "__main__":
    main()
