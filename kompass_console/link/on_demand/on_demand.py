"""The thread that reads what pages look at, beside the one on which STOP goes."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable

from rclpy.node import Node

from kompass_console.link.on_demand.cameras import Cameras
from kompass_console.link.on_demand.extras import Extras
from kompass_console.schema.world import WorldModel

_PERIOD = 0.05  # s between two looks while somebody watches
_IDLE_PERIOD = 0.2

_logger = logging.getLogger(__name__)


class OnDemand:
    """Further layers and cameras, on a node and a thread of their own.

    A cloud of a million points, or ten thousand markers, take long to be read; nothing else waits
    for that.

    Parameters
    ----------
    node
        For nothing else, and not on any executor.
    """

    def __init__(self, node: Node, world: WorldModel) -> None:
        self.extras = Extras(node, world)
        self.cameras = Cameras(node)
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._work, name="on demand", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread, and hear nothing any more."""
        self._ending.set()
        self._thread.join(5.0)
        self.extras.close()
        self.cameras.close()

    def _work(self) -> None:
        period = _IDLE_PERIOD
        while not self._ending.wait(period):
            looks = [_look(self.extras.look), _look(self.cameras.look)]
            period = _PERIOD if any(looks) else _IDLE_PERIOD


def _look(look: Callable[[], bool]) -> bool:
    try:
        return look()
    except Exception:
        # One topic that cannot be read must not end all the others.
        _logger.exception("a topic that pages look at could not be read")
        return True
