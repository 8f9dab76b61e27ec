"""The robot's zones, as its monitor tells them, and which of them are on the map of now."""

from __future__ import annotations

import logging
from collections.abc import Callable

from pydantic import ValidationError
from rclpy.node import Node

from kompass.invalid import first_invalid
from kompass.monitor.client import MonitorClient
from kompass.places.place import MapIdentity
from kompass.zones.mask import MaskMark
from kompass.zones.zone import Zone, ZoneBook
from kompass_console.link.masks import MasksWatch
from kompass_console.link.places import PlacesWatch
from kompass_console.schema.models import ZonesInfo
from kompass_console.schema.plain import plain
from kompass_console.schema.world import WorldModel, ZoneMark

_logger = logging.getLogger(__name__)


class ZonesWatch:
    """The newest book of zones.

    Parameters
    ----------
    places
        Knows the map of now.
    changed
        Called when pages have something new to show; on the link's thread.
    """

    def __init__(
        self, node: Node, world: WorldModel, places: PlacesWatch, changed: Callable[[], None]
    ) -> None:
        self._world, self._places, self._changed = world, places, changed
        self._masks = MasksWatch(node, self._masked)
        self._book: ZoneBook | None = None
        self._drawn: MapIdentity | None = None  # the map whose zones are drawn

    def follow(self, monitor: MonitorClient) -> None:
        """Listen to the monitor that is there now; what another said last stays until then."""
        monitor.watch_zones(self._store)

    def refresh(self) -> None:
        """Look which map the robot has. On the link's thread."""
        if self._places.here() != self._drawn:
            self._draw()

    @property
    def book(self) -> ZoneBook | None:
        """All zones; None until the monitor has told them."""
        return self._book

    @property
    def masks(self) -> tuple[MaskMark, ...]:
        """The masks of the recipe."""
        return self._masks.marks

    def find(self, zone_id: int) -> Zone | None:
        """A zone; None when there is none of this number."""
        zones = () if self._book is None else self._book.zones
        return next((zone for zone in zones if zone.id == zone_id), None)

    def info(self) -> ZonesInfo:
        """By what pages see that they have to ask for the zones again."""
        book = self._book
        return ZonesInfo(
            available=book is not None and book.available,
            revision=0 if book is None else book.revision,
            masks=self._masks.changes,
        )

    def _store(self, text: str) -> None:
        try:
            book = ZoneBook.model_validate_json(text)
        except ValidationError as error:
            # Of another release, or of a stranger: what was known before is better than nothing.
            _logger.warning("zones that cannot be read: %s", plain(first_invalid(error).text))
            return
        self._book = book.model_copy(update={"problem": plain(book.problem)})
        self._draw()
        self._changed()

    def _masked(self) -> None:
        self._draw()
        self._changed()

    def _draw(self) -> None:
        book, here = self._book, self._places.here()
        self._drawn = here
        zones = [
            ZoneMark(zone.name, zone.corners, zone.speed)
            for zone in (() if book is None else book.zones)
            if here is not None and zone.map.id == here.id
        ]
        masks = [ZoneMark(mask.name, mask.corners, mask.speed) for mask in self.masks]
        self._world.zones.set((*zones, *masks))
