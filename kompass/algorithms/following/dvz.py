"""The deformable virtual zone: turn away from what reaches into a zone around the robot.

R. Zapata, P. Lépinay, P. Thompson, "Reactive Behaviors of Fast Mobile Robots", Journal of Robotic
Systems, 1994; L. Lapierre, R. Zapata, P. Lépinay, "Simultaneous Path Following and Obstacle
Avoidance Control of a Unicycle-type Robot", ICRA 2007.

The zone grows ahead with the speed. What reaches into it deforms it: at each bearing a share of the
zone is taken. Where that points to on the whole is the circular mean of the bearings, weighted by
their shares, so what is on both sides of straight ahead is ahead; and what lies on opposite sides,
as the walls of a corridor, outweighs itself.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from kompass.algorithms.following.follower import NoCommand, Situation
from kompass.algorithms.following.limits import stopping_distance
from kompass.algorithms.following.stanley import StanleyLaw, StanleyParams
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.geometry import Floats

# Bearings at which the zone is looked at.
_SECTORS = 72
# A zone that is deformed less than this on the whole leaves the robot to the path.
_UNTOUCHED = 0.01
# The zone's least reach beyond the body [m].
_LEAST = 0.01
# Off straight ahead by less than this, a deformation is on neither side [rad].
_AHEAD = 0.05
# Places looked at along the way on which the robot would brake.
_PLACES = 6
# Deceleration with which the way is looked at, as a share of the robot's; a gate brakes, too.
_SHARE = 0.5
# Too slow to be a motion [m/s].
_STILL = 1e-3


@dataclass(frozen=True, kw_only=True)
class DVZParams(StanleyParams):
    """The zone, and what its deformation does; the path is followed with the gains of Stanley.

    Attributes
    ----------
    min_front_margin
        How far the zone reaches beyond the body ahead, at rest; twice as far at top speed [m].
    side_margin_width_ratio
        Half of the body's width, divided by how far the zone reaches beyond it beside and behind.
    K_linear
        How much a deformation ahead slows down.
    K_angular
        How much a deformation turns away.
    K_I
        How quickly a deformation outweighs the path.
    clearance
        What the body keeps from obstacles on the way on which it would brake [m].
    """

    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {
        **StanleyParams.bounds,
        "min_front_margin": (0.01, 100.0),
        "side_margin_width_ratio": (0.01, 100.0),
        "K_linear": (0.1, 10.0),
        "K_angular": (0.1, 10.0),
        "K_I": (0.1, 100.0),
        "clearance": (0.0, 10.0),
    }

    min_front_margin: float = 0.3
    side_margin_width_ratio: float = 1.0
    K_linear: float = 1.0
    K_angular: float = 1.0
    K_I: float = 5.0
    clearance: float = 0.02


@dataclass(frozen=True)
class Deformation:
    """How the zone is deformed.

    Attributes
    ----------
    depth
        The largest share that is taken, less the more it is taken on opposite sides: 0 when
        untouched, 1 when the body is touched on one side.
    bearing
        Where it points to, the circular mean of all that deform it [rad].
    """

    depth: float = 0.0
    bearing: float = 0.0


class DVZ(StanleyLaw[DVZParams]):
    """Follows a path by Stanley's law, and is pushed off it by what reaches into its zone.

    It reacts to what is near now and plans nothing: in a dead end, or before a wall across the
    path, it stops, and a new path from the planner is what helps.

    Parameters
    ----------
    config
        See :class:`DVZParams`.
    footprint
        The robot's body.
    limits
        ``max_v``, ``max_omega``, ``acc``, ``decel``, ``omega_acc``, ``motion``, as of every
        follower.
    """

    params_class = DVZParams
    needs_obstacles = True

    def __init__(
        self, config: DVZParams | None = None, *, footprint: Footprint, **limits: Any
    ) -> None:
        super().__init__(config, footprint=footprint, **limits)
        self._bearings = -math.pi + math.tau / _SECTORS * (np.arange(_SECTORS) + 0.5)
        self._gives_way = False
        self._side = 0.0  # to which it turns away from what is right ahead: -1.0, 1.0, or neither

    def reset(self) -> None:
        super().reset()
        self._gives_way, self._side = False, 0.0

    def _turns_to_path(self) -> bool:
        # What it has just turned away from, to get round something, it is not to turn back to.
        return not self._gives_way

    def deformation(
        self, obstacles: Floats, speed: float, remaining: float = math.inf
    ) -> Deformation:
        """How the zone is deformed.

        Parameters
        ----------
        obstacles
            Points (N, 2) in the base frame [m].
        speed
            [m/s]
        remaining
            Arc of the path that is left [m]. Towards its end the zone shrinks: the goal is there to
            be reached, beside whatever it lies.
        """
        config, body = self.config, self._body
        front = config.min_front_margin * (1.0 + abs(speed) / self._linear.max_vel)
        half_width = float(np.abs(body.corners[:, 1]).max())
        side = half_width / config.side_margin_width_ratio
        front, side = (min(each, max(remaining, _LEAST)) for each in (front, side))
        reach = body.radius + max(front, side)
        near = obstacles[np.hypot(obstacles[:, 0], obstacles[:, 1]) < reach]
        if not len(near):
            return Deformation()
        room = body.distance(near)
        bearing = np.arctan2(near[:, 1], near[:, 0])
        # Half an ellipse ahead, half a circle behind.
        ahead = np.maximum(np.cos(bearing), 0.0)
        margin = 1.0 / np.sqrt((ahead / front) ** 2 + (1.0 - ahead**2) / side**2)
        taken = np.clip(1.0 - room / margin, 0.0, 1.0)
        sector = np.floor((bearing + math.pi) * (_SECTORS / math.tau)).astype(np.int64) % _SECTORS
        most = np.zeros(_SECTORS)
        np.maximum.at(most, sector, taken)
        whole = float(most.sum())
        if whole <= 0.0:
            return Deformation()
        x = float(most @ np.cos(self._bearings)) / whole
        y = float(most @ np.sin(self._bearings)) / whole
        return Deformation(float(most.max()) * math.hypot(x, y), math.atan2(y, x))

    def _drive(self, situation: Situation) -> tuple[float, float, float]:
        config = self.config
        v_path, _, omega_path = super()._drive(situation)
        remaining = situation.tracker.remaining
        found = self.deformation(situation.obstacles, situation.speed, remaining)
        self._gives_way = found.depth > _UNTOUCHED
        if not self._gives_way:
            self._side = 0.0
        follows = 1.0 / (1.0 + config.K_I * found.depth)
        ahead = max(0.0, math.cos(found.bearing))
        v_away = v_path * max(0.0, 1.0 - config.K_linear * found.depth * ahead)
        omega_away = self._away(found, omega_path)
        v = (1.0 - follows) * v_away + follows * v_path
        omega = (1.0 - follows) * omega_away + follows * omega_path
        omega = min(max(omega, -self._angular.max_vel), self._angular.max_vel)
        free = self._that_is_free(v, omega, situation)
        if free < v and free <= _STILL:
            # What follows the path would balance what turns away from where it leads to.
            omega = omega_away
            if self.motion.is_steered or abs(omega) < config.min_turn_rate:
                nearest = float(self._body.distance(situation.obstacles).min())
                raise NoCommand(
                    f"No way ahead is free; the nearest obstacle is {nearest:.2f} m off."
                )
        return free, 0.0, omega

    def _away(self, found: Deformation, omega_path: float) -> float:
        """The rate of turning away [rad/s]: the faster the more it is ahead, and the deeper."""
        if abs(found.bearing) > _AHEAD:
            self._side = -math.copysign(1.0, found.bearing)
        elif self._side == 0.0:
            self._side = math.copysign(1.0, omega_path)
        share = (math.pi - abs(found.bearing)) / math.pi
        strength = min(1.0, self.config.K_angular * share * found.depth)
        return self._side * self._angular.max_vel * strength

    def _that_is_free(self, v: float, omega: float, situation: Situation) -> float:
        """The speed [m/s], at most ``v``, from which the body stops before it meets something."""
        body, points, clearance = self._body, situation.obstacles, self.config.clearance
        decel = _SHARE * self._linear.max_decel
        reach = stopping_distance(v, decel, 1.5 * situation.dt) + body.radius + clearance
        near = points[np.hypot(points[:, 0], points[:, 1]) <= reach]
        if not len(near) or v <= _STILL:
            return v
        # Who is too close already may go where that gets no closer.
        here = float(body.distance(near).min())
        return self._as_fast_as_free(v, omega, situation.dt, near, min(here, clearance))

    def _as_fast_as_free(
        self, v: float, omega: float, dt: float, near: Floats, clearance: float
    ) -> float:
        decel = _SHARE * self._linear.max_decel
        for share in (1.0, 0.7, 0.4, 0.15):
            curvature = omega / (share * v)
            braking = stopping_distance(share * v, decel, 1.5 * dt)
            along = np.linspace(0.0, braking, _PLACES + 1)[1:]
            turn = curvature * along
            half = 0.5 * turn
            chord = along * np.sinc(half / math.pi)
            x, y = chord * np.cos(half), chord * np.sin(half)
            # The points as the body sees them from each place.
            dx, dy = near[:, 0] - x[:, None], near[:, 1] - y[:, None]
            cos, sin = np.cos(turn)[:, None], np.sin(turn)[:, None]
            seen = np.stack([cos * dx + sin * dy, cos * dy - sin * dx], axis=-1)
            if float(self._body.distance(seen.reshape(-1, 2)).min()) >= clearance - 1e-9:
                return share * v
        return 0.0
