"""The robot's places, kept by the monitor: told to everybody, changed by people."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from kompass_interfaces.srv import ChangePlaces
from pydantic import ValidationError
from std_msgs.msg import String

from kompass.access.gatekeeper import Gatekeeper, NotAdmitted
from kompass.bus.node import Node
from kompass.invalid import first_invalid
from kompass.monitor.tables.types import Who
from kompass.monitor.worker_thread import WorkerThread
from kompass.places.change import PLACE_CHANGE
from kompass.places.place import LONGEST_AUTHOR, PlaceBook
from kompass.rclpy_ext.deferred_service import answered_by_worker, create_deferred_service
from kompass.rclpy_ext.main_thread import MainThread
from kompass.rclpy_ext.topic import LATCHED
from kompass.store.errors import EntryRefused, NoSuchEntry, StaleEntry, StoreError
from kompass.store.place_store import PlaceStore

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
    """

    def __init__(
        self,
        node: Node,
        main: MainThread,
        gatekeeper: Gatekeeper,
        open_store: Callable[[], PlaceStore],
    ) -> None:
        self._main, self._gatekeeper = main, gatekeeper
        self._service = f"{node.get_name()}/{SERVICE}"
        self._worker = WorkerThread(node, "places")
        self._publisher = node.create_publisher(
            String, f"{node.get_name()}/{TOPIC}", LATCHED.to_ros()
        )
        self._store: PlaceStore | None = None
        self._problem = ""
        try:
            store = open_store()
            book = store.book()
            self._store = store
        except (StoreError, OSError) as error:
            self._problem = f"places cannot be kept: {error}"
            node.get_logger().error(self._problem)
            book = PlaceBook(problem=self._problem, available=False)
        self._tell(book)
        answer = answered_by_worker(main, self._worker, self._answer)
        create_deferred_service(node, ChangePlaces, self._service, answer, _failed)

    def close(self) -> None:
        """Change nothing any more; what is under way ends first."""
        self._worker.close()
        if self._store is not None:
            self._store.close()

    def _answer(self, request: Any, response: Any) -> Any:
        author, role = str(request.author), str(request.role)
        try:
            verified = self._gatekeeper.admit(self._service, request, changes=True, who=author)
        except NotAdmitted as error:
            response.success, response.message = False, str(error)
            return response
        who = Who(author, role, verified)
        refusal = who.too_long() or self._barred(who, request)
        if refusal:
            response.success, response.message = False, refusal
            return response
        try:
            change = PLACE_CHANGE.validate_json(request.change)
        except ValidationError as error:
            wrong = first_invalid(error)
            response.success = False
            field = wrong.where.partition(".")[2] or "change"  # after the kind of change
            response.message = f"{field} = {wrong.value!r:.100}: {wrong.text}"
            return response
        assert self._store is not None  # or it was barred
        try:
            place = self._store.change(change, who.name[:LONGEST_AUTHOR])
            book = self._store.book()
        except (NoSuchEntry, StaleEntry, EntryRefused) as error:
            # Theirs to mend; what else goes wrong is logged, too.
            response.success, response.message = False, str(error)
            return response
        self._main.post(lambda: self._tell(book))
        response.success, response.answer = True, place.model_dump_json()
        return response

    def _barred(self, who: Who, request: Any) -> str:
        """Why nothing is changed; empty when it is."""
        if who.barred:
            return f"role {who.role[:50]!r} may look at places and change none; ask an operator"
        if self._store is None:
            return self._problem
        if len(request.change) > _LARGEST:
            return f"change has {len(request.change)} characters; use at most {_LARGEST}"
        return ""

    def _tell(self, book: PlaceBook) -> None:
        self._publisher.publish(String(data=book.model_dump_json()))


def _failed(response: Any, error: Exception) -> Any:
    response.success, response.message = False, str(error) or type(error).__name__
    return response
