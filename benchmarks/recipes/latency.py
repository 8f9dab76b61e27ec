"""For the benchmarks: what a rule starts writes down when it was started.

The environment says how many rules look at other fields of the same topic (``RULES``), and where to
write (``OUT``): lines of the message's id and the time of the start [ns, monotonic].
"""

import os
import time

from kompass.actions import Action, LogInfo
from kompass.components import component_action
from kompass.components.component import Component
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


sink = Sink("sink")
topic = Topic(name="/bench/event", msg_type="TwistStamped")
message = topic.msg
number = message.header.frame_id
events = {
    Event(message.twist.linear.x > 0): Action(started, kwargs={"number": number}),
    Event(message.twist.linear.y > 0): Action(sink.take, kwargs={"number": number}),
}
for index in range(int(os.environ.get("RULES", "1"))):
    events[Event(message.twist.angular.z > 1000.0 + index)] = LogInfo(msg="never")

launcher = Launcher()
launcher.kompass(components=[sink], events_actions=events)
launcher.bringup()
