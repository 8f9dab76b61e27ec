"""Where the robot is sent: a ring on the floor, with an arrow when the heading matters."""

from __future__ import annotations

import math

import numpy as np
import viser

from kompass_console.scene.layers.palette import Rgb
from kompass_console.scene.layers.shapes import circle, closed_segments, flat_arrow
from kompass_console.schema.world import GoalMark

_RADIUS = 0.14  # m
_HEIGHT = 0.025


class GoalNodes:
    """A goal on one page; also used for the preview of one."""

    def __init__(self, scene: viser.SceneApi, name: str, colour: Rgb) -> None:
        self._visible = True
        self._mark: GoalMark | None = None
        self._frame = scene.add_frame(name, show_axes=False, visible=False)
        rings = [closed_segments(circle(r), _HEIGHT) for r in (_RADIUS, _RADIUS * 0.3)]
        scene.add_line_segments(
            f"{name}/ring", np.concatenate(rings), colour, thickness=3.0, thickness_units="screen"
        )
        vertices, faces = flat_arrow(_RADIUS * 3.2, _RADIUS * 1.3, _HEIGHT)
        self._arrow = scene.add_mesh_simple(
            f"{name}/arrow",
            vertices,
            faces,
            color=colour,
            side="double",
            flat_shading=True,
            cast_shadow=False,
            receive_shadow=False,
        )

    def draw(self, mark: GoalMark | None) -> None:
        self._mark = mark
        if mark is not None:
            yaw = mark.yaw or 0.0
            self._frame.position = (mark.x, mark.y, 0.0)
            self._frame.wxyz = (math.cos(yaw / 2.0), 0.0, 0.0, math.sin(yaw / 2.0))
            self._arrow.visible = mark.yaw is not None
        self._frame.visible = self._visible and mark is not None

    def show(self, visible: bool) -> None:
        self._visible = visible
        self._frame.visible = visible and self._mark is not None
