"""The masks of the recipe, as its drive manager tells them."""

from __future__ import annotations

import logging
from collections.abc import Callable

from pydantic import ValidationError
from rclpy.node import Node
from std_msgs.msg import String

from kompass.invalid import first_invalid
from kompass.rclpy_ext.topic import LATCHED
from kompass.zones.mask import MaskMark, MasksNow
from kompass_console.schema.plain import plain

TOPIC = "masks"
_LARGEST = 20_000_000  # characters

_logger = logging.getLogger(__name__)


class MasksWatch:
    """The newest masks.

    Parameters
    ----------
    changed
        Called when others are told; on the link's thread.

    Attributes
    ----------
    marks
        What is to be drawn.
    changes
        How often others were told.
    """

    def __init__(self, node: Node, changed: Callable[[], None]) -> None:
        self._changed = changed
        self.marks: tuple[MaskMark, ...] = ()
        self.changes = 0
        node.create_subscription(String, TOPIC, self._store, LATCHED.to_ros())

    def _store(self, message: String) -> None:
        try:
            if len(message.data) > _LARGEST:
                raise ValueError(f"{len(message.data)} characters")
            told = MasksNow.model_validate_json(message.data)
        except ValueError as error:
            why = first_invalid(error).text if isinstance(error, ValidationError) else f"{error}"
            _logger.warning("masks that cannot be read: %s", plain(why))
            return
        marks = tuple(mark.model_copy(update={"name": plain(mark.name)}) for mark in told.masks)
        if marks != self.marks:
            self.marks = marks
            self.changes += 1
            self._changed()
