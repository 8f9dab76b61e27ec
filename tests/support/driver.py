"""A robot that drives to and fro."""

from geometry_msgs.msg import Twist

from tests.support.processes import wait_until
from tests.support.robot import Robot


class Driver(Robot):
    """A robot that drives to and fro, and what is heard on its command topic."""

    _goals = 0

    def drive(self) -> None:
        """A goal under way."""
        self.send_goal(*((0.5, 0.5), (-1.5, 0.3))[self._goals % 2])
        self._goals += 1
        wait_until(lambda: self.speed > 0.15, 20, "motion")

    def halts(self) -> bool:
        """Whether the newest command is zero, and one has come."""
        newest = self.newest.get("/cmd_vel")
        return newest is not None and newest == Twist()
