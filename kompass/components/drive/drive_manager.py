"""The drive manager: the gate before the wheels, and short motions that free the robot."""

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray
from rclpy.task import Future

from kompass.components.base.actions import ActionRefused, component_action
from kompass.components.drive.command_queue import Twist2D
from kompass.components.drive.drive_gate import DriveGate
from kompass.components.drive.manoeuvre import Manoeuvre, free_way, open_turn
from kompass.robot import RobotType

SHARE_OF_TOP_SPEED = 0.5
MARGIN = 0.03  # m to stay outside the critical zone, so that the way out does not end in it
USEFUL = 0.05  # m; a shorter way frees nothing
HELD = 0.7  # s of being held back after which it is given up; a late scan passes sooner
REST = 1.0  # s at most for the robot to come to rest


class DriveManager(DriveGate):
    """The gate, with actions for rules: measured by odometry, bounded in time, within the limits.

    While one runs, commands of others are ignored. STOP ends it, and refuses the next one. The
    stop zone counts as for any motion: what leads away from an obstacle is allowed.
    """

    def init_variables(self) -> None:
        super().init_variables()
        self._busy = ""
        self._held_since: float | None = None
        self._manoeuvre: Manoeuvre | None = None
        self._ended: Future | None = None

    def custom_on_deactivate(self) -> None:
        self._finish("the drive manager was deactivated")
        super().custom_on_deactivate()

    # -- actions ------------------------------------------------------------------------------

    @component_action(active=True)
    async def move_forward(self, max_distance: float) -> bool:
        """Drive straight ahead.

        Parameters
        ----------
        max_distance
            How far; a negative one drives backwards [m].
        """
        with self._manoeuvring("move_forward"):
            return await self._go(max_distance)

    @component_action(active=True)
    async def move_backward(self, max_distance: float) -> bool:
        """Drive straight back; see :meth:`move_forward`."""
        with self._manoeuvring("move_backward"):
            return await self._go(-max_distance)

    @component_action(active=True)
    async def rotate_in_place(
        self, max_rotation: float, safety_margin: float | None = None
    ) -> bool:
        """Turn on the spot.

        Parameters
        ----------
        max_rotation
            By how much; positive is to the left [rad].
        safety_margin
            What must be free around the robot [m]; a twentieth of its radius unless given.
        """
        with self._manoeuvring("rotate_in_place"):
            return await self._rotate(max_rotation, self._obstacles(), safety_margin)

    @component_action(active=True)
    async def move_to_unblock(
        self,
        max_distance_forward: float | None = None,
        max_distance_backwards: float | None = None,
        max_rotation: float = math.pi / 2,
        rotation_safety_margin: float | None = None,
    ) -> bool:
        """Free the robot: drive to the side with more room, or turn to where a way is open.

        Ahead and back are tried in the order of the room measured there, each as far as the stop
        zone lets it, if that is of any use; then a turn. True at the first success; False when it
        is boxed in.

        Parameters
        ----------
        max_distance_forward, max_distance_backwards
            Twice the robot's radius unless given [m].
        max_rotation
            Largest turn [rad]; 0 for none.
        rotation_safety_margin
            As of :meth:`rotate_in_place`.
        """
        with self._manoeuvring("move_to_unblock"):
            points = self._obstacles()
            if points is None:
                return self.fails("there is no scan to choose a way by")
            radius = self.config.robot.radius
            room = {
                -1.0: (free_way(points, radius, math.pi), max_distance_backwards),
                1.0: (free_way(points, radius), max_distance_forward),
            }
            for sign in sorted(room, key=lambda one: -room[one][0]):
                free, wanted = room[sign]
                most = 2 * radius if wanted is None else abs(float(wanted))
                distance = min(most, free - self.config.critical_zone_distance - MARGIN)
                if distance >= min(USEFUL, most) > 0 and await self._go(sign * distance):
                    return True
                if self._latch.is_set:
                    return self.fails("STOP is pressed")
            needed = self.config.critical_zone_distance + MARGIN + USEFUL
            turn = open_turn(points, radius, abs(max_rotation), needed) if max_rotation else None
            if turn is None:
                return self.fails("boxed in: no way is free ahead, back, or after a turn")
            return await self._rotate(turn, points, rotation_safety_margin)

    # -- carrying out -------------------------------------------------------------------------

    @contextmanager
    def _manoeuvring(self, name: str) -> Iterator[None]:
        if self._latch.is_set:
            operator = self._latch.operator
            raise ActionRefused(f"{name}: {operator} pressed STOP; a person must release it")
        if self._busy:
            raise ActionRefused(f"{name}: {self._busy} is still under way")
        self._busy = name
        try:
            yield
        finally:
            self._busy, self._manoeuvre = "", None
            self._halt()

    async def _go(self, distance: float) -> bool:
        limits = self.config.robot.ctrl_vx_limits
        return await self._perform(distance, limits.max_vel, limits.max_decel, turns=False)

    async def _rotate(
        self, angle: float, points: NDArray[np.float64] | None, margin: float | None
    ) -> bool:
        robot = self.config.robot
        if robot.model_type is RobotType.ACKERMANN:
            return self.fails("a robot with steered wheels cannot turn on the spot")
        room = 0.05 * robot.radius if margin is None else margin
        if points is not None and len(points) and not self.config.disable_safety_stop:
            nearest = float(np.hypot(points[:, 0], points[:, 1]).min()) - robot.radius
            if nearest < room:
                return self.fails(f"{nearest:.3f} m around the robot are free, not {room:.3f} m")
        limits = robot.ctrl_omega_limits
        return await self._perform(angle, limits.max_vel, limits.max_decel, turns=True)

    async def _perform(self, amount: float, top: float, decel: float, *, turns: bool) -> bool:
        if not math.isfinite(amount) or amount == 0.0:
            return self.fails(f"{amount} is no motion; give a number other than 0")
        speed = SHARE_OF_TOP_SPEED * top
        if speed <= 0:
            return self.fails("the robot's limits do not allow that motion")
        self._ended = Future(executor=self.node.executor)
        self._manoeuvre = Manoeuvre(amount, speed, decel or 2 * top, turns)
        problem: str = await self._ended
        self._halt()
        await self._rest()
        return not problem or self.fails(problem)

    async def _rest(self) -> None:
        """Until odometry has measured standstill; what comes next starts from there."""
        deadline = time.monotonic() + REST
        while time.monotonic() < deadline and self.is_active:
            if self._standstill.reached(time.monotonic(), self.config.odometry_timeout):
                return
            await self.sleep(0.05)

    def _finish(self, problem: str) -> None:
        """End the motion under way; an empty problem means that it is complete."""
        self._manoeuvre = None
        if self._ended is not None:
            ended, self._ended = self._ended, None
            ended.set_result(problem)

    # -- in the loop --------------------------------------------------------------------------

    @property
    def _takes_commands(self) -> bool:
        return not self._busy

    def _wanted(self, now: float) -> Twist2D | None:
        if not self._busy:
            return super()._wanted(now)
        if self._manoeuvre is None:
            return None
        pose = self.pose()
        if pose is None:
            self._finish("the robot does not know where it is")
            return None
        twist = self._manoeuvre.step(pose, now)
        if twist is None:
            self._finish("")
        elif self._manoeuvre.overdue(now):
            self._finish(f"it did not get there in time, {self._manoeuvre.done:.2f} done")
            return None
        return twist

    def _judged(self, factor: float, limited_by: str) -> None:
        if self._manoeuvre is None or factor > 0.0:
            self._held_since = None
            return
        now = time.monotonic()
        self._held_since = now if self._held_since is None else self._held_since
        if limited_by == "stop":
            self._finish("STOP is pressed")
        elif now - self._held_since >= HELD:
            self._finish(f"held back: {limited_by}")
