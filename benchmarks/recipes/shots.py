"""For the benchmarks: each message is answered with one message."""

from kompass.actions import Action
from kompass.components.base.component import Component
from kompass.ros import Event, Launcher, Topic
from kompass.rules import actions as data
from kompass.rules.schema.events import Queued

asked = Topic(name="/bench/asked", msg_type="Int32")
answer = data.Publish(
    topic="bench/answer", type="std_msgs/msg/Int32", message={"data": "$msg.data"}, timeout=None
)
shot = Event(asked).as_rule("shot", mode=Queued(size=1000))

launcher = Launcher()
launcher.kompass(
    components=[Component("bystander")], events_actions={shot: Action.from_data(answer)}
)
launcher.bringup()
