"""Random programs for virtual time, and what came of one, line by line."""

from __future__ import annotations

import sys
from typing import Any, Literal, NamedTuple

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32
from std_srvs.srv import SetBool

from kompass.rclpy_ext.awaitables import Awaitables
from kompass.rclpy_ext.timers import Timers
from kompass.virtual.executor import VirtualExecutor
from kompass.virtual.network import Conditions
from kompass.virtual.node import VirtualNode
from kompass.virtual.process import World

DURATION = 500_000_000  # ns

What = Literal[
    "say", "hear", "serve", "ask", "wait", "think", "kill", "stop", "starve", "restart", "leave"
]


class Step(NamedTuple):
    """Something that a node does, or that is done to its process."""

    what: What
    node: int
    at: int  # ms
    topic: int
    reliable: bool
    latched: bool


def trace(steps: list[Step], seed: int, conditions: Conditions | None = None) -> list[str]:
    """Run a program; everything that happened, with its time."""
    with World(seed, conditions=conditions, lease=0.2) as world:
        return _run(world, steps)


def _run(world: World, steps: list[Step]) -> list[str]:
    lines: list[str] = []
    nodes: dict[int, VirtualNode] = {}

    def note(node: VirtualNode, text: str) -> None:
        lines.append(f"{world.scheduler.now} {node.get_name()} {text}")

    def node_of(number: int) -> VirtualNode:
        if number not in nodes:
            process = world.process(f"process {number}", lambda chance: chance.uniform(1e-5, 1e-3))
            nodes[number] = VirtualNode(process, f"node_{len(lines)}_{number}")
            VirtualExecutor(process, lambda error: lines.append(str(error))).add_node(nodes[number])
        return nodes[number]

    for step in steps:
        world.scheduler.call_later(
            step.at * 1_000_000, lambda step=step: _do(step, node_of(step.node), nodes, note)
        )
    world.scheduler.run_for(DURATION)
    return [*lines, *map(str, world.log)]


def _do(step: Step, node: VirtualNode, nodes: dict[int, VirtualNode], note: Any) -> None:
    topic, process = f"/t{step.topic}", node.process
    profile = QoSProfile(
        depth=1 + step.topic,
        reliability=ReliabilityPolicy.RELIABLE if step.reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if step.latched else DurabilityPolicy.VOLATILE,
    )
    match step.what:
        case "say":
            publisher = node.create_publisher(Int32, topic, profile)
            numbers = iter(range(1_000_000))
            node.create_timer(
                0.001 * (1 + step.topic), lambda: publisher.publish(Int32(data=next(numbers)))
            )
        case "hear":
            node.create_subscription(
                Int32, topic, lambda message: note(node, f"heard {topic} {message.data}"), profile
            )
        case "serve":
            node.create_service(SetBool, f"{topic}/ask", lambda _, answer: answer)
        case "ask":
            client = node.create_client(SetBool, f"{topic}/ask")

            def ask() -> None:
                call = client.call_async(SetBool.Request())
                call.add_done_callback(lambda _: note(node, f"was answered {topic}"))

            node.create_timer(0.005, ask)
        case "wait":
            wait = Awaitables(Timers(node), node.executor)

            async def turn() -> None:
                for number in range(20):
                    await wait.sleep(0.003)
                    note(node, f"waited {number}")

            node.executor.create_task(turn)
        case "think":
            thought = node.threads(2, "thoughts").submit(lambda: step.at)
            thought.add_done_callback(
                lambda made: node.executor.create_task(note, node, f"thought {made.result()}")
            )
        case "kill":
            if not process.dead:
                note(node, "is killed")
            process.kill()
        case "stop":
            process.stop()
            process.world.scheduler.call_later(20_000_000, process.go_on)
        case "starve":
            process.slowness = 3.0
        case "restart":
            process.kill()
            del nodes[step.node]
        case "leave":
            process.end()
            del nodes[step.node]


_FIXED: list[tuple[What, int, int]] = [
    ("say", 0, 1), ("hear", 1, 1), ("hear", 2, 1), ("serve", 0, 2), ("ask", 1, 2),
    ("wait", 2, 0), ("say", 2, 0), ("hear", 0, 0), ("think", 1, 0), ("stop", 1, 0),
    ("kill", 0, 0), ("restart", 0, 0), ("serve", 0, 2), ("hear", 0, 0), ("starve", 2, 0),
]  # fmt: skip
FIXED = [
    Step(what, node, 7 * number, topic, reliable=bool(number % 3), latched=not number % 4)
    for number, (what, node, topic) in enumerate(_FIXED)
]

if __name__ == "__main__":
    sys.stdout.write("\n".join(trace(FIXED, seed=3)))
