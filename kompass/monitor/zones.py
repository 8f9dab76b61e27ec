"""The robot's zones, kept by the monitor: told to everybody, changed by people, in force at once.

Which of them count depends on the map that the robot has. The monitor looks at it, so that no
component has to.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Literal

from kompass_interfaces.srv import ChangeZones
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import String

from kompass.access.gatekeeper import Gatekeeper
from kompass.bus.node import Node
from kompass.components.base.convert import grid_of
from kompass.components.drive.zones_file import load_zones, zones_path
from kompass.monitor.introspection.catalog import RecipeCatalog
from kompass.monitor.map_topic import map_topic
from kompass.monitor.signed_changes import SignedChanges
from kompass.monitor.tables.types import Who
from kompass.monitor.worker_thread import WorkerThread
from kompass.places.map_identity import identify
from kompass.places.place import LONGEST_AUTHOR, MapIdentity
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.timers import Timers
from kompass.rclpy_ext.topic import LATCHED
from kompass.store.errors import ChangeRefused, StoreError
from kompass.store.paths import robot_folder
from kompass.store.zone_store import ZoneStore
from kompass.timeline.edit import edited
from kompass.timeline.happening import Happening
from kompass.zones.change import ZONE_CHANGE, EditZone, SaveZone, ZoneChange
from kompass.zones.zone import ZoneBook, ZonesNow

TOPIC = "zones"  # all of them on <node>/zones, those that count on /zones
SERVICE = "change_zones"
LOOK = 1.0  # s between looks for the topic of the map
PATIENCE = 10.0  # s in which a map may come; without one no zone counts then
_LARGEST = 20_000  # characters of a change


class Zones:
    """Tells the zones on ``<node>/zones``, and those of the robot's map on ``/zones``.

    After a start nothing is told on ``/zones`` before the map is known: what the components have
    heard from the monitor before counts until then. Where the zones were lost it counts until
    somebody draws or deletes one.

    Parameters
    ----------
    node, main, timers
        Where it runs.
    gatekeeper
        Lets requests in.
    catalog
        Says which component hears the map.
    gates
        Node names of the drive managers, which keep what is in force, too.
    open_store
        Opens the zones of this robot.
    happened
        Told of what people change; on a worker.
    """

    def __init__(
        self,
        node: Node,
        main: MainThread,
        timers: Timers,
        gatekeeper: Gatekeeper,
        catalog: RecipeCatalog,
        gates: Iterable[str],
        open_store: Callable[[], ZoneStore],
        happened: Callable[[Happening], None],
    ) -> None:
        self._happened = happened
        self._node, self._main, self._catalog = node, main, catalog
        self._worker = WorkerThread(node, "zones")
        self._publisher = node.create_publisher(
            String, f"{node.get_name()}/{TOPIC}", LATCHED.to_ros()
        )
        self._counting = node.create_publisher(String, TOPIC, LATCHED.to_ros())
        self._map: MapIdentity | None = None
        self._listening = ""
        self._subscription: Any = None
        self._told: ZonesNow | None = None
        self._since = node.clock.monotonic()
        self._store: ZoneStore | None = None
        self._book = ZoneBook()
        try:
            store = open_store()
            self._book = store.book()
            self._store, problem = store, store.unwritable
        except (StoreError, OSError) as error:
            problem = str(error)
        if problem:
            problem = f"zones cannot be kept: {problem}"
            node.get_logger().error(problem)
            hold = "; those that were drawn before hold, and cannot be changed"
            told = problem + (hold if self._book.zones else "")
            self._book = self._book.model_copy(update={"problem": told, "available": False})
        if self._book.revision == 0 and (lost := _lost(gates)):
            # Nobody knows any more where the robot must not go, so whoever looks must be told.
            node.get_logger().error(lost)
            told = "; ".join(filter(None, (self._book.problem, lost)))
            self._book = self._book.model_copy(update={"problem": told})
        self._tell(self._book)
        SignedChanges(
            *(node, main, gatekeeper, self._worker, ChangeZones, SERVICE, ZONE_CHANGE),
            largest=_LARGEST,
            what="zones",
            problem=problem,
            carry_out=self._change,
        )
        timers.every(LOOK, self._look_for_map)

    def close(self) -> None:
        """Change nothing any more; what is under way ends first."""
        self._worker.close()
        if self._store is not None:
            self._store.close()

    def _change(self, change: ZoneChange, who: Who) -> str:
        assert self._store is not None  # or it was refused
        if isinstance(change, SaveZone | EditZone) and self._map not in (None, change.plan.map):
            raise ChangeRefused(
                f"the robot has another map now than the one of the zone ({change.plan.map.label})"
            )
        role: Literal["operator", "engineer"] = "engineer" if who.role == "engineer" else "operator"
        zone = self._store.change(change, who.name[:LONGEST_AUTHOR], role)
        book = self._store.book()

        def tell() -> None:
            if self._map is None and isinstance(change, SaveZone):
                self._map = change.plan.map  # of whoever has looked at it
            self._tell(book)

        self._main.call(tell)  # whoever is answered can count on it
        now = self._node.clock.wall()
        self._happened(edited("Zone", change.kind, zone.name, who.name, now))
        return zone.model_dump_json()

    def _tell(self, book: ZoneBook) -> None:
        self._book = book
        self._publisher.publish(String(data=book.model_dump_json()))
        self._tell_counting()

    def _tell_counting(self) -> None:
        """Tell which zones count, where that is known and has changed."""
        here = self._map
        book = self._book
        waited = self._node.clock.monotonic() - self._since >= PATIENCE
        if book.revision == 0:  # none ever, or all that there were are lost
            return
        if here is None and book.zones and not waited:
            return
        zones = tuple(zone for zone in book.zones if here is not None and zone.map.id == here.id)
        if self._told is None or self._told.zones != zones:
            self._told = ZonesNow(revision=book.revision, zones=zones)
            self._counting.publish(String(data=self._told.model_dump_json()))

    # -- the map ------------------------------------------------------------------------------

    def _look_for_map(self) -> None:
        """Listen to the map while there are zones; it is large, and nobody else here needs it."""
        if not self._book.zones:
            return
        topic = map_topic(self._node, self._catalog)
        if topic is not None and topic != self._listening:
            if self._subscription is not None:
                self._node.destroy_subscription(self._subscription)
            self._listening = topic
            self._subscription = self._node.create_subscription(
                OccupancyGrid, f"/{topic}", self._on_map, LATCHED.to_ros()
            )
        self._tell_counting()

    def _on_map(self, message: OccupancyGrid) -> None:
        def look() -> None:
            try:
                here = identify(grid_of(message))
            except ValueError:  # no map at all
                return
            self._main.post(lambda: self._moved_to(here))

        self._worker.post(look)

    def _moved_to(self, here: MapIdentity) -> None:
        self._map = here
        self._tell_counting()


def _lost(gates: Iterable[str]) -> str:
    """What drive managers kept of the zones in force, and cannot be read; empty for nothing."""
    found = []
    for gate in gates:
        try:
            load_zones(zones_path(robot_folder(), gate))
        except (StoreError, ValueError) as error:
            found.append(f"{error}, so no zone that it held is in force; draw them again")
    return "; ".join(found)
