"""For tests of channels: components that are asked, and programs beside them that must not be."""

import os
import time
from pathlib import Path

from kompass.actions import Action
from kompass.components import Component
from kompass.components.base.actions import component_action
from kompass.ros import Event, Launcher, Topic
from kompass.supervisor.liveness import LivenessLimits

FOLDER = Path(os.environ["LAB_FOLDER"])


class Worker(Component):
    """Does what it is asked, and writes that down."""

    @component_action
    def note(self, text: str) -> str:
        """Write something down."""
        with (FOLDER / "notes").open("a") as file:
            file.write(f"{text}\n")
        return text

    @component_action
    async def work(self, seconds: float, text: str) -> str:
        """Take long."""
        self.note(f"{text} begun")
        await self.sleep(seconds)
        return self.note(f"{text} ended")

    @component_action
    def double(self, text: str) -> str:
        """Say it twice."""
        return text + text


worker = Worker(component_name="worker")
other = Worker(component_name="other")
said = Topic(name="/note", msg_type="String")
begun = Topic(name="/work", msg_type="String")
letters = Topic(name="/double", msg_type="Int32")


def double(count: int) -> str:
    answer = worker.double("é" * count)
    assert answer == "é" * 2 * count
    return f"{len(answer)} letters"


events = {
    Event(said).as_rule("note"): Action(worker.note, kwargs={"text": said.msg.data}),
    Event(begun).as_rule("work"): Action(
        worker.work, kwargs={"seconds": 1.5, "text": begun.msg.data}
    ),
    Event(letters).as_rule("double"): Action(double, kwargs={"count": letters.msg.data}),
}
program = FOLDER / "program.py"
program.write_text("import time\ntime.sleep(1000)\n")

# What is held by a signal is for the test to let go.
launcher = Launcher(patience=LivenessLimits(killed=None))
launcher.kompass(components=[worker, other], events_actions=events)
launcher.add_py_executable(str(program))
launcher.add_method(time.sleep, args=[1000])
launcher.bringup()
