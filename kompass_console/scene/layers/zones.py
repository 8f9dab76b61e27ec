"""Zones on the floor: an outline each, hatched as plans mark what is not to be entered."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.layers.palette import Palette, Rgb
from kompass_console.scene.layers.shapes import Vertices, closed_segments
from kompass_console.schema.world import ZoneMark

_HEIGHT = 0.015  # m; below places and paths
_LABEL_HEIGHT = 0.12
_MOST_STROKES = 80  # of one zone
_SPACING = {"keep_out": 0.12, "speed": 0.3}  # m between strokes
_SLANT = math.pi / 4


def hatch(corners: npt.NDArray[np.float64], spacing: float) -> npt.NDArray[np.float64]:
    """Slanted strokes (N, 2, 2) that fill a polygon (M, 2), by where they meet its edges [m]."""
    along = np.array([math.cos(_SLANT), math.sin(_SLANT)])
    across = np.array([-along[1], along[0]])
    turned = np.column_stack([corners @ along, corners @ across])
    low, high = turned[:, 1].min(), turned[:, 1].max()
    spacing = max(spacing, (high - low) / _MOST_STROKES)
    following = np.roll(turned, -1, axis=0)
    strokes = []
    for level in np.arange(math.floor(low / spacing) + 1, math.ceil(high / spacing)) * spacing:
        meets = (turned[:, 1] <= level) != (following[:, 1] <= level)
        a, b = turned[meets], following[meets]
        at = np.sort(a[:, 0] + (level - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
        for start, end in at[: len(at) // 2 * 2].reshape(-1, 2):
            strokes.append([start * along + level * across, end * along + level * across])
    return np.asarray(strokes, dtype=np.float64).reshape(-1, 2, 2)


def zone_segments(zone: ZoneMark) -> Vertices:
    """Line segments (N, 2, 3) of a zone."""
    corners = np.asarray(zone.corners, dtype=np.float64)
    spacing = _SPACING["keep_out" if zone.speed is None else "speed"]
    strokes = hatch(corners, spacing)
    floor = np.full((*strokes.shape[:2], 1), _HEIGHT)
    outline = closed_segments(corners, _HEIGHT)
    return np.concatenate([outline, np.concatenate([strokes, floor], axis=2)]).astype(np.float32)


def zone_label(zone: ZoneMark) -> str:
    """The name of a zone, and what it asks for."""
    return f"{zone.name}: keep out" if zone.speed is None else f"{zone.name}: {zone.speed:.2g} m/s"


class ZoneNodes:
    """The zones on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, colours: Palette) -> None:
        self._scene, self._name, self._colours = scene, f"{parent}/zones", colours
        self._frame = scene.add_frame(self._name, show_axes=False)
        self._nodes: list[viser.LineSegmentsHandle | viser.LabelHandle] = []

    def draw(self, zones: tuple[ZoneMark, ...]) -> None:
        # Zones change by a person's hand, now and then: all are made again.
        for node in self._nodes:
            node.remove()
        self._nodes = []
        for number, zone in enumerate(zones):
            colour: Rgb = self._colours.alert if zone.speed is None else self._colours.in_force
            self._nodes.append(
                self._scene.add_line_segments(
                    f"{self._name}/{number}",
                    zone_segments(zone),
                    colour,
                    thickness=2.0,
                    thickness_units="screen",
                )
            )
            x, y = np.asarray(zone.corners).mean(axis=0)
            self._nodes.append(
                self._scene.add_label(
                    f"{self._name}/label{number}",
                    zone_label(zone),
                    position=(float(x), float(y), _LABEL_HEIGHT),
                    anchor="bottom-center",
                )
            )

    def show(self, visible: bool) -> None:
        self._frame.visible = visible
