"""For tests of what a recipe says: functions of one name, async ones, some that use components."""

import asyncio
import os
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

from kompass.actions import Action, LogInfo
from kompass.components import Component
from kompass.components.base.actions import component_action
from kompass.ros import Event, Launcher, Topic

FOLDER = Path(os.environ["LAB_FOLDER"])


class Lamp(Component):
    """Shines, or does not."""

    @component_action
    def switch(self, on: bool) -> bool:
        """Switch it on or off."""
        (FOLDER / "lamp").write_text(f"{on} by {os.getpid()}")
        return True

    @component_action
    def fail(self) -> bool:
        """Be broken from now on."""
        self.health.set_fail_component(["lamp"], "no power")
        return True


def note(name: str) -> None:
    with (FOLDER / name).open("a") as file:
        file.write(f"{os.getpid()}\n")


def said(topic: str, **options: bool) -> Event:
    made = Event(Topic(name=topic, msg_type="Bool").msg.data == 1, on_change=True, **options)
    made.name = topic.strip("/")
    return made


def is_there(name: str) -> Callable[[], Coroutine[Any, Any, bool]]:
    async def look() -> bool:
        await asyncio.sleep(0.01)
        return (FOLDER / f"wanted-{name}").exists()

    return look


async def dock(where: str) -> str:
    await asyncio.sleep(0.05)
    note("docked")
    return f"docked at {where}"


def switch_on() -> None:
    lamp.switch(True)


def read_settings() -> float:
    return lamp.config.loop_rate


lamp = Lamp(component_name="lamp")
lamp.on_fail(lambda: note("fallback"), max_retries=1)
twice = said("/twice")

launcher = Launcher()
launcher.kompass(
    components=[lamp],
    events_actions={
        Event(is_there("a"), on_change=True): Action(note, args=("found-a",)),
        Event(is_there("b"), on_change=True): Action(note, args=("found-b",)),
        twice: LogInfo(msg="first"),
        said("/dock"): Action(dock, args=("home",)),
        said("/switch"): Action(switch_on),
        said("/settings"): Action(read_settings),
        said("/fail"): Action(lamp.fail),
    },
)
launcher.on(twice, LogInfo(msg="second"))
launcher.bringup()
