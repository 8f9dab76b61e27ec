"""What the commands that change nothing ask of a robot, and the two ways to ask it."""

from __future__ import annotations

import importlib
import os
import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from kompass.monitor.local_socket import LocalMonitor, Question, local_monitors
from kompass.store.robot_key import GIVEN
from kompass_console.cli_error import CliError
from kompass_console.domain import on_this_machine_only, where
from kompass_console.rules_cli.robot_refused import REFUSED, RobotRefused

if TYPE_CHECKING:
    from kompass.rulebook.schema.diff_models import TableDiff
    from kompass.rulebook.schema.explanation import ExplanationView
    from kompass.rulebook.schema.journal import Journal
    from kompass.rulebook.schema.revision import History
    from kompass.rulebook.schema.status import RuleStatus
    from kompass.rulebook.schema.table_view import TableView
    from kompass_console.rules_cli.connection import MonitorConnection

_Page = TypeVar("_Page", "History", "Journal")
AGAIN = 0.1  # s until one is asked once more that does not listen
_SCHEMA = "kompass.rulebook.schema"


class Looking(Protocol):
    """Answers of the monitor of one robot.

    Each raises `CliError` when there is no answer in time, and `RobotRefused`, which is one, when
    the robot says why there is none.
    """

    def table(self, revision: int = 0) -> TableView:
        """A revision of the table; 0 for the one in force."""

    def statuses(self, revision: int) -> dict[str, RuleStatus]:
        """How the rules of the table in force are doing, by id; empty if not told in time."""

    def history(self, before: int, count: int) -> History:
        """Revisions below ``before`` (0: from the newest), newest first."""

    def diff(self, before: int, after: int) -> TableDiff:
        """What differs between two revisions; ``after`` 0 for the one in force."""

    def explain(self, rule_id: str, run_id: int, epoch: str) -> ExplanationView:
        """Why a rule fires or does not: now (0), or at a firing of an epoch."""

    def firings(self, before: int, count: int, rule_id: str) -> Journal:
        """Entries of the journal below ``before`` (0: from the newest), newest first."""


def in_parts(ask: Callable[[int, int], _Page], items: str, before: int, count: int) -> _Page:
    """Ask on where an answer ends before it has as many items as are wanted: it has its size."""
    whole = ask(before, count)
    while whole.more and 0 < len(found := getattr(whole, items)) < count:
        page = ask(found[-1].number, count - len(found))
        more = page.more and bool(getattr(page, items))
        whole = whole.model_copy(update={items: found + getattr(page, items), "more": more})
    return whole


class LookingOverRos:
    """Asks over ROS; finding the robot there takes a second or more."""

    def __init__(self, connection: MonitorConnection) -> None:
        self._connection, self._monitor = connection, connection.monitor

    def table(self, revision: int = 0) -> TableView:
        return self._connection.get(self._monitor.table(revision))

    def statuses(self, revision: int) -> dict[str, RuleStatus]:
        return self._connection.statuses(revision)

    def history(self, before: int, count: int) -> History:
        return in_parts(
            lambda before, count: self._connection.get(self._monitor.history(before, count)),
            *("revisions", before, count),
        )

    def diff(self, before: int, after: int) -> TableDiff:
        after = after or self.table().active
        return self._connection.get(self._monitor.diff(before, after))

    def explain(self, rule_id: str, run_id: int, epoch: str) -> ExplanationView:
        return self._connection.get(self._monitor.explain(rule_id, run_id, epoch))

    def firings(self, before: int, count: int, rule_id: str) -> Journal:
        return in_parts(
            lambda before, count: self._connection.get(
                self._monitor.firings(before, count, rule_id)
            ),
            *("firings", before, count),
        )


class LookingHere:
    """Asks a monitor on this machine, over its socket: it is found at once.

    Parameters
    ----------
    monitor
        Who is asked.
    timeout
        Seconds that it may take for an answer.
    """

    def __init__(self, monitor: LocalMonitor, timeout: float) -> None:
        self._monitor, self._timeout = monitor, timeout

    def table(self, revision: int = 0) -> TableView:
        view: TableView = self._ask("table_view.TableView", "get_rules", {"revision": revision})
        return view

    def statuses(self, revision: int) -> dict[str, RuleStatus]:
        told: tuple[RuleStatus, ...] = self._ask("status.RuleStatus", "rules_state", {}, many=True)
        return {status.rule_id: status for status in told}

    def history(self, before: int, count: int) -> History:
        def ask(before: int, count: int) -> History:
            request = {"before": before, "count": count}
            history: History = self._ask("revision.History", "get_history", request)
            return history

        return in_parts(ask, "revisions", before, count)

    def diff(self, before: int, after: int) -> TableDiff:
        request = {"diff_from": before, "diff_to": after or self.table().active}
        diff: TableDiff = self._ask("diff_models.TableDiff", "get_history", request)
        return diff

    def explain(self, rule_id: str, run_id: int, epoch: str) -> ExplanationView:
        request = {"rule_id": rule_id, "run_id": run_id, "epoch": epoch}
        why: ExplanationView = self._ask("explanation.ExplanationView", "explain_rule", request)
        return why

    def firings(self, before: int, count: int, rule_id: str) -> Journal:
        def ask(before: int, count: int) -> Journal:
            request = {"before": before, "count": count, "rule_id": rule_id}
            journal: Journal = self._ask("journal.Journal", "get_firings", request)
            return journal

        return in_parts(ask, "firings", before, count)

    def _ask(
        self, kind: str, service: str, request: Mapping[str, Any], *, many: bool = False
    ) -> Any:
        """Ask, and load the model of the answer (a name in the schema) meanwhile."""
        module, name = kind.split(".")
        deadline = time.monotonic() + self._timeout
        while True:
            try:
                question = Question(self._monitor, service, request)
                model: Any = getattr(importlib.import_module(f"{_SCHEMA}.{module}"), name)
                answer = question.answer(max(deadline - time.monotonic(), AGAIN))
                break
            except OSError as error:
                # One that is started anew listens again in a moment.
                if time.monotonic() + AGAIN < deadline and not isinstance(error, TimeoutError):
                    time.sleep(AGAIN)
                    continue
                raise CliError(
                    REFUSED,
                    f"{self._monitor.name} did not answer within {self._timeout:g} s; it may have "
                    "ended or be busy: try again, or give it more with --timeout",
                ) from None
        if not answer.success:
            raise RobotRefused(answer.message)
        from pydantic import TypeAdapter

        return TypeAdapter(tuple[model, ...] if many else model).validate_json(answer.answer)


def monitor_here(namespace: str | None) -> LocalMonitor | None:
    """The monitor to ask over its socket; None where ROS has to say which there are.

    Raises
    ------
    CliError
        When there is more than one to choose from.
    """
    # Somebody who names a key wants to know what can be done with it, and others may be met
    # elsewhere: both are questions for ROS.
    if os.environ.get(GIVEN) or not on_this_machine_only():
        return None
    wanted = None if namespace is None else "/" + namespace.strip("/")
    found = [
        each
        for each in local_monitors(int(os.environ.get("ROS_DOMAIN_ID") or 0))
        if wanted is None or (each.name.rpartition("/")[0] or "/") == wanted
    ]
    if len(found) > 1:
        names = ", ".join(each.name for each in found)
        raise CliError(
            2,
            f"there are {len(found)} monitors on {where()}: {names}; choose one with --namespace",
        )
    return found[0] if found else None
