"""What the hand does on the page is what the robot does, and the page says so."""

import math
import re
from collections.abc import Callable
from itertools import pairwise

import pytest
from action_msgs.msg import GoalStatusArray
from geometry_msgs.msg import PointStamped, PoseStamped
from nav_msgs.msg import Odometry
from playwright.sync_api import expect
from rclpy.time import Time

from tests.browser.console_page import ConsolePage
from tests.browser.floor import FAR_APART
from tests.browser.stopwatch import ANSWERED, Stopwatch
from tests.support.patience import patient
from tests.support.processes import wait_until
from tests.support.robot import LATCHED, Robot

pytestmark = pytest.mark.browser

SUCCEEDED = 4
ACTION_STATUS = "/planner/plan_path/_action/status"


@pytest.fixture(scope="module")
def heard(robot: Robot) -> list[tuple[str, float, float]]:
    """Every goal that anybody publishes: topic, x, y."""
    goals: list[tuple[str, float, float]] = []

    def pose(message: PoseStamped) -> None:
        at = message.pose.position
        goals.append(("/goal_pose", at.x, at.y))

    def point(message: PointStamped) -> None:
        goals.append(("/clicked_point", message.point.x, message.point.y))

    robot.node.create_subscription(PoseStamped, "/goal_pose", pose, 10)
    robot.node.create_subscription(PointStamped, "/clicked_point", point, 10)
    return goals


def goal_ended(robot: Robot) -> Callable[[], bool]:
    """Whether the newest PlanPath goal has come to an end."""
    return lambda: bool(robot.newest[ACTION_STATUS].status_list[-1].status >= SUCCEEDED)


# All that the page says of the goal from now on: a test that is kept waiting would miss some of it.
_HEAR = """() => {
  window.kompassTold = [];
  new MutationObserver(() => {
    const status = document.querySelector('[data-testid="goal-status"]');
    if (status !== null) window.kompassTold.push(status.textContent);
  }).observe(document.body, { subtree: true, childList: true, characterData: true });
}"""


def arrive(page: ConsolePage) -> list[float]:
    """Wait until the page says that the robot has arrived; the distances [m] told since `_HEAR`."""
    status = page.get("goal-status")
    # The goal before this one may still be shown as arrived.
    expect(status).to_have_attribute("data-under-way", "true")
    expect(status).to_have_attribute("data-phase", "arrived", timeout=patient(60_000))
    said = page.page.evaluate("() => window.kompassTold ?? []")
    left = [found for text in said if (found := re.search(r"([\d.]+) (c?m) left", text))]
    return [float(each[1]) / (100 if each[2] == "cm" else 1) for each in left]


def drive(page: ConsolePage, robot: Robot) -> None:
    """Send the robot by hand so far that it does not arrive before the next press, however long a
    busy machine takes for it; wait until it moves."""
    x, y = max(FAR_APART, key=lambda corner: robot.distance_to(*corner))
    page.pick(page.pixel(page.await_scene(), x, y))
    page.get("goal-go").click()
    wait_until(lambda: robot.speed > 0.1, 15, "motion")


def test_a_dragged_goal_around_a_pillar_is_foretold_followed_and_reached(
    page: ConsolePage, robot: Robot
) -> None:
    robot.subscribe(GoalStatusArray, ACTION_STATUS, LATCHED)
    floor = page.await_scene()
    goal = (0.9, 0.55, math.pi / 2)  # a pillar stands on the straight line to it
    began = robot.distance_to(*goal[:2])
    assert began > 2.9
    page.pick(page.pixel(floor, 0.9, 0.55), page.pixel(floor, 0.9, 1.2))
    card = page.get("goal-card")
    expect(card).to_contain_text(re.compile(r"[\d.]+ m, about \d+ s, clear"))
    expect(card).to_contain_text(re.compile("heading (89|90|91)°"))
    assert robot.distance_to(*goal[:2]) == pytest.approx(began, abs=0.02)

    page.page.evaluate(_HEAR)
    page.get("goal-go").click()
    expect(page.get("goal-status")).to_have_attribute(
        "data-phase", re.compile("accepted|driving"), timeout=patient(5000)
    )
    told = arrive(page)
    assert len(set(told)) > 5
    assert told[0] > 2.5
    assert told[-1] < 0.5
    assert all(later <= earlier + 0.05 for earlier, later in pairwise(told))
    expect(page.get("goal-status")).to_contain_text("Arrived")

    wait_until(goal_ended(robot), 5, "the end of the action's goal")
    assert robot.newest[ACTION_STATUS].status_list[-1].status == SUCCEEDED
    assert robot.distance_to(*goal[:2]) < 0.10
    assert abs(math.remainder(robot.truth[2] - goal[2], 2 * math.pi)) < 0.2
    assert robot.contacts == 0


