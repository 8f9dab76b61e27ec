"""The laser scan: small points where the beams ended, drawn from where the scan was taken."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.palette import palette
from kompass_console.settings import Theme
from kompass_console.world import Pose, Scan

_HEIGHT = 0.05  # m; where the beams really are they would float over the low walls
_POINT = 0.028  # m
_MOST_POINTS = 2000


@dataclass(frozen=True, slots=True)
class ScanDrawing:
    """Points float16 (N, 3) in the sensor's frame, and the sensor's pose in the map frame."""

    points: npt.NDArray[np.float16]
    sensor: Pose


def convert(scan: Scan, sensor: Pose) -> ScanDrawing:
    """Drawing of a scan; beams without a return are left out."""
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    hit = np.isfinite(scan.ranges)
    hit &= (scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max)
    ranges, angles = scan.ranges[hit], angles[hit]
    if len(ranges) > _MOST_POINTS:
        step = -(-len(ranges) // _MOST_POINTS)
        ranges, angles = ranges[::step], angles[::step]
    points = np.column_stack(
        [ranges * np.cos(angles), ranges * np.sin(angles), np.full(len(ranges), _HEIGHT)]
    )
    return ScanDrawing(points.astype(np.float16), sensor)


class ScanNodes:
    """The scan on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, theme: Theme) -> None:
        self._points = scene.add_point_cloud(
            f"{parent}/scan",
            np.zeros((0, 3), np.float16),
            palette(theme).scan,
            point_size=_POINT,
            point_shape="circle",
            point_shading="flat",
            precision="float16",
        )

    def draw(self, drawing: ScanDrawing) -> None:
        yaw = drawing.sensor.yaw
        self._points.points = drawing.points
        self._points.position = (drawing.sensor.x, drawing.sensor.y, 0.0)
        self._points.wxyz = (math.cos(yaw / 2.0), 0.0, 0.0, math.sin(yaw / 2.0))

    def show(self, visible: bool) -> None:
        self._points.visible = visible
