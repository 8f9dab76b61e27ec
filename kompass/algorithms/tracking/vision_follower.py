"""What both followers of a target share: follow while it is seen, then search, wait and give up."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Generic, Literal, TypeAlias, TypeVar, cast

from kompass.algorithms.bounded import BoundedParams
from kompass.algorithms.following.command import Command
from kompass.algorithms.following.limits import Limits, stopping_speed
from kompass.algorithms.geometry import Pose2D
from kompass.algorithms.motion_model import MotionModel

TrackPhase: TypeAlias = Literal["following", "waiting", "searching", "lost"]

# For so long a target that is not seen is followed still [s]: detectors miss one now and then.
UNSEEN = 0.5
# Turns of a search [rad]: to the side where it was last, all the way round the other way, and back.
_TURNS = (math.pi, -2.0 * math.pi, math.pi)
# With this share of the top speed a car drives its circle.
_CIRCLING = 0.3


@dataclass(frozen=True, kw_only=True)
class VisionParams(BoundedParams):
    """Common to both; what is not finite or out of its bounds is a ValueError.

    Attributes
    ----------
    target_wait_timeout
        For how long the target may be out of sight, when it is not searched for [s].
    target_search_timeout
        … when it is [s].
    target_search_pause
        Before the search, and between its turns [s].
    target_search_radius
        Of the circle that a robot with steered wheels searches on, if it can turn so tightly [m].
    enable_search
        Whether it is searched for.
    """

    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {
        "target_wait_timeout": (0.0, 3600.0),
        "target_search_timeout": (0.0, 3600.0),
        "target_search_pause": (0.0, 60.0),
        "target_search_radius": (0.001, 100.0),
        "rotation_gain": (0.01, 10.0),
        "speed_gain": (0.01, 10.0),
    }

    target_wait_timeout: float = 30.0
    target_search_timeout: float = 30.0
    target_search_pause: float = 2.0
    target_search_radius: float = 0.5
    enable_search: bool = True


@dataclass(frozen=True)
class Quest:
    """What one goal asks for.

    Attributes
    ----------
    timeout
        For how long the target may be out of sight [s]; None: as the parameters have it.
    radius
        Of a car's search [m]; None: as the parameters have it.
    """

    timeout: float | None = None
    radius: float | None = None


@dataclass(frozen=True)
class TrackStep:
    """One control cycle.

    Attributes
    ----------
    command
        What the robot should do now.
    phase
        ``following`` it, ``waiting`` at rest until it is seen, ``searching``, or ``lost`` for good.
    distance_error
        What is to be gone towards it, positive when it is too far.
    orientation_error
        What is to be turned, positive to the left.
    """

    command: Command
    phase: TrackPhase
    distance_error: float = 0.0
    orientation_error: float = 0.0


P = TypeVar("P", bound=VisionParams)


class VisionFollower(ABC, Generic[P]):
    """Follows one target after another; a subclass supplies the law.

    It looks at no obstacles: what stands between robot and target stops it at the drive manager.

    Parameters
    ----------
    params
        An instance of ``params_class``; the default one when left out.
    max_v, max_omega, acc, decel, omega_acc
        Limits [m/s, rad/s, m/s², m/s², rad/s²].
    motion
        What else the wheels can and cannot do; a robot that turns on the spot when left out.
    """

    params_class: ClassVar[type[VisionParams]]

    def __init__(
        self,
        params: P | None = None,
        *,
        max_v: float,
        max_omega: float,
        acc: float,
        decel: float,
        omega_acc: float,
        motion: MotionModel | None = None,
    ) -> None:
        self.params: P = cast(P, self.params_class()) if params is None else params
        self.motion = motion or MotionModel()
        self._linear = Limits(max_v, acc, decel)
        self._angular = Limits(max_omega, omega_acc, omega_acc)
        self._last = Command()
        self.begin(Quest(), 0.0)

    def begin(self, quest: Quest, now: float) -> None:
        """Seek a target from ``now`` [s] on; what was known of the one before is forgotten."""
        self._quest = quest
        self._seen, self._was_seen = now, False
        self._side = 1.0  # where it went out of sight: 1.0 to the left
        self._turned, self._turn, self._pause_since = 0.0, 0, now

    @property
    def limit(self) -> float:
        """For how long the target may be out of sight [s]."""
        params = self.params
        own = params.target_search_timeout if params.enable_search else params.target_wait_timeout
        return own if self._quest.timeout is None else self._quest.timeout

    def step(
        self, pose: Pose2D, v: float, omega: float, now: float, dt: float, *, sees: bool = True
    ) -> TrackStep:
        """The command for the next ``dt`` [s].

        Parameters
        ----------
        pose
            (x, y, yaw) of the robot in the frame of what it is shown [m, m, rad].
        v, omega
            Its measured velocity ahead [m/s] and turning rate [rad/s].
        now
            [s]
        dt
            Control period [s].
        sees
            Whether the detector still tells what it sees. A robot that is blind does not move.

        Raises
        ------
        ValueError
            An argument is not finite, or ``dt`` is not positive.
        """
        if not all(map(math.isfinite, (*pose, v, omega, now))):
            raise ValueError(f"pose, v, omega, now: {(*pose, v, omega, now)}; give finite numbers")
        if not (math.isfinite(dt) and dt > 0):
            raise ValueError(f"dt: {dt} s; give the control period, above 0")
        speed = self._linear.going(self._last.vx, v, dt)
        turn_rate = self._angular.going(self._last.omega, omega, dt)
        unseen = now - self._seen
        away = side = 0.0
        if sees and self._was_seen and unseen <= UNSEEN:
            phase: TrackPhase = "following"
            self._turned, self._turn, self._pause_since = 0.0, 0, now
            wanted_v, wanted_omega, away, side = self._follow(pose, now, dt)
            self._side = math.copysign(1.0, side) if side else self._side
        elif unseen >= self.limit:
            phase, wanted_v, wanted_omega = "lost", 0.0, 0.0
        elif sees and self.params.enable_search:
            phase, wanted_v, wanted_omega = self._search(omega, now, dt)
        else:
            phase, wanted_v, wanted_omega = "waiting", 0.0, 0.0
        vx = self._linear.approach(speed, wanted_v, dt)
        turn = self.motion.turn(vx, self._angular.approach(turn_rate, wanted_omega, dt))
        self._last = Command(vx, 0.0, turn)
        return TrackStep(self._last, phase, away, side)

    def reset(self) -> None:
        """Forget the commanded velocity, after something else has driven or stopped the robot."""
        self._last = Command()

    def _is_seen(self, now: float) -> None:
        self._seen, self._was_seen = now, True

    def _search(self, omega: float, now: float, dt: float) -> tuple[TrackPhase, float, float]:
        params = self.params
        if now - self._pause_since < params.target_search_pause or self._turn >= len(_TURNS):
            return "waiting", 0.0, 0.0
        if self.motion.is_steered:
            own = params.target_search_radius
            wanted = own if self._quest.radius is None else self._quest.radius
            v = _CIRCLING * self._linear.max_vel
            return "searching", v, self._side * v / max(wanted, self.motion.turning_radius)
        self._turned += omega * dt
        left = self._side * _TURNS[self._turn] - self._turned
        if abs(left) < 0.1 or left * self._side * _TURNS[self._turn] < 0.0:
            self._turned, self._pause_since = 0.0, now
            self._turn += 1
            return "waiting", 0.0, 0.0
        # All turns are to fit into the time that there is, with the pauses.
        time = self.limit - UNSEEN - len(_TURNS) * (params.target_search_pause + 1.0)
        whole = sum(map(abs, _TURNS))
        rate = min(self._angular.max_vel, whole / time if time > 1.0 else self._angular.max_vel)
        rate = min(rate, max(0.1, self._turning_rate(left, dt)))
        return "searching", 0.0, math.copysign(rate, left)

    def _turning_rate(self, angle: float, dt: float) -> float:
        """The rate from which a turn still ends after ``angle`` [rad]."""
        return min(
            self._angular.max_vel,
            stopping_speed(abs(angle), 0.5 * self._angular.max_decel, 1.5 * dt),
        )

    @abstractmethod
    def _follow(self, pose: Pose2D, now: float, dt: float) -> tuple[float, float, float, float]:
        """Velocity and turning rate that are wanted, and the errors of distance and orientation."""