def test_a_tap_is_a_point_without_a_heading(
    page: ConsolePage, robot: Robot, heard: list[tuple[str, float, float]]
) -> None:
    floor = page.await_scene()
    heard.clear()
    page.pick(page.pixel(floor, 0.55, 0.55))
    card = page.get("goal-card")
    expect(card).to_contain_text("clear")
    expect(card).not_to_contain_text("heading")
    page.get("goal-go").click()
    arrive(page)
    [(topic, x, y)] = heard
    assert topic == "/clicked_point"
    assert (x, y) == pytest.approx((0.55, 0.55), abs=0.03)
    assert robot.distance_to(0.55, 0.55) < 0.10


def test_a_goal_in_a_pillar_is_refused_at_the_pointer_and_the_nearest_is_offered(
    page: ConsolePage,
    robot: Robot,
    heard: list[tuple[str, float, float]],
    record_property: Callable[[str, object], None],
) -> None:
    floor = page.await_scene()
    heard.clear()
    pillar = page.pixel(floor, 1.1, 1.1)
    watch = Stopwatch(page.page, ANSWERED)
    page.pick(pillar)
    record_property("told_after_ms", round(watch.read()))
    card = page.get("goal-card")
    expect(card).to_contain_text("obstacle")
    expect(card).to_contain_text(re.compile("nearest reachable point is [0-9.]+ c?m from"))
    assert page.get("goal-go").count() == 0
    box = card.bounding_box()
    assert box is not None
    beside = max(box["x"] - pillar[0], pillar[0] - box["x"] - box["width"], 0.0)
    above = max(box["y"] - pillar[1], pillar[1] - box["y"] - box["height"], 0.0)
    assert math.hypot(beside, above) < 40

    page.get("goal-nearest").click()
    arrive(page)
    # Only what was taken was ever sent.
    [(_, x, y)] = heard
    assert 0.2 < math.hypot(x - 1.1, y - 1.1) < 0.6
    assert robot.distance_to(x, y) < 0.10
    assert robot.contacts == 0


def test_stop_is_confirmed_by_standstill_holds_and_is_released_by_holding_only(
    page: ConsolePage, robot: Robot
) -> None:
    drive(page, robot)
    moved: list[float] = []

    def see(message: Odometry) -> None:
        # When it moved, not when a busy machine has told so.
        if abs(message.twist.twist.linear.x) > 0.02:
            moved.append(Time.from_msg(message.header.stamp).nanoseconds * 1e-9)

    watching = robot.node.create_subscription(Odometry, "/simulator/ground_truth", see, 10)
    page.page.evaluate(
        """() => new MutationObserver((_, watch) => {
          const stopped = '[data-testid="stop-button"][data-phase="stopped"]';
          if (document.querySelector(stopped) === null) return;
          window.stoppedAt = performance.timeOrigin + performance.now();
          watch.disconnect();
        }).observe(document.body, { subtree: true, attributeFilter: ["data-phase"] })"""
    )
    wait_until(lambda: moved, 5, "motion, seen")
    page.get("stop-button").click()
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    shown = page.page.evaluate("() => window.stoppedAt") / 1000
    robot.node.destroy_subscription(watching)
    assert shown > moved[-1] + 0.2, "called stopped before it stood still for a while"
    command = robot.newest["/cmd_vel"]
    assert (command.linear.x, command.angular.z) == (0.0, 0.0)
    stood = robot.truth
    state = robot.newest["/drive_state"]
    assert state.stopped
    assert state.standstill

    page.pick(page.pixel(page.await_scene(), -0.55, 0.55))
    expect(page.get("goal-go")).to_be_disabled()
    expect(page.get("goal-card")).to_contain_text("release")
    page.get("goal-cancel").click()
    answer = page.post("/api/goals", {"x": -0.55, "y": 0.55, "yaw": None})
    assert answer.status == 409

    page.get("release-button").click(delay=300)  # ms; a firm press, but not a hold
    assert max(math.dist(at[:2], stood[:2]) for at in robot.watch(1.5)) < 0.01
    assert robot.newest["/drive_state"].stopped
    page.release_stop()
    wait_until(lambda: not robot.newest["/drive_state"].stopped, 2, "the release")
    assert max(math.dist(at[:2], stood[:2]) for at in robot.watch(0.5)) < 0.01

    drive(page, robot)
    page.get("goal-cancel-sent").click()
    expect(page.get("goal-status")).to_have_attribute("data-phase", "canceled")
    wait_until(lambda: robot.speed < 0.01, 3, "a halt")


def test_space_stops_the_robot_while_the_focus_is_in_the_scene(
    page: ConsolePage, robot: Robot
) -> None:
    drive(page, robot)
    box = page.get("scene-frame").bounding_box()
    assert box is not None
    page.page.mouse.click(box["x"] + 20, box["y"] + box["height"] - 20)
    assert page.page.evaluate("() => document.activeElement.tagName") == "IFRAME"
    page.page.keyboard.press("Space")
    expect(page.get("stop-button")).to_have_attribute("data-phase", "stopped")
    robot.has_stopped()
    assert robot.speed < 0.01
    page.release_stop()
