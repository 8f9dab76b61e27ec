"""A further topic as it is drawn: points, lines, areas and texts, bounded where it was read."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.layers.palette import Palette, Rgb
from kompass_console.scene.layers.shapes import Faces, Vertices
from kompass_console.schema.world import Shape, ShapeLabel

_POINT = 0.016  # m
_OPACITY = 0.55


def extra_colour(topic: str, colours: Palette) -> Rgb:
    """The colour of a topic: always the same one, on the flat map and in the list of layers too."""
    return colours.extras[sum(topic.encode()) % len(colours.extras)]


class ExtraNodes:
    """One further topic on one page; another one later on, in the same nodes."""

    def __init__(self, scene: viser.SceneApi, name: str) -> None:
        self._scene, self._name = scene, name
        grey = (128, 128, 128)
        self._frame = scene.add_frame(name, show_axes=False)
        self._points = scene.add_point_cloud(
            f"{name}/points",
            np.zeros((0, 3), np.float32),
            grey,
            point_size=_POINT,
            point_shape="circle",
            point_shading="flat",
            precision="float32",
        )
        self._lines: viser.LineSegmentsHandle | None = None
        self._areas: viser.MeshHandle | None = None
        self._labels: list[viser.LabelHandle] = []
        self._texts: tuple[ShapeLabel, ...] = ()

    def draw(self, shape: Shape, colour: Rgb) -> None:
        self._frame.visible = True
        self._points.points = shape.points
        self._points.colors = _colours(shape.point_colours, len(shape.points), colour)
        self._draw_lines(shape, colour)
        self._draw_areas(shape, colour)
        if shape.labels != self._texts:
            self._draw_labels(shape.labels)

    def hide(self) -> None:
        """Show nothing, and keep nothing."""
        self.draw(Shape(), (128, 128, 128))
        self._frame.visible = False

    def _draw_lines(self, shape: Shape, colour: Rgb) -> None:
        segments = shape.segments
        if len(segments) == 0:
            if self._lines is not None:
                self._lines.visible = False
                self._lines.points = segments
            return
        own = _colours(shape.segment_colours, len(segments), colour)
        ends = np.repeat(own[:, None], 2, axis=1)
        if self._lines is None:
            self._lines = self._scene.add_line_segments(
                f"{self._name}/lines", segments, ends, thickness=2.5, thickness_units="screen"
            )
        self._lines.points = segments
        self._lines.colors = ends
        self._lines.visible = True

    def _draw_areas(self, shape: Shape, colour: Rgb) -> None:
        if len(shape.areas) == 0:
            if self._areas is not None:
                self._areas.visible = False
            return
        vertices, faces = quads(shape.areas)
        if self._areas is None:
            self._areas = self._scene.add_mesh_simple(
                f"{self._name}/areas",
                vertices,
                faces,
                color=colour,
                opacity=_OPACITY,
                flat_shading=True,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
            )
        self._areas.color = colour
        self._areas.vertices = vertices
        self._areas.faces = faces
        self._areas.visible = True

    def _draw_labels(self, labels: tuple[ShapeLabel, ...]) -> None:
        for label in self._labels:
            label.remove()
        self._texts = labels
        self._labels = [
            self._scene.add_label(
                f"{self._name}/label{number}", label.text, position=label.at, anchor="bottom-center"
            )
            for number, label in enumerate(labels)
        ]


def quads(areas: npt.NDArray[np.float32]) -> tuple[Vertices, Faces]:
    """Mesh of areas of four corners each (K, 4, 3)."""
    first = np.arange(len(areas), dtype=np.uint32)[:, None] * 4
    halves = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    return areas.reshape(-1, 3), np.concatenate([first + halves[0], first + halves[1]])


def _colours(own: npt.NDArray[np.uint8] | None, count: int, colour: Rgb) -> npt.NDArray[np.uint8]:
    return np.tile(np.array(colour, np.uint8), (count, 1)) if own is None else own
