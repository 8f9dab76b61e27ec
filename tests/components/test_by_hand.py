"""A person who has the wheel drives, alone, through the gate, and only while the hand is there."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from automatika_ros_sugar.srv import ExecuteMethod
from geometry_msgs.msg import Twist
from kompass_interfaces.msg import DriveState, HandCommand
from kompass_interfaces.srv import ReleaseStop, StopRobot, TakeWheel

from kompass.components import DriveManager
from tests.components.alive import LATCHED, Alive
from tests.components.toy_robot import ToyRobot
from tests.support.hand import PERIOD, Hand

Run = Callable[..., Alive]
Ask = TakeWheel.Request
DEAD_MAN = 0.25  # s, the promise


class Scene:
    """A drive manager, a robot of a few lines, and what the robot was told when."""

    def __init__(self, alive: Alive) -> None:
        self.alive = alive
        self.robot = ToyRobot(alive)
        self.told: list[tuple[float, float, float]] = []
        self.states: list[DriveState] = alive.hear(DriveState, "/drive_state", LATCHED)
        alive.node.create_subscription(Twist, "/cmd_vel", self._note, 10)
        driver = alive.component
        self.wait(lambda: driver.input("sensor_data").message, "a scan")

    def _note(self, twist: Twist) -> None:
        self.told.append((self.alive.clock.monotonic(), twist.linear.x, twist.angular.z))

    def wait(self, condition: Callable[[], object], what: str, timeout: float = 10.0) -> None:
        self.alive.wait_until(condition, timeout, what)

    @property
    def state(self) -> DriveState:
        return self.states[-1]

    def moves(self) -> bool:
        return bool(self.robot.commands) and self.robot.commands[-1][0] > 0.1

    def stands(self, seconds: float = 1.0) -> bool:
        """Whether it is told nothing but to stand for a while."""
        self.wait(self.robot.is_halted, "a zero twist")
        self.told.clear()
        self.alive.rest(seconds)
        return not [one for one in self.told if one[1:] != (0.0, 0.0)]

    def driven(self, name: str = "ava") -> Hand:
        """Somebody who drives the robot ahead."""
        hand = self.at_wheel(name)
        hand.vx = 0.2
        self.wait(self.moves, "motion")
        return hand

    def hand(self, name: str) -> Hand:
        """Somebody who has a stick, and not the wheel."""
        return Hand(self.alive, name, self.alive.component.node_name, "take_wheel")

    def at_wheel(self, name: str = "ava") -> Hand:
        hand = self.hand(name)
        hand.take()
        self.alive.rest(4 * PERIOD)  # it is seen that nothing is held
        return hand

    def press_stop(self) -> None:
        self.alive.call(StopRobot, "stop", StopRobot.Request(operator_name="ben"))

    def release_stop(self) -> None:
        request = ReleaseStop.Request(operator_name="ben")
        assert self.alive.call(ReleaseStop, "release_stop", request).success


@pytest.fixture
def scene(run: Run) -> Scene:
    return Scene(run(DriveManager()))


def test_who_has_the_wheel_drives_and_everybody_is_told_who(scene: Scene) -> None:
    hand = scene.driven()
    assert (scene.state.driven_by, scene.state.hand_session) == ("ava", hand.session)
    assert hand.ask(Ask.GIVE).success
    scene.wait(lambda: not scene.state.driven_by, "a free wheel")
    assert scene.stands()


def test_a_hand_that_falls_silent_has_the_robot_told_to_stand_in_time(scene: Scene) -> None:
    for _ in range(10):
        hand = scene.driven()
        scene.told.clear()
        hand.sends = False
        newest = hand.sent[-1][0]
        scene.wait(scene.robot.is_halted, "a zero twist")
        halted = next(at for at, *twist in scene.told if twist == [0.0, 0.0])
        assert halted - newest <= DEAD_MAN
        assert scene.stands(0.5)
        assert hand.ask(Ask.GIVE).success


def test_a_wheel_of_which_nothing_is_heard_is_free_again(scene: Scene) -> None:
    hand = scene.driven()
    hand.sends = False
    scene.wait(lambda: not scene.state.driven_by, "a free wheel", 10.0)
    hand.sends = True  # it comes back with the stick still held
    assert scene.stands()


def test_two_never_drive_at_once_and_the_wheel_can_be_taken_over(scene: Scene) -> None:
    ava, ben = scene.driven(), scene.hand("ben")
    refused = ben.ask()
    assert not refused.success
    assert "ava drives by hand" in refused.message
    assert not refused.seed
    ben.take(Ask.TAKE_OVER)
    assert scene.stands()  # ava holds her stick still
    assert scene.state.driven_by == "ben"
    assert ava.ask(Ask.GIVE).success
    assert scene.state.driven_by == "ben"
    ben.omega = 0.5
    scene.wait(lambda: scene.robot.commands[-1][1] > 0.3, "a turn of ben's")


def test_after_stop_a_person_releases_it_and_the_hand_lets_go_before_it_moves(
    scene: Scene,
) -> None:
    hand = scene.driven()
    scene.press_stop()
    assert scene.stands()
    scene.release_stop()
    assert scene.stands()
    assert scene.state.limited_by == "let go first"
    hand.vx = 0.0
    scene.wait(lambda: scene.state.limited_by == "", "that it was let go")
    scene.alive.rest(3 * PERIOD)
    hand.vx = 0.2
    scene.wait(scene.moves, "motion")


def test_what_is_let_go_and_held_again_under_stop_is_held_still(scene: Scene) -> None:
    hand = scene.driven()
    scene.press_stop()
    hand.vx = 0.0
    scene.alive.rest(3 * PERIOD)
    hand.vx = 0.2
    scene.alive.rest(3 * PERIOD)
    scene.release_stop()
    assert scene.stands()


def test_commands_without_the_key_or_of_yesterday_move_nothing(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    hand = scene.driven()
    heard = [command for _, command in hand.sent]
    hand.vx = 0.0
    scene.wait(scene.robot.is_halted, "a zero twist")
    for command in heard:
        hand.publish(command)  # what somebody overheard
    forged = hand.command(sequence=10**6, vx=0.2)
    forged.vx = 0.3
    hand.publish(forged)
    unsigned = HandCommand(session=hand.session, sequence=10**6, sent=1.0, vx=0.2)
    hand.publish(unsigned)
    assert scene.stands()
    # And a whole session of before: its key is not that of the next.
    assert hand.ask(Ask.GIVE).success
    hand.sends = False
    again = hand.ask()
    assert again.success
    for command in heard:
        hand.publish(command)
    assert scene.stands()


def test_an_unsigned_request_is_refused_in_every_mode(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("KOMPASS_ROS_CONTROL", "full")
    alive = run(DriveManager())
    client = alive.node.create_client(TakeWheel, f"/{alive.component.node_name}/take_wheel")
    alive.wait_until(client.service_is_ready, 10, "the service")
    asked = client.call_async(Ask(operator_name="eve", session="eve's"))
    alive.wait_until(asked.done, 10, "an answer")
    assert not asked.result().success
    assert "without the robot's key" in asked.result().message


def test_what_the_controller_commands_does_not_count_while_somebody_drives_by_hand(
    scene: Scene,
) -> None:
    hand = scene.at_wheel()
    publisher = scene.alive.publisher(Twist, "/control")
    twist = Twist()
    twist.linear.x = 0.3
    timer = scene.alive.node.create_timer(0.02, lambda: publisher.publish(twist))
    assert scene.stands()
    # What was under way when the wheel is given up is not carried out after it.
    timer.cancel()
    publisher.publish(twist)
    assert hand.ask(Ask.GIVE).success
    publisher.publish(twist)
    assert scene.stands()


def test_a_motion_of_rules_ends_with_the_taking_and_none_begins_before_the_giving(
    scene: Scene,
) -> None:
    request = ExecuteMethod.Request(name="move_forward", kwargs_json='{"max_distance": 3.0}')
    moving = scene.alive.begin(ExecuteMethod, "execute_method", request)
    scene.wait(lambda: scene.robot.x > 0.1, "motion")
    hand = scene.at_wheel()
    scene.wait(lambda: moving() is not None, "the end of the motion")
    assert "ava took the wheel" in moving().error_msg
    for name, kwargs in (("move_forward", {"max_distance": 0.1}), ("move_to_unblock", {})):
        refused = scene.alive.execute(name, **kwargs)
        assert not refused.success
        assert "ava drives by hand; the wheel must be given up first" in refused.error_msg
    assert hand.ask(Ask.GIVE).success
    assert scene.alive.execute("move_forward", max_distance=0.1).success


def test_the_gate_holds_the_hand_before_an_obstacle(scene: Scene) -> None:
    hand = scene.driven()
    scene.robot.posts = [(scene.robot.x + 0.6, 0.0, 0.05)]
    scene.wait(lambda: scene.state.limited_by == "obstacle", "that it is held back")
    scene.wait(scene.robot.is_halted, "a zero twist")
    hand.vx = -0.2
    scene.wait(lambda: scene.robot.commands[-1][0] < -0.1, "the way back")


def test_a_robot_that_does_not_go_sideways_is_not_asked_to(scene: Scene) -> None:
    hand = scene.at_wheel()
    hand.vy = 0.2
    assert scene.stands()
    assert hand.ask().max_vy == 0.0
