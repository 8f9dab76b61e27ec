"""The peer's half of ``benchmarks/kompass_core.py``: runs in an environment with kompass-core.

Reads lines ``NAME CALLS`` and answers each with the processor time of one call [s].
"""

import logging
import math
import sys
import time
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
from kompass_core import set_logging_level
from kompass_core.control import DWA, DWAConfig, TrajectoryCostsWeights
from kompass_core.datatypes import PoseData, ScanModelConfig
from kompass_core.mapping import LocalMapper, MapConfig
from kompass_core.models import (
    AngularCtrlLimits,
    LinearCtrlLimits,
    Robot,
    RobotCtrlLimits,
    RobotGeometry,
    RobotState,
    RobotType,
)
from kompass_core.third_party.ompl.planner import OMPLGeometric, OMPLGeometricConfig

logging.disable(logging.CRITICAL)
set_logging_level("error")
RESOLUTION, RADIUS = 0.05, 0.1  # m


def flower(rays):
    """A scan with walls at 3 to 7 m."""
    angles = -np.pi + np.arange(rays) * 2 * np.pi / rays
    return (5.0 + 2.0 * np.sin(20 * angles)).astype(np.float32), angles.astype(np.float32)


def robot():
    return Robot(
        robot_type=RobotType.DIFFERENTIAL_DRIVE,
        geometry_type=RobotGeometry.Type.CYLINDER,
        geometry_params=np.array([RADIUS, 0.3]),
    )


def mapper(bayesian):
    made = LocalMapper(
        MapConfig(width=20.0, height=20.0, resolution=RESOLUTION, bayesian_update=bayesian),
        ScanModelConfig(),
    )
    ranges, angles = flower(3600)
    pose = PoseData()

    def call():
        pose.x += 0.001
        made.update_from_laserscan(pose, ranges=ranges, angles=angles)

    return call


def dwa(rays):
    limits = RobotCtrlLimits(
        vx_limits=LinearCtrlLimits(max_vel=1.0, max_acc=5.0, max_decel=10.0),
        omega_limits=AngularCtrlLimits(max_omega=2.0, max_ang=np.pi, max_acc=10.0, max_decel=10.0),
    )
    weights = TrajectoryCostsWeights(
        reference_path_distance_weight=1.0,
        goal_distance_weight=1.0,
        obstacles_distance_weight=1.0,
        smoothness_weight=1.0,
        jerk_weight=1.0,
    )
    config = DWAConfig(
        max_linear_samples=48,
        max_angular_samples=98,
        prediction_horizon=10,
        control_horizon=2,
        control_time_step=0.1,
        max_num_threads=1,
        costs_weights=weights,
    )
    controller = DWA(robot=robot(), ctrl_limits=limits, config=config)
    poses = [
        SimpleNamespace(pose=SimpleNamespace(position=SimpleNamespace(x=float(x), y=0.0)))
        for x in np.linspace(0, 10, 1000)
    ]
    controller.set_path(SimpleNamespace(poses=poses))
    ranges, angles = flower(rays)
    state = RobotState(x=1.0, y=0.05, yaw=0.05, speed=0.5, vx=0.5, omega=0.0)

    def call():
        if not controller.loop_step(current_state=state, ranges=ranges, angles=angles):
            raise SystemExit("the DWA of kompass-core found nothing")

    return call


def plan():
    cells = np.zeros((200, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    cells[60, :150] = cells[120, 50:] = cells[160, :140] = 100
    rows, cols = np.nonzero(cells)
    middles = np.stack([cols + 0.5, rows + 0.5], 1) * RESOLUTION - 5.0
    points = np.column_stack([middles, np.full(len(rows), 0.01)]).astype(np.float32)
    planner = OMPLGeometric(robot=robot(), config=OMPLGeometricConfig(), log_level="ERROR")
    place = {"origin_x": -5.0, "origin_y": -5.0, "width": 200, "height": 200}

    def call():
        planner.setup_problem(
            {**place, "resolution": RESOLUTION}, -4.0, -4.0, 0.0, 4.0, 4.0, 0.0, points
        )
        solved = planner.solve()
        if solved is None:
            return
        at = np.array([(state.getX(), state.getY()) for state in solved.getStates()])
        lengths.append(float(np.hypot(*np.diff(at, axis=0).T).sum()))
        gaps.append(least_gap(at, middles))

    return call


def least_gap(path, middles):
    """From the robot's body to the middle of an occupied cell, anywhere on a path [m]."""
    least = math.inf
    for start, end in pairwise(path):
        steps = max(2, int(np.hypot(*(end - start)) / 0.02))
        for point in np.linspace(start, end, steps):
            least = min(least, float(np.hypot(*(middles - point).T).min()))
    return least - RADIUS


MAKE = {
    "map": lambda: mapper(False),
    "bayesian": lambda: mapper(True),
    "dwa 360": lambda: dwa(360),
    "dwa 3600": lambda: dwa(3600),
    "plan": plan,
}
lengths, gaps = [], []
calls = {}
for line in sys.stdin:
    name, count = line.strip().rsplit(" ", 1)
    if name not in calls:
        calls[name] = MAKE[name]()
        calls[name]()
    began = time.process_time()
    for _ in range(int(count)):
        calls[name]()
    took = (time.process_time() - began) / int(count)
    more = f" {np.median(lengths):.3f} {min(gaps):.3f}" if name == "plan" and lengths else ""
    print(f"{took}{more}", flush=True)
