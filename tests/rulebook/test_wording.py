"""Actions and durations as a person would say them."""

import pytest

from kompass.rulebook.views.wording import describe_action, describe_rule, seconds
from kompass.rules.schema.actions import (
    Action,
    CallService,
    CancelGoal,
    ClearAlarm,
    Lifecycle,
    Log,
    Method,
    Publish,
    Python,
    RaiseAlarm,
    Reconfigure,
    SendGoal,
    StartMission,
    UpdateParameters,
)
from tests.rules.building import compare, rule


@pytest.mark.parametrize(
    ("action", "text"),
    [
        (Log(text="hello"), 'log "hello"'),
        (
            Method(component="drive_manager", method="move_to_unblock"),
            "drive_manager: move to unblock",
        ),
        (
            Method(component="c", method="turn", kwargs={"angle": "$msg.yaw", "fast": True}),
            "c: turn (angle = $msg.yaw, fast = true)",
        ),
        (Method(component="c", method="pay", kwargs={"price": "$$5"}), 'c: pay (price = "$5")'),
        (Lifecycle(component="mapper", action="restart"), "restart mapper"),
        (
            UpdateParameters(component="controller", parameters={"use_direct_sensor": True}),
            "set controller.use_direct_sensor = true",
        ),
        (Reconfigure(component="c", config="c.yaml"), "reconfigure c: from c.yaml"),
        (Reconfigure(component="c", config={"a": 1}), "reconfigure c: a = 1"),
        (Publish(topic="t", type="p/msg/X"), "publish on /t"),
        (
            Publish(topic="t", type="p/msg/X", rate=2.0, period=5.0),
            "publish on /t at 2 Hz for 5 s",
        ),
        (CallService(service="/clear", type="p/srv/X"), "call /clear"),
        (
            SendGoal(action="planner/plan_path", type="p/action/X"),
            "send goal to /planner/plan_path",
        ),
        (CancelGoal(action="go"), "cancel goals of /go"),
        (RaiseAlarm(alarm="stuck"), 'raise alarm "stuck"'),
        (ClearAlarm(alarm="stuck"), 'clear alarm "stuck"'),
        (StartMission(mission="Night"), 'start mission "Night"'),
        (Python(name="shout"), "run shout of the recipe"),
    ],
)
def test_an_action_is_one_line(action: Action, text: str) -> None:
    assert describe_action(action) == text


def test_a_long_argument_is_cut() -> None:
    action = Method(component="c", method="m", kwargs={"text": "x" * 1000})
    assert len(describe_action(action)) < 90


@pytest.mark.parametrize(
    ("duration", "text"),
    [
        (-1.0, "0 s"),
        (0.25, "0.25 s"),
        (2.0, "2 s"),
        (9.96, "10 s"),
        (41.4, "41 s"),
        (119.0, "119 s"),
        (120.0, "2 min"),
        (200.0, "3 min 20 s"),
        (7500.0, "2 h 5 min"),
        (7200.0, "2 h"),
    ],
)
def test_a_duration_is_as_exact_as_one_needs_it(duration: float, text: str) -> None:
    assert seconds(duration) == text


def test_a_rule_is_one_sentence() -> None:
    made = rule(compare("a", "<", 0.3), hold=2.0, actions=(Log(text="!"), Log(text="?")))
    assert describe_rule(made) == 'when a.x < 0.3 for 2 s, then log "!", then log "?"'
