"""The scene as one page sees it: its nodes, its theme, its camera.

All methods run on viser's loop.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import viser

from kompass_console.scene import camera as cameras
from kompass_console.scene.drawings import Drawings, LayerKey
from kompass_console.scene.drive_drawing import DriveDrawing
from kompass_console.scene.layers.cross import CrossNodes
from kompass_console.scene.layers.extra import ExtraNodes, extra_colour
from kompass_console.scene.layers.goal import GoalNodes
from kompass_console.scene.layers.local_map import LocalMapNodes
from kompass_console.scene.layers.map import MapNodes
from kompass_console.scene.layers.palette import palette
from kompass_console.scene.layers.path import PathNodes
from kompass_console.scene.layers.places import PlaceNodes
from kompass_console.scene.layers.preview import Preview, PreviewNodes
from kompass_console.scene.layers.robot import RobotColours, RobotNodes
from kompass_console.scene.layers.scan import ScanNodes
from kompass_console.scene.layers.trail import TrailNodes
from kompass_console.scene.layers.zones import ZoneNodes
from kompass_console.scene.picking import Camera
from kompass_console.scene.playback import Playback
from kompass_console.schema.models import View
from kompass_console.schema.world import Shape, Stamped

_WORLD = "/world"
_SAME_CAMERA = 0.05  # m; a page that reconnects reports the camera it had, to within rounding


@dataclass(frozen=True, slots=True)
class Memory:
    """What a page that lost its connection had in view: camera position (3,) and the shift of
    the world under it (2,), m."""

    position: np.ndarray
    shift: np.ndarray


@dataclass(slots=True)
class _Extra:
    """Nodes for a further topic, and which drawing of which topic they show."""

    nodes: ExtraNodes
    topic: str | None = None
    drawn: Stamped[Shape] | None = None


@dataclass(frozen=True, slots=True)
class _Left:
    """What a page looked at before it played a drive: camera position and look-at point (3,), m,
    and whether straight down."""

    position: np.ndarray
    look_at: np.ndarray
    top: bool


class PageScene:
    """Nodes and camera of one connected page.

    To follow the robot, the world is moved under the camera and the camera stays where it is: a
    page's own orbit and zoom are then never overwritten by a stale position from here.

    A drive of a drill is played in a world of its own; the robot's is hidden as a whole then, and
    drawn again when the page leaves the drive.
    """

    def __init__(
        self,
        client: viser.ClientHandle,
        view: View,
        drawings: Drawings,
        memory: Memory | None = None,
    ) -> None:
        self.client = client
        self._view = view
        self._scene = client.scene
        self._shift = np.zeros(2)
        self._following: np.ndarray | None = None
        self._robot: np.ndarray | None = None
        self._bounds: cameras.Bounds | None = None
        self._drawn: dict[LayerKey, int] = {}
        self._preview: Preview | None = None
        self._playback: Playback | None = None
        self._left: _Left | None = None
        self._footprint: np.ndarray | None = None
        self._extras: list[_Extra] = []
        resumed = memory is not None and np.allclose(
            client.camera.position, memory.position, atol=_SAME_CAMERA
        )
        if memory is not None and resumed:
            self._shift = memory.shift.copy()
        self._world = self._scene.add_frame(_WORLD, show_axes=False, position=self._world_position)
        self._light()
        self._build()
        self._show()
        if resumed:
            self._bounds = cameras.NOTHING_KNOWN
        else:
            client.camera.fov = cameras.FIELD_OF_VIEW
            self._frame()
        self.draw(drawings)

    @property
    def extras(self) -> list[str]:
        """Further topics that are shown."""
        return self._view.extras

    @property
    def camera(self) -> Camera:
        """The camera as the page last reported it."""
        state = self.client.camera
        px, py, pz = (float(c) for c in state.position)
        w, x, y, z = (float(c) for c in state.wxyz)
        return Camera((px, py, pz), (w, x, y, z), float(state.fov), float(state.aspect))

    def to_map(self, point: tuple[float, float]) -> tuple[float, float]:
        """Floor point of the displayed world -> map frame, m."""
        return point[0] - float(self._shift[0]), point[1] - float(self._shift[1])

    @property
    def memory(self) -> Memory:
        """What to give to the scene of the page's next connection."""
        seen = np.array(self.client.camera.position) if self._left is None else self._left.position
        return Memory(seen, self._shift.copy())

    @property
    def plays(self) -> bool:
        """Whether a drive is shown, and not the robot."""
        return self._playback is not None

    def play(self, drive: DriveDrawing, moment: float, speed: float) -> None:
        """Show a drive in the place of the robot, from a second of it on at a speed."""
        playback = self._playback
        if playback is None or playback.drive.id != drive.id:
            if playback is None:
                state = self.client.camera
                self._left = _Left(
                    np.array(state.position), np.array(state.look_at), self._view.top
                )
                self._world.visible = False
            else:
                playback.remove()
            playback = Playback(self._scene, drive, self._footprint, self._view.theme)
            if self._playback is None or self._playback.drive.place is not drive.place:
                self._look_at_whole(drive.place.bounds)
            self._playback = playback
        playback.go_on(moment, speed)

    def leave(self) -> None:
        """Show the robot again, as it was looked at before."""
        playback, left = self._playback, self._left
        if playback is None or left is None:
            return
        self._playback = self._left = None
        playback.remove()
        self._world.visible = True
        self._look(left.position, left.look_at)
        if left.top != self._view.top:
            self._tilt()

    def apply(self, view: View, drawings: Drawings) -> None:
        """Bring the page to other settings."""
        old, self._view = self._view, view
        if old.theme != view.theme:
            self._build()
        self._show()
        if not view.follow:
            self._following = None
        elif not old.follow and not self.plays:
            self._begin_following()
        if view.top != old.top:
            self._tilt()
        self.draw(drawings)

    def draw(self, drawings: Drawings) -> None:
        """Draw what has changed since the last time, or the moment of the drive that is played."""
        if self._playback is not None:
            if not self._playback.forgotten:
                with self.client.atomic():
                    self._playback.draw()
                return
            self.leave()
        counts = drawings.counts
        with self.client.atomic():
            described = self._changed("description", counts)
            if self._changed("footprint", counts) or described:
                self._footprint = drawings.footprint
                self._robot_nodes.draw_body(drawings.footprint, drawings.description)
            if self._changed("robot", counts) and drawings.robot is not None:
                self._robot_nodes.place(drawings.robot)
                self._robot = np.array([drawings.robot.x, drawings.robot.y])
                self._follow()
            if self._changed("scan", counts) and drawings.scan is not None:
                self._scan.draw(drawings.scan)
            if self._changed("path", counts) and drawings.path is not None:
                self._path.draw(drawings.path)
            if self._changed("local_map", counts) and drawings.local_map is not None:
                self._local_map.draw(drawings.local_map)
            if self._changed("goal", counts):
                self._goal.draw(drawings.goal)
            if self._changed("hindrance", counts):
                mark = drawings.hindrance
                self._hindrance.draw(None if mark is None else (mark.x, mark.y))
            if self._changed("trail", counts) and drawings.trail is not None:
                self._trail.draw(drawings.trail)
            if self._changed("places", counts):
                self._places.draw(drawings.places)
            if self._changed("zones", counts):
                self._zones.draw(drawings.zones)
            self._draw_extras(drawings)
        if self._changed("map", counts) and drawings.map is not None:
            self._map.draw(drawings.map)
            first = self._bounds is None
            self._bounds = drawings.map.bounds
            if first and self._following is None:
                self._frame()

    def preview(self, preview: Preview | None) -> None:
        """Show a goal that is being considered, or take it away."""
        self._preview = preview
        self._preview_nodes.draw(preview)

    def _build(self) -> None:
        """(Re)make all nodes in the theme's colours; names stay, so viser replaces them."""
        theme = self._view.theme
        self.client.gui.configure_theme(
            dark_mode=theme == "dark", show_logo=False, show_share_button=False
        )
        colours = palette(theme)
        self._drawn.clear()
        self._map = MapNodes(self._scene, _WORLD, theme)
        self._local_map = LocalMapNodes(self._scene, _WORLD, theme)
        self._trail = TrailNodes(self._scene, _WORLD, theme)
        self._path = PathNodes(self._scene, f"{_WORLD}/path", colours.path)
        self._scan = ScanNodes(self._scene, f"{_WORLD}/scan", colours.scan)
        robot = RobotColours(colours.body, colours.front, colours.footprint)
        self._robot_nodes = RobotNodes(self._scene, f"{_WORLD}/robot", robot)
        self._places = PlaceNodes(self._scene, _WORLD, colours.place)
        self._zones = ZoneNodes(self._scene, _WORLD, colours)
        for extra in self._extras:
            extra.drawn = None
        self._goal = GoalNodes(self._scene, f"{_WORLD}/goal", colours.goal)
        self._hindrance = CrossNodes(self._scene, f"{_WORLD}/hindrance", colours.alert)
        self._preview_nodes = PreviewNodes(self._scene, _WORLD, theme)
        self._preview_nodes.draw(self._preview)
        if self._playback is not None:
            self._playback.build(theme)

    def _draw_extras(self, drawings: Drawings) -> None:
        """Each topic keeps its nodes; those of one that is not shown any more are the next one's,
        for viser remembers every name that a node ever had."""
        shown = self._view.extras
        for extra in self._extras:
            if extra.topic is not None and extra.topic not in shown:
                extra.nodes.hide()
                extra.topic = extra.drawn = None
        colours = palette(self._view.theme)
        for topic in shown:
            drawing = drawings.extras.get(topic)
            extra = self._extra_of(topic)
            if drawing is extra.drawn:
                continue
            extra.drawn = drawing
            if drawing is None:
                extra.nodes.hide()
            else:
                extra.nodes.draw(drawing.value, extra_colour(topic, colours))

    def _extra_of(self, topic: str) -> _Extra:
        for extra in self._extras:
            if extra.topic == topic:
                return extra
        free = next((extra for extra in self._extras if extra.topic is None), None)
        if free is None:
            name = f"{_WORLD}/extra{len(self._extras)}"
            free = _Extra(ExtraNodes(self._scene, name))
            self._extras.append(free)
        free.topic = topic
        return free

    def _light(self) -> None:
        """Even light from above, and a little more from the north-west to tell sides apart."""
        self._scene.configure_default_lights(enabled=False)
        self._scene.configure_environment_map(None)
        self._scene.add_light_ambient("/light/all", intensity=2.2)
        self._scene.add_light_directional(
            "/light/side", intensity=1.3, position=(-6.0, -9.0, 14.0), cast_shadow=False
        )

    def _changed(self, layer: LayerKey, counts: dict[LayerKey, int]) -> bool:
        # A hidden layer is not sent; it is brought up to date when it is shown again.
        belongs_to = {"hindrance": "goal"}.get(layer, layer)
        always = layer in ("footprint", "description", "robot")
        shown = always or getattr(self._view.layers, belongs_to)
        if not shown or self._drawn.get(layer, 0) == counts[layer]:
            return False
        self._drawn[layer] = counts[layer]
        return True

    def _show(self) -> None:
        layers = self._view.layers
        self._map.show(layers.map)
        self._local_map.show(layers.local_map)
        self._path.show(layers.path)
        self._scan.show(layers.scan)
        self._robot_nodes.show(layers.robot)
        self._goal.show(layers.goal)
        self._hindrance.show(layers.goal)
        self._trail.show(layers.trail)
        self._places.show(layers.places)
        self._zones.show(layers.zones)

    @property
    def _world_position(self) -> tuple[float, float, float]:
        return float(self._shift[0]), float(self._shift[1]), 0.0

    def _frame(self) -> None:
        """Look at the whole map."""
        self._look_at_whole(self._bounds or cameras.NOTHING_KNOWN, self._shift)

    def _look_at_whole(
        self, bounds: cameras.Bounds, shift: np.ndarray | tuple[float, float] = (0.0, 0.0)
    ) -> None:
        position, look_at = cameras.framing(bounds, self.camera.aspect, top=self._view.top)
        moved = np.array([*shift, 0.0])
        self._look(position + moved, look_at + moved)

    def _tilt(self) -> None:
        """Between straight down and at an angle, keeping the point looked at and the distance."""
        state = self.client.camera
        look_at = np.array(state.look_at)
        distance = float(np.linalg.norm(np.array(state.position) - look_at))
        self._look(look_at + cameras.offset_direction(top=self._view.top) * distance, look_at)

    def _begin_following(self) -> None:
        if self._robot is None:
            return
        self._following = self._robot.copy()
        state = self.client.camera
        offset = np.array(state.position) - np.array(state.look_at)
        distance = float(np.linalg.norm(offset))
        offset *= min(distance, cameras.FOLLOW_DISTANCE) / distance
        centre = np.array([*(self._robot + self._shift), 0.0])
        self._look(centre + offset, centre)

    def _follow(self) -> None:
        if not self._view.follow or self._robot is None:
            return
        if self._following is None:
            self._begin_following()
            return
        self._shift -= self._robot - self._following
        self._following = self._robot.copy()
        self._world.position = self._world_position

    def _look(self, position: np.ndarray, look_at: np.ndarray) -> None:
        # Position first: setting it moves the look-at point along.
        self.client.camera.position = position
        self.client.camera.look_at = look_at
