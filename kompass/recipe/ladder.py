"""The recovery ladder: what is tried, step after step, before a goal is given up, as rules."""

from __future__ import annotations

from kompass_interfaces.msg import GoalHindrance

from kompass.components.drive.drive_manager import DriveManager
from kompass.components.planner.planner import HINDRANCE, Planner
from kompass.rclpy_ext.topic import LATCHED, Topic
from kompass.recipe.action import Action
from kompass.recipe.event import Event
from kompass.rules.schema.actions import ClearAlarm, RaiseAlarm

ALARM = "goal given up"
WIDER, NARROWER = 2.0, 0.5  # of the planner's clearance
LONGEST_WAIT = 30.0  # s


def ladder(planner: Planner, driver: DriveManager) -> dict[Event, Action]:
    """The rules that help a robot on that does not get to its goal, as events with their actions.

    Each begins at a share of the planner's patience, and those come one after another: while one
    helps, the patience does not run on. So all have been tried when the goal is given up.
    """
    told = Topic(name=f"/{HINDRANCE}", msg_type=GoalHindrance, qos_profile=LATCHED).msg
    clearance = planner.config.clearance
    steps = (
        (0.2, "forget", "forget what is out of sight", Action(planner.clear_obstacles)),
        (0.3, "back-off", "back off", Action(driver.back_off)),
        (0.4, "turn", "turn to where there is room", Action(driver.turn_to_room)),
        (0.5, "wider", "plan around it, with more room", _replan(planner, WIDER * clearance)),
        (0.6, "narrower", "plan around it, with less room", _replan(planner, NARROWER * clearance)),
        (0.7, "wait", "wait for the way to come free", _wait(planner)),
    )
    rules = {
        Event(told.patience_used > share, on_change=True).as_rule(
            f"recovery-{name}", name=f"No way on, {share:.0%} of the patience → {what}"
        ): action
        for share, name, what, action in steps
    }
    given_up = Event(told.given_up.is_true(), on_change=True).as_rule(
        "recovery-tell", name="Goal given up → alarm", severity="warning"
    )
    rules[given_up] = Action.from_data(RaiseAlarm(alarm=ALARM, text="$msg.text"))
    again = Event(told.given_up.is_false(), on_change=True).as_rule(
        "recovery-told", name="Next goal → the alarm is over", first_true_is_edge=False
    )
    rules[again] = Action.from_data(ClearAlarm(alarm=ALARM))
    return rules


def _replan(planner: Planner, clearance: float) -> Action:
    return Action(planner.replan, kwargs={"clearance": round(clearance, 3)})


def _wait(planner: Planner) -> Action:
    return Action(planner.wait_for_way, kwargs={"longest": LONGEST_WAIT})
