"""For the benchmarks: what a rule starts writes down when it was started.

Twelve slow rules have nothing to do until they are triggered.

The environment says how many rules look at other fields of the same topic (``RULES``), and where to
write (``OUT``): lines of the message's id and the time of the start [ns, monotonic].
"""

import os
import time

from kompass.actions import Action, LogInfo
from kompass.components import component_action
from kompass.components.base.component import Component
from kompass.ros import Event, Launcher, Topic

OUT = os.environ["OUT"]
descriptors: dict[str, int] = {}


def note(kind: str, number: str, at: int) -> None:
    if kind not in descriptors:
        descriptors[kind] = os.open(f"{OUT}/{kind}", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.write(descriptors[kind], f"{number} {at}\n".encode())


def started(number: str) -> None:
    note("function", number, time.monotonic_ns())


class Sink(Component):
    """Somebody in another process."""

    @component_action
    def take(self, number: str) -> bool:
        """Be called."""
        note("method", number, time.monotonic_ns())
        return True


def halted(number: str) -> None:
    note("emergency", number, time.monotonic_ns())


def slow() -> None:
    time.sleep(3.0)


sink = Sink("sink")
topic = Topic(name="/bench/event", msg_type="TwistStamped")
message = topic.msg
number = message.header.frame_id
events = {
    Event(message.twist.linear.x > 0): Action(started, kwargs={"number": number}),
    Event(message.twist.linear.y > 0): Action(sink.take, kwargs={"number": number}),
    Event(message.twist.angular.x > 0).as_rule("emergency", lane="safety"): Action(
        halted, kwargs={"number": number}
    ),
}
for index in range(12):
    waits = Event(message.twist.linear.z > 0, keep_event_delay=0.5).as_rule(f"slow-{index}")
    events[waits] = Action(slow)
for index in range(int(os.environ.get("RULES", "1"))):
    events[Event(message.twist.angular.z > 1000.0 + index)] = LogInfo(msg="never")

launcher = Launcher()
launcher.kompass(components=[sink], events_actions=events)
launcher.bringup()
