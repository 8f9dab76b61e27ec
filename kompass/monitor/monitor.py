"""The monitor: feeds the rule engine with messages and time, and carries out what fires."""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from typing import Any

import rclpy
from builtin_interfaces.msg import Time
from kompass_interfaces.msg import ProcessState, RuleFiring, StackState
from rclpy.executors import Executor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from kompass.components.topic import LATCHED, QoSConfig
from kompass.launch.process import Report
from kompass.launch.pulse import beat
from kompass.monitor.action_runner import ActionRunner, Outcome
from kompass.monitor.rule_inputs import RuleInputs
from kompass.monitor.spokesman import Spokesman
from kompass.recipe.table import RecipeRules
from kompass.rules.compiled import compile_table
from kompass.rules.conditions import CallableCondition
from kompass.rules.engine import initial_state, step
from kompass.rules.firing import Done, Firing, Input, Note, Sample, Tick
from kompass.rules.schedule import next_deadline

NAME = "monitor"
SPIN_TIMEOUT = 0.1  # s, as of the components' host
FIT_PERIOD = 0.5  # s between looks at the publishers of the rules' topics
REPEAT_PERIOD = 0.4  # s between repetitions for those who are silent
POLL_RATE = 10.0  # Hz, for a function that states no rate of its own
SILENT = ("stuck", "dead", "given up")  # who cannot speak is spoken for


