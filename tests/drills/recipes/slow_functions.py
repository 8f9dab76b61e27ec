"""A recipe whose functions take their time, and whose chance can be real."""

import asyncio
import os
import threading
from time import monotonic, sleep

from sugar.msg import ComponentStatus

from kompass.actions import Action, LogInfo
from kompass.components import Controller, DriveManager, LocalMapper, Planner, PlannerConfig
from kompass.ros import Event, Launcher, Topic
from tests.support.turtlebot import turtlebot

planner = Planner(component_name="planner", config=PlannerConfig(goals_from_topics=True))
planner.run_type = "ActionServer"
planner.inputs(goal_point=Topic(name="/clicked_point", msg_type="PointStamped"))
controller = Controller(component_name="controller")
mapper = LocalMapper(component_name="mapper")
driver = DriveManager(component_name="drive_manager")


def ponder() -> str:
    """Stand still for two seconds."""
    begun = monotonic()
    sleep(1.5)
    threading.Event().wait(0.5)
    return f"pondered for {monotonic() - begun:.3f} s"


async def muse() -> str:
    """Let others work meanwhile, and ask a component for something."""
    loop = asyncio.get_running_loop()
    begun = loop.time()
    await asyncio.sleep(2.0)
    await asyncio.to_thread(sleep, 1.0)
    return f"mused for {loop.time() - begun:.3f} s"


blind = Event(
    controller.status_topic.msg.status == ComponentStatus.STATUS_FAILURE_SYSTEM_LEVEL,
    on_change=True,
).as_rule("blind", name="Blind → ponder")
clicked = Event(Topic(name="/clicked_point", msg_type="PointStamped")).as_rule("clicked")
events_actions = {clicked: [LogInfo(msg="a click")], blind: [Action(ponder), Action(muse)]}

if os.environ.get("WHIMS"):

    def whim() -> str:
        """What no seed decides."""
        return os.urandom(4).hex()

    often = Event(planner.status_topic.msg.status == 0, keep_event_delay=1.0).as_rule("whim")
    events_actions[often] = [LogInfo(msg="a whim"), Action(whim)]

launcher = Launcher()
launcher.kompass(
    components=[planner, controller, mapper, driver],
    events_actions=events_actions,
    multi_processing=True,
)
launcher.inputs(location=Topic(name="/odometry/filtered", msg_type="Odometry"))
launcher.robot = turtlebot()
launcher.bringup()
