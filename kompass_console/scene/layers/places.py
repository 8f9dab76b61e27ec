"""Named places: a small pin on the floor each, with its name beside it."""

from __future__ import annotations

import math

import numpy as np
import viser

from kompass_console.scene.layers.palette import Rgb
from kompass_console.scene.layers.shapes import Vertices, circle, closed_segments
from kompass_console.schema.world import PlaceMark

_RADIUS = 0.11  # m
_HEIGHT = 0.02
_LABEL_HEIGHT = 0.18
_RIM = 20  # corners


def place_segments(places: tuple[PlaceMark, ...]) -> Vertices:
    """Line segments (N, 2, 3) of all pins: a ring each, and a stroke where a heading counts."""
    parts = [np.zeros((0, 2, 3), np.float32)]
    for place in places:
        centre = np.array([place.x, place.y])
        parts.append(closed_segments(centre + circle(_RADIUS, _RIM), _HEIGHT))
        if place.yaw is not None:
            ahead = np.array([math.cos(place.yaw), math.sin(place.yaw)])
            ends = [centre + ahead * _RADIUS, centre + ahead * _RADIUS * 2.2]
            stroke = [[*end, _HEIGHT] for end in ends]
            parts.append(np.array([stroke], np.float32))
    return np.concatenate(parts)


class PlaceNodes:
    """The places on one page."""

    def __init__(self, scene: viser.SceneApi, parent: str, colour: Rgb) -> None:
        self._scene, self._name, self._colour = scene, f"{parent}/places", colour
        self._frame = scene.add_frame(self._name, show_axes=False)
        self._pins: viser.LineSegmentsHandle | None = None
        self._labels: list[viser.LabelHandle] = []

    def draw(self, places: tuple[PlaceMark, ...]) -> None:
        # Places change by a person's hand, now and then: all are made again.
        for label in self._labels:
            label.remove()
        self._labels = []
        if self._pins is not None:
            self._pins.remove()
            self._pins = None
        if not places:
            return
        self._pins = self._scene.add_line_segments(
            f"{self._name}/pins",
            place_segments(places),
            self._colour,
            thickness=3.0,
            thickness_units="screen",
        )
        self._labels = [
            self._scene.add_label(
                f"{self._name}/{number}",
                place.name,
                position=(place.x, place.y, _LABEL_HEIGHT),
                anchor="bottom-center",
            )
            for number, place in enumerate(places)
        ]

    def show(self, visible: bool) -> None:
        self._frame.visible = visible