class Monitor:
    """The shell around the pure engine, on one node and one thread.

    Parameters
    ----------
    node, executor
        Where it runs.
    recipe
        Rules, and the functions that they name.
    """

    def __init__(self, node: Node, executor: Executor, recipe: RecipeRules) -> None:
        self._node, self._executor = node, executor
        self._table = compile_table(recipe.table)
        self._state = initial_state(self._table, time.monotonic())
        self._runner = ActionRunner(node, executor, recipe.functions)
        self._spokesman = Spokesman(node)
        self._processes: dict[str, ProcessState] = {}
        self._firings = node.create_publisher(
            RuleFiring, f"{NAME}/firings", QoSConfig(queue_size=100).to_ros()
        )
        self._stack = node.create_publisher(StackState, f"{NAME}/stack_state", LATCHED.to_ros())
        self._inputs = RuleInputs(node, self._receive)
        types = self._table.topic_types()
        self._inputs.follow((name, next(iter(kinds))) for name, kinds in types.items() if kinds)
        self._alarm: Any = None
        node.create_timer(FIT_PERIOD, self._inputs.fit)
        node.create_timer(REPEAT_PERIOD, self._repeat)
        for name, function in recipe.polled.items():
            self._poll(name, function)
        self._schedule()

    def close(self) -> None:
        """Begin nothing any more."""
        self._runner.close()

    def process_changed(self, line: str) -> None:
        """The supervisor says how a process is doing (a JSON line)."""
        data = json.loads(line)
        process = ProcessState(**data)
        self._processes[process.name] = process
        self._stack.publish(StackState(stamp=self._stamp(), processes=[*self._processes.values()]))
        for component in process.nodes:
            if process.state in SILENT:
                message = self._spokesman.begin(component, process.reason)
                self._speak_for(component, message)
            elif process.state == "active":
                self._spokesman.end(component)

    # -- into the engine ----------------------------------------------------------------------

    def _receive(self, topic: str, message: Any) -> None:
        # What comes on the status topics of a dead component comes from ourselves.
        if not self._spokesman.speaks_for(topic.removesuffix("/status").removesuffix("_status")):
            self._feed(Sample(topic, message))

    def _speak_for(self, component: str, message: Any) -> None:
        for topic in (f"{component}/status", f"{component}_status"):
            self._feed(Sample(topic, message))

    def _repeat(self) -> None:
        for component, message in self._spokesman.repeat().items():
            self._speak_for(component, message)

    def _poll(self, name: str, function: Any) -> None:
        rate = next(
            leaf.condition.rate
            for leaf in self._table.leaves
            if isinstance(leaf.condition, CallableCondition) and leaf.condition.name == name
        )

        def ask() -> None:
            try:
                answer = function()
            except Exception as error:  # noqa: BLE001 - a recipe's function; unknown, and said so
                self._node.get_logger().error(
                    f"the condition {name!r} raised {type(error).__name__}: {error}",
                    throttle_duration_sec=5.0,
                )
                return
            self._feed(Sample(f"callable/{name}", answer))

        self._node.create_timer(1.0 / (rate or POLL_RATE), ask)

    def _feed(self, event: Input) -> None:
        self._state, outputs = step(self._table, self._state, event, time.monotonic())
        for output in outputs:
            if isinstance(output, Firing):
                self._executor.create_task(self._run, output)
            else:
                self._note(output)
        self._schedule()

    def _schedule(self) -> None:
        """Wake up when time alone may make a rule fire, and not before."""
        if self._alarm is not None:
            self._node.destroy_timer(self._alarm)
            self._alarm = None
        deadline = next_deadline(self._table, self._state)
        if deadline is not None:
            delay = max(deadline - time.monotonic(), 1e-4)
            self._alarm = self._node.create_timer(delay, lambda: self._feed(Tick()))

    # -- out of the engine --------------------------------------------------------------------

    async def _run(self, firing: Firing) -> None:
        leaves = [
            {"text": leaf.text, "value": leaf.value, "age": leaf.age, "verdict": leaf.verdict}
            for leaf in firing.leaves
        ]
        self._say(firing, "fired", True, firing.rule_id, {"leaves": leaves})

        def tell(outcome: Outcome) -> None:
            log = self._node.get_logger()
            (log.info if outcome.ok else log.error)(
                f"{firing.rule_id}: {outcome.action} "
                f"{'done' if outcome.ok else 'failed'}: {outcome.text}"
            )
            details = {"action": outcome.action, "seconds": round(outcome.seconds, 3)}
            self._say(firing, "action", outcome.ok, outcome.text, details)

        ok, error = await self._runner.run(firing, tell)
        self._feed(Done(firing.rule_id, firing.run_id, ok, error))
        self._say(firing, "done", ok, error, {})

    def _say(self, firing: Firing, phase: str, ok: bool, text: str, details: Any) -> None:
        self._firings.publish(
            RuleFiring(
                stamp=self._stamp(),
                rule_id=firing.rule_id,
                revision=firing.revision_hash,
                run_id=firing.run_id,
                phase=phase,
                ok=ok,
                text=text,
                details=json.dumps(details),
            )
        )

    def _note(self, note: Note) -> None:
        self._node.get_logger().error(f"{note.rule_id}: {note.text}")
        self._firings.publish(
            RuleFiring(
                stamp=self._stamp(),
                rule_id=note.rule_id,
                revision=note.revision_hash,
                phase="note",
                text=note.text,
                details="{}",
            )
        )

    def _stamp(self) -> Time:
        return self._node.get_clock().now().to_msg()


def run_monitor(recipe: RecipeRules, report: Report, inbox: int, namespace: str = "") -> None:
    """Run the monitor in this process until SIGTERM.

    Parameters
    ----------
    recipe
        Rules and functions.
    report
        Tells the supervisor.
    inbox
        File descriptor on which the supervisor tells of processes, a JSON line each.
    """
    ended = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(NAME, namespace=namespace or None)
    executor = EventsExecutor()
    executor.add_node(node)
    monitor = Monitor(node, executor, recipe)

    def read() -> None:
        with os.fdopen(inbox) as lines:
            for line in lines:
                executor.create_task(monitor.process_changed, line)

    # Blocked in a read nearly always; the executor's thread stays the only one that does work.
    threading.Thread(target=read, name="inbox", daemon=True).start()
    report(f"active {NAME}")
    try:
        while not ended.is_set():
            executor.spin_once(timeout_sec=SPIN_TIMEOUT)
            beat(NAME)
    finally:
        monitor.close()
        node.destroy_node()
        rclpy.shutdown()
