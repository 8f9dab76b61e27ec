"""A drive that is played on one page, in the place of the robot's own world."""

from __future__ import annotations

import time

import numpy as np
import numpy.typing as npt
import viser

from kompass_console.scene.drive_drawing import SIDES, DriveDrawing
from kompass_console.scene.layers.ghost import GhostNodes
from kompass_console.scene.layers.goal import GoalNodes
from kompass_console.scene.layers.map import MapNodes
from kompass_console.scene.layers.palette import palette
from kompass_console.schema.models import Theme
from kompass_console.schema.world import GoalMark

ROOT = "/drive"
# A page that plays says so every other second. One that has gone to something else without a word
# must not be shown robots that are not there.
_FORGOTTEN = 10.0  # s


class Playback:
    """Nodes and clock of a played drive. All methods run on viser's loop.

    The page has the play head: it says which second is shown and how fast it goes on. In between
    the clock runs here, so that nothing has to be asked while it plays.
    """

    def __init__(
        self,
        scene: viser.SceneApi,
        drive: DriveDrawing,
        footprint: npt.NDArray[np.float64] | None,
        theme: Theme,
    ) -> None:
        self.drive = drive
        self._scene = scene
        self._footprint = footprint
        self._heard = time.monotonic()
        self._moment, self._speed = 0.0, 0.0
        self.build(theme)

    def build(self, theme: Theme) -> None:
        """(Re)make all nodes in the theme's colours."""
        self._frame = self._scene.add_frame(ROOT, show_axes=False)
        MapNodes(self._scene, ROOT, theme).draw(self.drive.place)
        for number, (x, y) in enumerate(self.drive.goals):
            goal = GoalNodes(self._scene, f"{ROOT}/goal{number}", palette(theme).footprint)
            goal.draw(GoalMark(float(x), float(y), None, active=False))
        self._ghosts = [
            GhostNodes(self._scene, ROOT, side, self.drive.sides[side], self._footprint, theme)
            for side in SIDES
        ]

    def go_on(self, moment: float, speed: float) -> None:
        """Go on from a second of the drive, at so many of them in a second."""
        self._heard = time.monotonic()
        self._moment, self._speed = moment, speed

    @property
    def forgotten(self) -> bool:
        """Whether the page has not spoken of it for long."""
        return time.monotonic() - self._heard > _FORGOTTEN

    def draw(self) -> None:
        """Show the moment that it is now."""
        now = time.monotonic()
        moment = min(self.drive.end, self._moment + (now - self._heard) * self._speed)
        for ghost in self._ghosts:
            ghost.draw(moment, now)

    def remove(self) -> None:
        """Take it all away."""
        self._frame.remove()
