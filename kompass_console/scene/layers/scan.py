"""The laser scan: small points where the beams ended, drawn from where the scan was taken."""

from __future__ import annotations

import numpy as np
import viser

from kompass_console.scene.layers.map import WALL_HEIGHT
from kompass_console.scene.layers.palette import Rgb
from kompass_console.scene.layers.shapes import Vertices, placed
from kompass_console.schema.world import Pose, Scan

_HEIGHT = WALL_HEIGHT + 0.01  # m; on top of the walls, or these would hide half of the points
_POINT = 0.013  # m
_MOST_POINTS = 2000


def scan_points(scan: Scan, sensor: Pose) -> Vertices:
    """Points (N, 3) where the beams ended, in the map frame, of a scan taken with the sensor at
    `sensor`; beams without a return are left out."""
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
    return placed(points.astype(np.float32), sensor)


class ScanNodes:
    """A scan on one page; also used for the preview of one."""

    def __init__(
        self, scene: viser.SceneApi, name: str, colour: Rgb, point_size: float = _POINT
    ) -> None:
        self._points = scene.add_point_cloud(
            name,
            np.zeros((0, 3), np.float32),
            colour,
            point_size=point_size,
            point_shape="circle",
            point_shading="flat",
            precision="float32",
        )

    def draw(self, points: Vertices) -> None:
        self._points.points = points

    def show(self, visible: bool) -> None:
        self._points.visible = visible
