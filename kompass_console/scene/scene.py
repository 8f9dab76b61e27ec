"""All pages' scenes: converts on a thread of its own, draws on viser's loop, newest wins."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections.abc import Callable, Iterator

import viser

from kompass_console.scene.drawings import Converter, Drawings
from kompass_console.scene.drive_drawing import DriveDrawing
from kompass_console.scene.flat_map import FlatMap
from kompass_console.scene.layers.map import MapDrawing, whole_picture
from kompass_console.scene.layers.preview import Preview
from kompass_console.scene.page_scene import Memory, PageScene
from kompass_console.scene.picking import floor_point
from kompass_console.scene.viser_hub import ViserHub
from kompass_console.schema.models import Theme, View
from kompass_console.schema.world import WorldModel

_PERIOD = 0.05  # s between two rounds while somebody watches
_IDLE_PERIOD = 0.2

_logger = logging.getLogger(__name__)


class PageNotConnected(LookupError):
    """The view exists, but its scene has no connection (yet, or any more)."""


class DriveShown(Exception):
    """A page shows a drive of a drill: a place in it is none of the robot's."""


class Scene:
    """Draws the world on every connected page.

    Parameters
    ----------
    find_view
        Maps a view's id to its settings; None for one that is not known.
    """

    def __init__(self, world: WorldModel, find_view: Callable[[str], View | None]) -> None:
        self._find_view = find_view
        self._world = world
        self._drawings = Drawings()
        self._converter = Converter(world, self._drawings)
        self._pages: dict[str, PageScene] = {}
        self._memories: dict[str, Memory] = {}
        self._flat_maps: set[FlatMap] = set()
        self._picture: tuple[MapDrawing, Theme, bytes] | None = None
        self._ending = threading.Event()
        self._drawn = threading.Event()
        self._drawn.set()
        self.hub = ViserHub(self._connected, self._disconnected)
        self._threads = [
            threading.Thread(target=self._work, name="scene", daemon=True),
            # A large map must not hold up what moves.
            threading.Thread(target=self._work_maps, name="scene maps", daemon=True),
        ]
        for thread in self._threads:
            thread.start()

    def stop(self) -> None:
        """End the scene's thread and viser's."""
        self._ending.set()
        self._drawn.set()
        for thread in self._threads:
            thread.join(2.0)
        self.hub.stop()

    def apply(self, view: View) -> None:
        """Bring a page to a view's settings, soon."""

        def change() -> None:
            page = self._pages.get(view.id)
            if page is not None:
                page.apply(view, self._drawings)

        self.hub.post(change)

    def preview(self, view_id: str, preview: Preview | None) -> None:
        """Show or clear the goal a page considers, soon."""

        def change() -> None:
            page = self._pages.get(view_id)
            if page is not None:
                page.preview(preview)

        self.hub.post(change)

    @contextlib.contextmanager
    def flat_map(self, view_id: str) -> Iterator[FlatMap]:
        """The scene for a page that draws it by itself, for as long as the block lasts."""
        flat = FlatMap(self._drawings, lambda: self._find_view(view_id))
        self._flat_maps.add(flat)
        try:
            yield flat
        finally:
            self._flat_maps.discard(flat)

    def map_picture(self, version: int, theme: Theme) -> bytes | None:
        """Picture of the newest map, in one piece; None when that has another version."""
        drawing, last = self._drawings.map, self._picture
        if drawing is None or drawing.version != version:
            return None
        if last is not None and last[0] is drawing and last[1] == theme:
            return last[2]
        picture = whole_picture(drawing, theme)
        self._picture = drawing, theme, picture
        return picture

    async def play(self, view_id: str, drive: DriveDrawing, moment: float, speed: float) -> None:
        """Show a drive on a page in the place of the robot, from a second of it on at a speed.

        A page that is not told so again for ten seconds shows the robot.

        Raises
        ------
        PageNotConnected
            When that page's scene is not connected.
        """

        def change() -> None:
            page = self._pages.get(view_id)
            if page is None:
                raise PageNotConnected(view_id)
            page.play(drive, moment, speed)

        await self.hub.run(change)

    async def leave(self, view_id: str) -> None:
        """Show the robot again; without effect where no drive is shown."""

        def change() -> None:
            page = self._pages.get(view_id)
            if page is not None:
                page.leave()

        await self.hub.run(change)

    async def pick(
        self, view_id: str, points: list[tuple[float, float]]
    ) -> list[tuple[float, float] | None]:
        """Floor points (map frame, m) under points (u, v) of a page's picture; None above the
        horizon.

        Raises
        ------
        PageNotConnected
            When that page's scene is not connected.
        DriveShown
            When that page plays a drive.
        """

        def find() -> list[tuple[float, float] | None]:
            page = self._pages.get(view_id)
            if page is None:
                raise PageNotConnected(view_id)
            if page.plays:
                raise DriveShown(view_id)
            camera = page.camera
            floor = [floor_point(camera, u, v) for u, v in points]
            return [None if point is None else page.to_map(point) for point in floor]

        return await self.hub.run(find)

    def _connected(self, view_id: str, client: viser.ClientHandle) -> None:
        view = self._find_view(view_id)
        if view is None:
            return
        # The end of a connection that broke may be noticed only after the page has another one.
        before = self._pages.get(view_id)
        memory = self._memories.pop(view_id, None) if before is None else before.memory
        self._pages[view_id] = PageScene(client, view, self._drawings, memory)

    def _disconnected(self, view_id: str, client: viser.ClientHandle) -> None:
        page = self._pages.get(view_id)
        if page is None or page.client is not client:
            return  # the page has already connected again
        self._memories[view_id] = page.memory
        for forgotten in [v for v in self._memories if self._find_view(v) is None]:
            del self._memories[forgotten]  # there are as many memories as views, and no more
        del self._pages[view_id]

    @property
    def _watched(self) -> bool:
        return bool(self._pages or self._flat_maps)

    def _extras_shown(self) -> frozenset[str]:
        """Further topics that some page shows, for whoever reads them."""
        lists = [page.extras for page in list(self._pages.values())]
        lists += [flat.extras for flat in list(self._flat_maps)]
        return frozenset(topic for extras in lists for topic in extras)

    def _work(self) -> None:
        while not self._ending.wait(_PERIOD if self._watched else _IDLE_PERIOD):
            self._world.extras_wanted = self._extras_shown()
            if not self._watched:
                self._converter.remember()
                continue
            try:
                self._converter.convert()
            except Exception:
                # One thing that cannot be drawn must not freeze all the others.
                _logger.exception("a layer of the scene could not be converted")
            self._drawn.clear()
            self.hub.post(self._draw)
            # Not a queue of drawings: the next round begins when this one has been handed over.
            self._drawn.wait(1.0)

    def _work_maps(self) -> None:
        while not self._ending.wait(_PERIOD if self._watched else _IDLE_PERIOD):
            if not self._watched:
                continue
            try:
                self._converter.convert_map()
            except Exception:
                # The next map may be one that can be drawn.
                _logger.exception("a map could not be converted")

    def _draw(self) -> None:
        try:
            for view_id, page in self._pages.items():
                self._draw_page(view_id, page)
        finally:
            self._drawn.set()

    def _draw_page(self, view_id: str, page: PageScene) -> None:
        try:
            page.draw(self._drawings)
        except Exception:
            # One page that cannot be drawn must not freeze all the others.
            _logger.exception("the scene of view %s could not be drawn", view_id)
