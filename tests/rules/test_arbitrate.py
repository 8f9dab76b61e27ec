"""Two rules over one component: the more severe one wins, and the other is recorded."""

from typing import Any

from kompass.rules.engine.arbitrate import Arbitration, Running, arbitrate, components_of
from kompass.rules.engine.firing import Firing
from kompass.rules.schema.actions import Lifecycle, Log, Method
from kompass.rules.schema.table import Severity
from tests.rules.building import Robot, received, rule

UNBLOCK = Method(component="drive_manager", method="move_to_unblock")
STOP = Method(component="drive_manager", method="stop")
REPLAN = Lifecycle(component="planner", action="restart")


def firings(**severities: Any) -> list[Firing]:
    """Rules that fire together, by name: severity and action."""
    robot = Robot(
        *(
            rule(received("a"), name, severity=severity, actions=(action,))
            for name, (severity, action) in severities.items()
        ),
        finish=False,
    )
    robot.say("a")
    return robot.firings


def ids(result: Arbitration) -> tuple[list[str], list[str], list[str]]:
    return (
        [f.rule_id for f in result.start],
        [lost.firing.rule_id for lost in result.outranked],
        [r.rule_id for r in result.preempted],
    )


def test_the_more_severe_of_two_that_fire_together_wins() -> None:
    result = arbitrate(firings(mild=("warning", UNBLOCK), grave=("critical", STOP)), [])
    assert ids(result) == (["grave"], ["mild"], [])
    (lost,) = result.outranked
    assert (lost.component, lost.winner_rule_id) == ("drive_manager", "grave")


def test_rules_over_different_components_do_not_meet() -> None:
    found = firings(mild=("warning", REPLAN), grave=("critical", STOP), note=("info", Log(text="")))
    assert ids(arbitrate(found, [])) == (["grave", "mild", "note"], [], [])


def test_equals_do_not_exclude_each_other_and_keep_their_order() -> None:
    found = firings(first=("error", UNBLOCK), second=("error", STOP))
    assert ids(arbitrate(found, [])) == (["first", "second"], [], [])


def test_a_run_in_progress_gives_way_to_a_more_severe_one() -> None:
    running = Running("backing", 1, Severity.WARNING, frozenset({"drive_manager"}))
    result = arbitrate(firings(grave=("critical", STOP)), [running])
    assert ids(result) == (["grave"], [], ["backing"])


def test_a_run_in_progress_keeps_its_component_from_a_less_severe_one() -> None:
    running = Running("stopping", 7, Severity.CRITICAL, frozenset({"drive_manager"}))
    result = arbitrate(firings(mild=("warning", UNBLOCK)), [running])
    assert ids(result) == ([], ["mild"], [])
    assert result.outranked[0].winner_rule_id == "stopping"


def test_a_run_that_is_cancelled_by_its_own_rule_holds_nothing() -> None:
    (firing,) = firings(again=("warning", UNBLOCK))
    running = Running("again", 5, Severity.WARNING, frozenset({"drive_manager"}))
    result = arbitrate([firing._replace(cancels=(5,))], [running])
    assert ids(result) == (["again"], [], [])


def test_all_components_of_a_list_of_actions_count() -> None:
    assert components_of((Log(text=""), REPLAN, STOP)) == {"planner", "drive_manager"}
