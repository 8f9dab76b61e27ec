"""The robot's places, kept by the monitor: told to everybody, changed by people."""

from __future__ import annotations

from collections.abc import Callable

from kompass_interfaces.srv import ChangePlaces
from std_msgs.msg import String

from kompass.access.gatekeeper import Gatekeeper
from kompass.bus.node import Node
from kompass.monitor.signed_changes import SignedChanges
from kompass.monitor.tables.types import Who
from kompass.monitor.worker_thread import WorkerThread
from kompass.places.change import PLACE_CHANGE, PlaceChange
from kompass.places.place import LONGEST_AUTHOR, Place, PlaceBook
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.topic import LATCHED
from kompass.store.errors import StoreError
from kompass.store.place_store import PlaceStore
from kompass.timeline.edit import edited
from kompass.timeline.happening import Happening

TOPIC = "places"
SERVICE = "change_places"
_LARGEST = 10_000  # characters of a change


class Places:
    """Tells the places on ``<node>/places``, and changes them for whom the gatekeeper lets in.

    A store that cannot be opened costs the places and nothing else: rules are kept without them.

    Parameters
    ----------
    node, main
        Offers the service, and its executor's thread.
    gatekeeper
        Lets requests in.
    open_store
        Opens the places of this robot.
    happened
        Told of what people change; on a worker.
    """

    def __init__(
        self,
        node: Node,
        main: MainThread,
        gatekeeper: Gatekeeper,
        open_store: Callable[[], PlaceStore],
        happened: Callable[[Happening], None],
    ) -> None:
        self._main, self._clock, self._happened = main, node.clock, happened
        self._told: list[Callable[[], None]] = []
        self._worker = WorkerThread(node, "places")
        self._publisher = node.create_publisher(
            String, f"{node.get_name()}/{TOPIC}", LATCHED.to_ros()
        )
        self._store: PlaceStore | None = None
        self._book = PlaceBook()
        try:
            store = open_store()
            self._book = store.book()
            self._store, problem = store, store.unwritable
        except (StoreError, OSError) as error:
            problem = str(error)
        if problem:
            problem = f"places cannot be kept: {problem}"
            node.get_logger().error(problem)
            update = {"problem": problem, "available": False}
            self._book = self._book.model_copy(update=update)
        self._tell(self._book)
        SignedChanges(
            *(node, main, gatekeeper, self._worker, ChangePlaces, SERVICE, PLACE_CHANGE),
            largest=_LARGEST,
            what="places",
            problem=problem,
            carry_out=self._change,
        )

    def close(self) -> None:
        """Change nothing any more; what is under way ends first."""
        self._worker.close()
        if self._store is not None:
            self._store.close()

    def watch(self, told: Callable[[], None]) -> None:
        """Have something called whenever places have changed, on the main thread."""
        self._told.append(told)

    def find(self, place_id: int) -> Place | None:
        """A place as it was told last; None where there is none of this number. Any thread."""
        return next((place for place in self._book.places if place.id == place_id), None)

    def _change(self, change: PlaceChange, who: Who) -> str:
        assert self._store is not None  # or it was refused
        place = self._store.change(change, who.name[:LONGEST_AUTHOR])
        book = self._store.book()
        self._main.post(lambda: self._tell(book))
        self._happened(edited("Place", change.kind, place.name, who.name, self._clock.wall()))
        return place.model_dump_json()

    def _tell(self, book: PlaceBook) -> None:
        self._book = book
        self._publisher.publish(String(data=book.model_dump_json()))
        for told in self._told:
            told()
