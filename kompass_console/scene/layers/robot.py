"""The robot: as it describes itself, else a body with a clear front; its shadow and footprint."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import viser
from scipy.spatial import ConvexHull

from kompass_console.scene.layers.palette import Rgb
from kompass_console.scene.layers.shapes import Faces, Vertices, circle, closed_segments, prism
from kompass_console.scene.urdf import Description, Solid
from kompass_console.schema.world import Pose

_DEFAULT_RADIUS = 0.11  # m, until the footprint is known
_OUTLINE_HEIGHT = 0.02
_SHADOW = (0, 0, 0)
# A robot in a hall of 80 m is smaller than this on the screen: then a dot shows where it is. Nearer
# by, the body stands over it.
_DOT = 11.0  # pixels
_POINT = np.array([[[-0.001, 0.0, 0.01], [0.001, 0.0, 0.01]]], dtype=np.float32)


def outline(footprint: npt.NDArray[np.float64] | None) -> npt.NDArray[np.float64]:
    """The footprint (N, 2) to draw: the robot's own, or a circle until it has an area."""
    if footprint is None or np.linalg.matrix_rank(footprint - footprint[:1], tol=1e-6) < 2:
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
        self._meshes: list[viser.MeshHandle] = []
        self.draw_body(None)

    def draw_body(
        self, footprint: npt.NDArray[np.float64] | None, description: Description | None = None
    ) -> None:
        """Build the body as the robot describes itself, else to the size of the footprint."""
        for mesh in self._meshes:
            mesh.remove()
        self._meshes = []
        drawn = outline(footprint)
        size = float(np.linalg.norm(drawn, axis=1).max())
        colours = self._colours
        self._mesh("shadow", *_shadow(drawn), _SHADOW, opacity=0.28)
        solids = body_of(drawn, colours) if description is None else description.solids
        for number, (colour, vertices, faces) in enumerate(by_colour(solids, colours.body)):
            self._mesh(f"body_{number}", vertices, faces, colour)
        if description is not None:
            # A description need not show which side is ahead: an arrow before it does.
            self._chevron(size * np.array([[1.5, 0.0], [1.14, 0.2], [1.22, 0.0], [1.14, -0.2]]))
        self._scene.add_line_segments(
            f"{self._name}/footprint",
            closed_segments(drawn, _OUTLINE_HEIGHT),
            colours.footprint,
            thickness=2.0,
            thickness_units="screen",
        )
        self._scene.add_line_segments(
            f"{self._name}/dot",
            _POINT,
            colours.footprint,
            thickness=_DOT,
            thickness_units="screen",
        )

    def _mesh(
        self,
        name: str,
        vertices: npt.NDArray[np.float32],
        faces: npt.NDArray[np.uint32],
        colour: tuple[int, int, int],
        opacity: float | None = None,
    ) -> None:
        mesh = self._scene.add_mesh_simple(
            f"{self._name}/{name}",
            vertices,
            faces,
            color=colour,
            opacity=opacity,
            flat_shading=True,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )
        self._meshes.append(mesh)

    def _chevron(self, points: npt.NDArray[np.float64]) -> None:
        """An arrow head on the floor; it is not convex, so it is two halves."""
        for side, half in (("left", points[[0, 1, 2]]), ("right", points[[0, 2, 3]])):
            solid = prism(half, 0.01, 0.02)
            self._mesh(f"front_{side}", *solid, self._colours.footprint)

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


def body_of(footprint: npt.NDArray[np.float64], colours: RobotColours) -> list[Solid]:
    """A body of a footprint (N, 2): on wheels, a lidar on top, and an arrow that points ahead.

    Nothing is known of such a robot but its outline, so nothing of the body stands out of it.
    """
    size = float(np.linalg.norm(footprint, axis=1).max())
    width = float(np.abs(footprint[:, 1]).max())
    height = min(0.9 * size, 0.6)
    shell = _hull(footprint) * 0.9
    arrow = size * np.array([[0.74, 0.0], [-0.1, 0.52], [0.12, 0.0], [-0.1, -0.52]])
    dark, thick, radius = _darker(colours.body), 0.12 * width, 0.3 * size
    wheel = np.array([[radius, -thick], [radius, thick], [-radius, thick], [-radius, -thick]])
    solids = [
        Solid(*prism(shell, 0.2 * height, 0.8 * height), colours.body),
        Solid(*prism(shell * 0.86, 0.8 * height, 0.86 * height), dark),
        Solid(*prism(circle(0.2 * size, 24) - [0.3 * size, 0.0], 0.86 * height, height), dark),
        *(
            Solid(*prism(wheel + np.array([0.0, side * 0.84 * width]), 0.0, 0.45 * height), dark)
            for side in (-1.0, 1.0)
        ),
    ]
    halves = (arrow[[0, 1, 2]], arrow[[0, 2, 3]])  # it is not convex
    front = [Solid(*prism(half, 0.86 * height, 0.94 * height), colours.front) for half in halves]
    return [*solids, *front]


def by_colour(solids: Sequence[Solid], usual: Rgb) -> list[tuple[Rgb, Vertices, Faces]]:
    """Solids put together, one for each colour: a page draws few large things faster."""
    groups: dict[Rgb, list[Solid]] = {}
    for solid in solids:
        groups.setdefault(solid.colour or usual, []).append(solid)
    made = []
    for colour, group in groups.items():
        begins = np.cumsum([0, *(len(solid.vertices) for solid in group)])
        faces = [solid.faces + begin for solid, begin in zip(group, begins[:-1], strict=True)]
        vertices = np.concatenate([solid.vertices for solid in group])
        made.append((colour, vertices, np.concatenate(faces).astype(np.uint32)))
    return made


def _hull(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """The convex hull of an outline (N, 2), anticlockwise."""
    return np.asarray(points[ConvexHull(points).vertices])


def _shadow(footprint: npt.NDArray[np.float64]) -> tuple[Vertices, Faces]:
    """What lies under the robot, a little to the side that the light does not come from."""
    size = float(np.linalg.norm(footprint, axis=1).max())
    return prism(_hull(footprint) * 1.06 + [0.03 * size, 0.03 * size], 0.004, 0.005)


def _darker(colour: Rgb) -> Rgb:
    red, green, blue = (round(part * 0.62) for part in colour)
    return red, green, blue
