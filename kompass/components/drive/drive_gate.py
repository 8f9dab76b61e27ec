"""What the wheels may be told at this moment, and what holds the robot back.

No ROS and no clock: time is an argument [s].
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.following.command import Command
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.motion_model import MotionModel
from kompass.algorithms.safety.stop_zone import StopZone
from kompass.algorithms.safety.velocity_limiter import VelocityLimiter, VelocityLimits
from kompass.components.drive.command_queue import STILL, Twist2D

# A share of the wanted speed that counts as none: the ramp of the zone is only ever approached.
BLOCKED_BELOW = 0.05
TURNING = 0.1  # rad/s from which a command counts as a turn too
KEEP_OUT, SPEED = "keep-out zone", "speed zone"  # what limits
STEERED = "steered wheels"  # turn only while they drive
SETTLE = 0.5  # s of zero commands after the last motion
# s, and turns, after which a gate that was held up takes the robot to be at rest: somebody else has
# halted it by then, or its base has.
HELD_UP, TURNS_HELD_UP = 0.25, 3
# m by which a car comes nearer than it is told to, until its wheels have turned to another curve.
ROOM_TO_STEER = 0.05
_NO_EDGES: NDArray[np.float64] = np.empty((0, 2))


@dataclass(frozen=True)
class GateLimits:
    """What the gate is set to.

    Attributes
    ----------
    velocity
        Of the robot.
    radius
        Of the circle around its footprint [m].
    critical_distance, slowdown_distance
        From the footprint; nearer means stop, or slower [m].
    odometry_timeout
        An older odometry is none [s].
    period
        From one turn to the next [s].
    safety_stop
        Whether obstacles count at all.
    needs_scan
        Whether the robot stands still while it sees nothing.
    footprint
        The body, where it is not round.
    motion
        What the wheels can do besides.
    """

    velocity: VelocityLimits
    radius: float
    critical_distance: float
    slowdown_distance: float
    odometry_timeout: float
    period: float
    safety_stop: bool = True
    needs_scan: bool = True
    footprint: Footprint | None = None
    motion: MotionModel = field(default_factory=MotionModel)


@dataclass(frozen=True)
class GateInput:
    """What is known in one turn.

    Attributes
    ----------
    wanted
        The twist asked for (vx, vy, omega) [m/s, m/s, rad/s]; None when none is.
    command_stale
        Whether a motion was asked for and nobody renewed it in time.
    obstacles
        Points (N, 2) in the robot's frame [m]; None when no scan is young enough.
    odometry_age
        [s]
    stopped
        Whether STOP is latched.
    intruded
        Whether others publish where only the gate, or only one, may.
    edges
        Points (N, 2) on the edges of keep-out zones, in the robot's frame [m]; None when there are
        zones, and it is not known where the robot is.
    fastest, slowed_by
        What a zone allows [m/s], and of which kind it is.
    """

    wanted: Twist2D | None
    command_stale: bool
    obstacles: NDArray[np.float64] | None
    odometry_age: float
    stopped: bool
    intruded: bool = False
    edges: NDArray[np.float64] | None = field(default_factory=lambda: _NO_EDGES)
    fastest: float = math.inf
    slowed_by: str = SPEED


@dataclass(frozen=True)
class Verdict:
    """What follows.

    Attributes
    ----------
    twist
        To send now; None for silence, when nothing has moved for long.
    factor
        Share of the wanted twist that is allowed, 0 … 1.
    limited_by
        "stop", "second publisher", "odometry stale", "place unknown", "scan stale", "obstacle",
        "keep-out zone", "speed zone", "steered wheels" or "command stale"; empty when nothing holds
        the robot back.
    emergency
        Whether a wanted motion is fully blocked by the stop zone, or, with none wanted, something
        is inside the critical zone the way that the robot went last.
    """

    twist: Twist2D | None
    factor: float
    limited_by: str
    emergency: bool


class DriveGate:
    """Judges commands one turn after another; it remembers what was sent last.

    Where the way is blocked, the turn that the command holds is still carried out; by steered
    wheels it is not, and a turn that is too tight for them is made as tight as it may be.
    """

    def __init__(self, limits: GateLimits) -> None:
        self._sent: Twist2D = STILL
        self._judged = -math.inf
        self._moved = -math.inf
        self._direction: float | None = None  # of the last motion, in the robot's frame [rad]
        self.set_limits(limits)

    def set_limits(self, limits: GateLimits) -> None:
        """Judge by other limits from now on."""
        self._limits = limits
        room = ROOM_TO_STEER if limits.motion.is_steered else 0.0
        self._zone = StopZone(
            limits.radius,
            limits.critical_distance + room,
            limits.slowdown_distance + room,
            max_decel=limits.velocity.vx.max_decel,
            footprint=limits.footprint,
            max_turn_decel=limits.velocity.omega.max_decel,
        )
        self._limiter = VelocityLimiter(limits.velocity)

    def halted(self) -> None:
        """Something else has sent zero; the next command sets out from there."""
        self._sent = STILL

    def judge(self, given: GateInput, now: float) -> Verdict:
        """The verdict of this turn; its twist counts as sent.

        Raises
        ------
        ValueError
            The wanted twist is not finite.
        """
        if now - self._judged > max(HELD_UP, TURNS_HELD_UP * self._limits.period):
            # What was sent last would be slowed down from, and set the robot in motion again.
            self.halted()
        self._judged = now
        given = self._steered(given)
        wanted = given.wanted
        factor, limited_by = self._allowed(given)
        blocked = limited_by in ("obstacle", KEEP_OUT) and factor == 0.0
        turns = blocked and not self._limits.motion.is_steered
        turn = wanted[2] if wanted and turns else 0.0
        for points in (given.obstacles, given.edges):
            if turn and points is not None:
                # What is blocked is the way, and the turn that is part of the command leads out of
                # it: a round body that turns on the spot meets nothing, another one may.
                turn *= self._zone.factor(points, 0.0, 0.0, turn)
        turn = turn if abs(turn) >= TURNING else 0.0
        twist = STILL if given.stopped else self._twist(wanted, factor, turn, now)
        if twist is not None and wanted and not turn and not _is_part_of(twist, wanted):
            # The wheels cannot change to another curve at once: what they are told until then is
            # neither the one that was judged nor the one before, and may lead elsewhere.
            free, what = self._free(given, twist)
            if free < 1.0:
                twist = self._twist(twist, 0.0 if free < BLOCKED_BELOW else free, 0.0, now)
                factor, limited_by = min(factor, free), limited_by or what
        if twist is not None:
            self._sent = twist
            if twist[0] or twist[1]:
                self._direction = math.atan2(twist[1], twist[0])
        if wanted and any(wanted):
            emergency = limited_by == "obstacle" and blocked and not turn
        else:
            emergency = self._too_close_ahead(given.obstacles)
        return Verdict(twist, factor, limited_by, emergency)

    def _steered(self, given: GateInput) -> GateInput:
        """What is wanted, as far as steered wheels can do it; a turn alone is left as it is."""
        motion, wanted = self._limits.motion, given.wanted
        if wanted is None or not (motion.is_steered and wanted[0]):
            return given
        return replace(given, wanted=(wanted[0], 0.0, motion.turn(wanted[0], wanted[2])))

    def _allowed(self, given: GateInput) -> tuple[float, str]:
        """Share of the wanted twist that is allowed, and why not all of it."""
        limits, wanted = self._limits, given.wanted
        if given.stopped:
            return 0.0, "stop"
        if given.intruded:
            return 0.0, "second publisher"
        if given.odometry_age > limits.odometry_timeout:
            return 0.0, "odometry stale"
        if given.edges is None:
            return 0.0, "place unknown"
        if limits.safety_stop and given.obstacles is None and limits.needs_scan:
            return 0.0, "scan stale"
        factor, limited_by = 1.0, "command stale" if given.command_stale else ""
        if wanted is None:
            return factor, limited_by
        if limits.motion.is_steered and any(wanted) and not wanted[0]:
            return 0.0, STEERED
        free, what = self._free(given, wanted)
        if free < factor:
            factor, limited_by = (0.0 if free < BLOCKED_BELOW else free), what
        speed = math.hypot(wanted[0], wanted[1])
        if speed * factor > given.fastest:
            factor, limited_by = given.fastest / speed, given.slowed_by
        return factor, limited_by

    def _free(self, given: GateInput, twist: Twist2D) -> tuple[float, str]:
        """Share of a twist that meets nothing, and what it would meet."""
        free, what = 1.0, ""
        for points, name in (
            (given.obstacles if self._limits.safety_stop else None, "obstacle"),
            (given.edges, KEEP_OUT),
        ):
            share = 1.0 if points is None else self._zone.factor(points, *twist)
            if share < free:
                free, what = share, name
        return free, what

    def _twist(
        self, wanted: Twist2D | None, factor: float, turn: float, now: float
    ) -> Twist2D | None:
        """The command as far as it is allowed; None once nothing has moved for long."""
        target = STILL if wanted is None else tuple(factor * value for value in wanted)
        before = self._sent
        if factor == 0.0:
            # At once: what the limiter would smooth is what must not happen.
            target, before = (0.0, 0.0, turn), (0.0, 0.0, before[2] if turn else 0.0)
        smooth = self._limiter.limit(Command(*target), Command(*before), self._limits.period)
        # Who slows down in a curve slows its turning down with it, however fast that is.
        command = (smooth.vx, smooth.vy, self._limits.motion.turn(smooth.vx, smooth.omega))
        if command != STILL or wanted is not None:
            self._moved = now
        return command if now - self._moved <= SETTLE else None

    def _too_close_ahead(self, obstacles: NDArray[np.float64] | None) -> bool:
        """Whether something is inside the critical zone, the way that the robot went last."""
        limits = self._limits
        if obstacles is None or self._direction is None or not limits.safety_stop:
            return False
        return self._zone.way(obstacles, self._direction) <= limits.critical_distance


def _is_part_of(twist: Twist2D, whole: Twist2D) -> bool:
    """Whether a twist is along the curve of another one."""
    return bool(np.allclose(np.cross(twist, whole), 0.0, atol=1e-6))
