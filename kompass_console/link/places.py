"""The robot's places, as its monitor tells them, and which of them are on the map of now."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable

from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.monitor.client import MonitorClient
from kompass.places.map_identity import identify
from kompass.places.place import MapIdentity, Place, PlaceBook
from kompass_console.schema.models import PlacesInfo
from kompass_console.schema.plain import plain
from kompass_console.schema.world import PlaceMark, WorldModel

_logger = logging.getLogger(__name__)


class PlacesWatch:
    """The newest book of places.

    Parameters
    ----------
    changed
        Called when pages have something new to show; on the link's thread.
    """

    def __init__(self, world: WorldModel, changed: Callable[[], None]) -> None:
        self._world, self._changed = world, changed
        self._lock = threading.Lock()
        self._book: PlaceBook | None = None
        self._identified = 0  # the version of the map that `_here` is of
        self._here: MapIdentity | None = None
        self._drawn: MapIdentity | None = None  # the map whose places are drawn

    def follow(self, monitor: MonitorClient) -> None:
        """Listen to the monitor that is there now; what another said last stays until then."""
        monitor.watch_places(self._store)

    def refresh(self) -> None:
        """Look which map the robot has. On the link's thread."""
        if self.here() != self._drawn:
            self._draw()
            self._changed()

    @property
    def book(self) -> PlaceBook | None:
        """All places; None until the monitor has told them."""
        return self._book

    def here(self) -> MapIdentity | None:
        """The map that the robot has now; None while it has none. Any thread."""
        with self._lock:
            stamped = self._world.map.get()
            if stamped is None:
                self._identified, self._here = 0, None
            elif stamped.version != self._identified:
                self._here = identify(stamped.value)
                self._identified = stamped.version
            return self._here

    def find(self, place_id: int) -> Place | None:
        """A place; None when there is none of this number."""
        book = self._book
        if book is None:
            return None
        return next((place for place in book.places if place.id == place_id), None)

    def info(self) -> PlacesInfo:
        """By what pages see that they have to ask for the places again."""
        book, here = self._book, self._here
        return PlacesInfo(
            revision=0 if book is None else book.revision,
            available=book is not None and book.available,
            map=None if here is None else here.id,
        )

    def _store(self, text: str) -> None:
        try:
            book = PlaceBook.model_validate_json(text)
        except ValidationError as error:
            # Of another release, or of a stranger: what was known before is better than nothing.
            _logger.warning("places that cannot be read: %s", plain(first_invalid(error).text))
            return
        self._book = book.model_copy(update={"problem": plain(book.problem)})
        self._draw()
        self._changed()

    def _draw(self) -> None:
        book, here = self._book, self.here()
        self._drawn = here
        self._world.places.set(
            tuple(
                PlaceMark(place.name, place.pose.x, place.pose.y, place.pose.yaw)
                for place in (() if book is None else book.places)
                if here is not None and place.map.id == here.id
            )
        )
