"""A rule that fires once is not used up by a hiccup, and fires when it is meant."""

from contextlib import closing

from automatika_ros_sugar.msg import ComponentStatus

from tests.support.journal import Journal
from tests.support.rules import Rules
from tests.support.stack import RECIPE
from tests.support.virtual_robot import VirtualRobot

HEALING = RECIPE.with_name("04_cross_component_healing.py")
LATE = 0.2  # s, as was seen of a mapper under load


def test_a_late_mapper_does_not_use_up_the_rule_that_its_death_fires() -> None:
    with closing(VirtualRobot(HEALING)) as robot:
        journal, rules = Journal(robot), Rules(robot)
        statuses: list[int] = []
        robot.node.create_subscription(
            ComponentStatus, "/mapper/status", lambda message: statuses.append(message.status), 10
        )
        robot.wait_until(lambda: 0 in statuses, 10, "a healthy mapper")
        robot.stack.stop("mapper")
        robot.wait_until(lambda: any(statuses), 10, "the failure of the mapper")
        robot.rest(LATE)
        robot.stack.go_on("mapper")
        robot.wait_until(lambda: statuses[-1] == 0, 10, "the mapper's health")
        assert journal.of("mapper-lost", "fired") == []
        assert rules.status("mapper-lost").state != "used up"

        robot.stack.kill("mapper")
        assert journal.done("mapper-lost").ok
        assert rules.status("mapper-lost").state == "used up"
