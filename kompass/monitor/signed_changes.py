"""A service by which people change something that the monitor keeps: as JSON, and signed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

from pydantic import TypeAdapter, ValidationError

from kompass.access.gatekeeper import Gatekeeper, NotAdmitted
from kompass.bus.node import Node
from kompass.invalid import first_invalid
from kompass.monitor.tables.types import Who
from kompass.monitor.worker_thread import WorkerThread
from kompass.rclpy_ext.deferred_service import answered_by_worker, create_deferred_service
from kompass.rclpy_ext.main_thread import MainThread
from kompass.store.errors import ChangeRefused

C = TypeVar("C")


class SignedChanges(Generic[C]):
    """Offers the service, and hands on what may be and can be read.

    Parameters
    ----------
    node, main
        Offers the service, and its executor's thread.
    gatekeeper
        Lets requests in.
    worker
        Carries the changes out, one after another.
    kind, name
        Of the service.
    changes
        Reads a change.
    largest
        Characters that a change may have.
    what
        Is changed, for people: ``places``.
    problem
        Why nothing can be changed; empty where it can.
    carry_out
        Does it, on the worker, and returns the answer (JSON). :class:`ChangeRefused` where whoever
        asked can mend it; what else is raised is logged, too.
    """

    def __init__(
        self,
        node: Node,
        main: MainThread,
        gatekeeper: Gatekeeper,
        worker: WorkerThread,
        kind: Any,
        name: str,
        changes: TypeAdapter[C],
        *,
        largest: int,
        what: str,
        problem: str,
        carry_out: Callable[[C, Who], str],
    ) -> None:
        self._gatekeeper, self._changes, self._carry_out = gatekeeper, changes, carry_out
        self._service = f"{node.get_name()}/{name}"
        self._largest, self._what, self._problem = largest, what, problem
        answer = answered_by_worker(main, worker, self._answer)
        create_deferred_service(node, kind, self._service, answer, _failed)

    def _answer(self, request: Any, response: Any) -> Any:
        author, role = str(request.author), str(request.role)
        try:
            verified = self._gatekeeper.admit(self._service, request, changes=True, who=author)
            who = Who(author, role, verified)
            self._check(who, request)
            response.answer = self._carry_out(self._read(str(request.change)), who)
        except (NotAdmitted, ChangeRefused) as error:
            response.success, response.message = False, str(error)
        else:
            response.success = True
        return response

    def _check(self, who: Who, request: Any) -> None:
        if who.barred:
            raise ChangeRefused(
                f"role {who.role[:50]!r} may look at {self._what} and change none; ask an operator"
            )
        if self._problem:
            raise ChangeRefused(self._problem)
        if refusal := who.too_long():
            raise ChangeRefused(refusal)
        if len(request.change) > self._largest:
            raise ChangeRefused(
                f"change has {len(request.change)} characters; use at most {self._largest}"
            )

    def _read(self, text: str) -> C:
        try:
            return self._changes.validate_json(text)
        except ValidationError as error:
            wrong = first_invalid(error)
            field = wrong.where.partition(".")[2] or "change"  # after the kind of change
            raise ChangeRefused(f"{field} = {wrong.value!r:.100}: {wrong.text}") from None


def _failed(response: Any, error: Exception) -> Any:
    response.success, response.message = False, str(error) or type(error).__name__
    return response
