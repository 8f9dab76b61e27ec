"""What there is to draw at one moment, converted once for all pages."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from kompass_console.scene.layers.local_map import LocalMapDrawing, local_map_drawing
from kompass_console.scene.layers.map import MapDrawing, map_drawing
from kompass_console.scene.layers.path import path_segments
from kompass_console.scene.layers.scan import scan_points
from kompass_console.scene.layers.shapes import Vertices
from kompass_console.scene.layers.trail import Trail
from kompass_console.scene.urdf import BadDescription, Description, read_description
from kompass_console.schema.plain import plain
from kompass_console.schema.world import (
    GoalMark,
    HindranceMark,
    PlaceMark,
    Pose,
    Shape,
    Stamped,
    WorldModel,
    ZoneMark,
)

LayerKey = str

_logger = logging.getLogger(__name__)

# Seconds between two conversions of a layer, at least.
_PERIODS: dict[LayerKey, float] = {
    "map": 1.0,
    "local_map": 0.2,
    "path": 0.2,
    "scan": 0.1,
    "trail": 0.5,
    "footprint": 1.0,
    "description": 2.0,
    "robot": 0.05,
    "goal": 0.05,
    "hindrance": 0.2,
    "places": 0.2,
    "zones": 0.2,
}


@dataclass
class Drawings:
    """The newest drawing of every layer, and how many there have been of each.

    Pages compare the counts with those they have drawn; a page that has just come finds all. They
    read while another thread converts, so a drawing is there before it is counted: one that was
    counted first would pass for drawn with a page that came in between.
    `extras`, by topic, count by themselves.
    """

    map: MapDrawing | None = None
    local_map: LocalMapDrawing | None = None
    path: Vertices | None = None
    scan: Vertices | None = None
    trail: Vertices | None = None
    footprint: npt.NDArray[np.float64] | None = None
    description: Description | None = None
    robot: Pose | None = None
    goal: GoalMark | None = None
    hindrance: HindranceMark | None = None
    places: tuple[PlaceMark, ...] = ()
    zones: tuple[ZoneMark, ...] = ()
    extras: Mapping[str, Stamped[Shape]] = field(default_factory=dict)
    counts: dict[LayerKey, int] = field(default_factory=lambda: dict.fromkeys(_PERIODS, 0))

    def counted(self, layer: LayerKey) -> None:
        """There is another drawing of a layer."""
        self.counts[layer] += 1


class Converter:
    """Turns what the robot said into drawings, layer by layer, when it changed and is due."""

    def __init__(self, world: WorldModel, drawings: Drawings) -> None:
        self._world = world
        self._drawings = drawings
        self._trail = Trail()
        self._seen: dict[LayerKey, int] = {}
        self._due: dict[LayerKey, float] = {}
        self._trail_changed = False

    def remember(self) -> None:
        """Note where the robot is; all there is to do while nobody watches."""
        motion = self._world.motion.get()
        if motion is not None and self._trail.add(motion.value.pose, motion.received):
            self._trail_changed = True

    def convert(self) -> None:
        """Bring every layer but the map up to date. Call from one thread only."""
        world, drawings = self._world, self._drawings
        self.remember()
        drawings.extras = world.extras
        if (motion := world.motion.get()) is not None and self._is_new("robot", motion.version):
            drawings.robot = motion.value.pose
            drawings.counted("robot")
        if self._trail_changed and self._is_due("trail"):
            self._trail_changed = False
            drawings.trail = self._trail.segments()
            drawings.counted("trail")
        if (goal := world.goal.get()) is not None and self._is_new("goal", goal.version):
            drawings.goal = goal.value
            drawings.counted("goal")
        hindrance = world.hindrance.get()
        if hindrance is not None and self._is_new("hindrance", hindrance.version):
            drawings.hindrance = hindrance.value
            drawings.counted("hindrance")
        if (marks := world.places.get()) is not None and self._is_new("places", marks.version):
            drawings.places = marks.value
            drawings.counted("places")
        if (drawn := world.zones.get()) is not None and self._is_new("zones", drawn.version):
            drawings.zones = drawn.value
            drawings.counted("zones")
        if (scan := world.scan.get()) is not None and self._is_new("scan", scan.version):
            sensor = world.scanned_from(scan.value) or Pose(0.0, 0.0, 0.0)
            drawings.scan = scan_points(scan.value, sensor)
            drawings.counted("scan")
        if (path := world.path.get()) is not None and self._is_new("path", path.version):
            drawings.path = path_segments(path.value)
            drawings.counted("path")
        local = world.local_map.get()
        if local is not None and self._is_new("local_map", local.version):
            drawings.local_map = local_map_drawing(local.value)
            drawings.counted("local_map")
        footprint = world.footprint.get()
        if footprint is not None and self._is_new("footprint", footprint.version):
            drawings.footprint = footprint.value
            drawings.counted("footprint")
        described = world.description.get()
        if described is not None and self._is_new("description", described.version):
            self._describe(described.value)
            drawings.counted("description")

    def convert_map(self) -> None:
        """Bring the map up to date, which takes seconds where it is large: call from a thread of
        its own, and only from that one."""
        grid = self._world.map.get()
        if grid is not None and self._is_new("map", grid.version):
            self._drawings.map = map_drawing(grid.value, grid.version)
            self._drawings.counted("map")

    def _describe(self, text: str) -> None:
        """Read the robot's own description; without one that can be read, it has none."""
        drawings, world = self._drawings, self._world
        try:
            drawings.description = read_description(text)
        except BadDescription as error:
            drawings.description = None
            world.description_problem = f"The robot's description is not drawn: {error}."
        else:
            left_out = "; ".join(drawings.description.problems)
            world.description_problem = (
                f"Of the robot's description, {left_out}." if left_out else ""
            )
        if plain(world.description_problem) != "":
            _logger.warning("%s", plain(world.description_problem))

    def _is_new(self, layer: LayerKey, version: int) -> bool:
        if self._seen.get(layer) == version or not self._is_due(layer):
            return False
        self._seen[layer] = version
        return True

    def _is_due(self, layer: LayerKey) -> bool:
        now = time.monotonic()
        if now < self._due.get(layer, 0.0):
            return False
        self._due[layer] = now + _PERIODS[layer] * 0.9
        return True
