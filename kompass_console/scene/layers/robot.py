"""The robot: a body with a clear front, inside the outline of its footprint."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.layers.palette import Rgb
from kompass_console.scene.layers.shapes import circle, closed_segments, prism
from kompass_console.schema.world import Pose

_DEFAULT_RADIUS = 0.11  # m, until the footprint is known
_OUTLINE_HEIGHT = 0.02


def outline(footprint: npt.NDArray[np.float64] | None) -> npt.NDArray[np.float64]:
    """The footprint (N, 2) to draw: the robot's own, or a circle until it is known."""
    if footprint is None or len(footprint) < 3:
        return circle(_DEFAULT_RADIUS)
    return footprint


@dataclass(frozen=True, slots=True)
class RobotColours:
    """Of what a robot is drawn with."""

    body: Rgb
    front: Rgb
    footprint: Rgb


class RobotNodes:
    """A robot on one page."""

    def __init__(self, scene: viser.SceneApi, name: str, colours: RobotColours) -> None:
        self._scene = scene
        self._colours = colours
        self._name = name
        self._frame = scene.add_frame(name, show_axes=False, visible=False)
        self._placed = False
        self._visible = True
        self.draw_body(None)

    def draw_body(self, footprint: npt.NDArray[np.float64] | None) -> None:
        """Build the body to the size of the footprint."""
        drawn = outline(footprint)
        size = float(np.linalg.norm(drawn, axis=1).max())
        colours = self._colours
        body = circle(size * 0.86, 48)
        arrow = size * np.array([[0.78, 0.0], [-0.5, 0.58], [-0.24, 0.0], [-0.5, -0.58]])
        self._mesh("body", *prism(body, size * 0.15, size * 0.75), colours.body)
        # The chevron is not convex, so it is two halves; both lie on top of the body.
        for side, points in (("left", arrow[[0, 1, 2]]), ("right", arrow[[0, 2, 3]])):
            solid = prism(points, size * 0.75, size * 0.95)
            self._mesh(f"front_{side}", *solid, colours.front)
        self._scene.add_line_segments(
            f"{self._name}/footprint",
            closed_segments(drawn, _OUTLINE_HEIGHT),
            colours.footprint,
            thickness=2.0,
            thickness_units="screen",
        )

    def _mesh(
        self,
        name: str,
        vertices: npt.NDArray[np.float32],
        faces: npt.NDArray[np.uint32],
        colour: tuple[int, int, int],
    ) -> None:
        self._scene.add_mesh_simple(
            f"{self._name}/{name}",
            vertices,
            faces,
            color=colour,
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )

    def place(self, pose: Pose) -> None:
        """Move the robot to a pose of the map frame."""
        self._frame.position = (pose.x, pose.y, 0.0)
        self._frame.wxyz = (math.cos(pose.yaw / 2.0), 0.0, 0.0, math.sin(pose.yaw / 2.0))
        if not self._placed:
            self._placed = True
            self._frame.visible = self._visible

    def show(self, visible: bool) -> None:
        self._visible = visible
        self._frame.visible = visible and self._placed
