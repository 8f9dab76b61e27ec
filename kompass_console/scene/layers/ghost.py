"""The robot of a drive that is played: its body and name, its way, and what befell it where."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.drive_drawing import Mark, MarkKind, Side, SideDrawing
from kompass_console.scene.layers.palette import Rgb, palette
from kompass_console.scene.layers.path import PathNodes
from kompass_console.scene.layers.robot import RobotColours, RobotNodes, outline
from kompass_console.scene.layers.shapes import Vertices, prism
from kompass_console.schema.models import Theme

NAMES: dict[Side, str] = {"proposed": "Proposed", "in_force": "In force"}

_LINE_PERIOD = 0.25  # s between two drawings of the line behind a robot, at least
_LINE_HEIGHTS: dict[Side, float] = {"in_force": 0.02, "proposed": 0.03}  # m: none hides the other
_MARK_HEIGHT = 0.1  # m
_MARK_RADIUS = 0.09  # m


class GhostNodes:
    """One side of a played drive on one page.

    The robot of the proposed rules is solid, and so is its line; that of the rules in force is
    hollow, and its line dashed: nothing is told by colour alone.
    """

    def __init__(
        self,
        scene: viser.SceneApi,
        parent: str,
        side: Side,
        drawing: SideDrawing,
        footprint: npt.NDArray[np.float64] | None,
        theme: Theme,
    ) -> None:
        colours = palette(theme)
        colour = colours.proposed if side == "proposed" else colours.in_force
        self._side, self._drawing = side, drawing
        self._dashed = side == "in_force"
        name = f"{parent}/{side}"
        hollow = RobotColours(body=colours.free, front=colour, footprint=colour)
        solid = RobotColours(body=colour, front=colours.free, footprint=colour)
        self._robot = RobotNodes(scene, f"{name}/robot", hollow if self._dashed else solid)
        self._robot.draw_body(footprint)
        size = float(np.linalg.norm(outline(footprint), axis=1).max())
        self._label = scene.add_label(
            f"{name}/robot/name",
            NAMES[side],
            position=(0.0, 0.0, 1.2 * size),
            font_screen_scale=1.3,
            # One above and one below its robot: side by side they can both be read.
            anchor="top-center" if self._dashed else "bottom-center",
        )
        whole = PathNodes(scene, f"{name}/way", colour, thickness=1.5)
        whole.draw(_lifted(drawing.way.segments(dashed=False), 0.01))
        self._pieces = _lifted(drawing.way.segments(dashed=self._dashed), _LINE_HEIGHTS[side])
        self._line = PathNodes(scene, f"{name}/driven", colour, thickness=6.0)
        self._line_drawn = (-math.inf, -1)  # when, and how many pieces of it
        shades: dict[MarkKind, Rgb] = {
            "fault": colours.footprint,
            "firing": colour,
            "stop": colours.alert,
            "contact": colours.alert,
        }
        self._marks = [
            (mark, _mark(scene, f"{name}/mark{number}", mark, shades[mark.kind]))
            for number, mark in enumerate(drawing.marks)
        ]

    def draw(self, time: float, now: float) -> None:
        """Show it as it was at a second of the drive; `now` is this machine's clock, s."""
        here = self._drawing.way.at(time)
        if here is not None:
            self._robot.place(here)
        news = self._drawing.news(time)
        text = f"{NAMES[self._side]}: {news}" if news else NAMES[self._side]
        if self._label.text != text:
            self._label.text = text
        for mark, frame in self._marks:
            if frame.visible != (mark.at <= time):
                frame.visible = mark.at <= time
        self._draw_line(self._drawing.way.driven(time, dashed=self._dashed), now)

    def _draw_line(self, pieces: int, now: float) -> None:
        drawn_at, drawn = self._line_drawn
        if pieces != drawn and now - drawn_at >= _LINE_PERIOD:
            self._line_drawn = now, pieces
            self._line.draw(self._pieces[:pieces])


def _lifted(segments: npt.NDArray[np.float64], z: float) -> Vertices:
    """Segments (N, 2, 3) at a height from those of the floor (N, 2, 2)."""
    heights = np.full((*segments.shape[:2], 1), z)
    return np.concatenate([segments, heights], axis=2).astype(np.float32)


def _mark(scene: viser.SceneApi, name: str, mark: Mark, colour: Rgb) -> viser.FrameHandle:
    """A solid of the kind's shape, not yet to be seen."""
    frame = scene.add_frame(name, show_axes=False, position=(mark.x, mark.y, 0.0), visible=False)
    for number, shape in enumerate(_OUTLINES[mark.kind]):
        vertices, faces = prism(_MARK_RADIUS * np.array(shape), 0.0, _MARK_HEIGHT)
        scene.add_mesh_simple(
            f"{name}/{number}",
            vertices,
            faces,
            color=colour,
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )
    return frame


_ARM, _THIN = 0.95, 0.2
_SLANT = np.array([[1.0, -1.0], [1.0, 1.0]]) / math.sqrt(2.0)
_BEAM = np.array([(-_ARM, -_THIN), (_ARM, -_THIN), (_ARM, _THIN), (-_ARM, _THIN)])
# Seen from the south, where the camera stands at first: the shapes of the time line.
_OUTLINES: dict[MarkKind, list[npt.NDArray[np.float64]]] = {
    "fault": [np.array([(-0.95, -0.75), (0.95, -0.75), (0.0, 1.0)])],
    "firing": [np.array([(0.0, -1.0), (0.8, 0.0), (0.0, 1.0), (-0.8, 0.0)])],
    "stop": [np.array([(-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)])],
    "contact": [_BEAM @ _SLANT, _BEAM @ _SLANT.T],
}
