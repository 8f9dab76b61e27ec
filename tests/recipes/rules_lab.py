"""For tests of rules: one component that does little, and functions that tell what they do."""

import os
import signal
import time
from pathlib import Path

from kompass.actions import Action
from kompass.components import Component
from kompass.components.base.actions import component_action
from kompass.ros import Event, Launcher, Topic

FOLDER = Path(os.environ["LAB_FOLDER"])


class Lamp(Component):
    """Shines, or does not."""

    @component_action
    def switch(self, on: bool, colour: str = "white") -> bool:
        """Switch it on or off."""
        (FOLDER / "lamp").write_text(f"{on} {colour}")
        return True


def note(name: str) -> None:
    with (FOLDER / name).open("a") as file:
        file.write(f"{time.monotonic()}\n")


def slow() -> None:
    time.sleep(3.0)


def emergency() -> None:
    note("emergency")


def count_once() -> None:
    note("once")


def crash() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def bool_event(topic: str, name: str, **options: bool) -> Event:
    made = Event(Topic(name=topic, msg_type="Bool").msg.data == True, **options)  # noqa: E712
    made.name = name
    return made


lamp = Lamp(component_name="lamp")
events = {
    bool_event("/emergency", "emergency"): Action(emergency),
    bool_event("/once", "once only", handle_once=True): Action(count_once),
    bool_event("/crash", "crash", on_change=True): Action(crash),
}
for number in range(12):
    events[bool_event("/slow", f"slow {number}", on_change=True)] = Action(slow)

launcher = Launcher()
launcher.kompass(components=[lamp], events_actions=events)
launcher.bringup()
