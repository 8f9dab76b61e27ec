"""For the benchmarks: one rule that fires at each edge, among others on the same topic.

The environment says how many rules there are (``RULES``) and where the one that fires writes the
ids of the messages that it fired for (``OUT``).
"""

import os

from kompass.actions import Action, LogInfo
from kompass.components.base.component import Component
from kompass.ros import Event, Launcher, Topic
from kompass.rules.schema.events import Queued

OUT = os.environ["OUT"]
topic = Topic(name="/bench/event", msg_type="TwistStamped")
message = topic.msg
descriptors: list[int] = []


def count(number: str) -> None:
    if not descriptors:
        descriptors.append(os.open(f"{OUT}/fired", os.O_WRONLY | os.O_CREAT | os.O_APPEND))
    os.write(descriptors[0], f"{number}\n".encode())


edge = Event(message.twist.linear.x > 0, on_change=True).as_rule("edge", mode=Queued(size=1000))
events = {edge: Action(count, kwargs={"number": message.header.frame_id})}
for index in range(int(os.environ.get("RULES", "1")) - 1):
    events[Event(message.twist.linear.x > 1000.0 + index)] = LogInfo(msg="never")

launcher = Launcher()
launcher.kompass(components=[Component("bystander")], events_actions=events)
launcher.bringup()
