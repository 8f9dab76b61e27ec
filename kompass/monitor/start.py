"""Decide with which table the monitor begins."""

from __future__ import annotations

import logging
import os
import uuid
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from kompass.monitor.settings import MonitorSettings
from kompass.rulebook.guard import forbidden
from kompass.rulebook.permissions import Permissions
from kompass.rulebook.schema.table_view import Merge
from kompass.rules.schema.table import Table, rule_hash
from kompass.store.errors import StoreError
from kompass.store.paths import robot_folder
from kompass.store.store import RuleStore

log = logging.getLogger("kompass.monitor")


class Start(NamedTuple):
    """The table to begin with.

    Attributes
    ----------
    table
        In force at first.
    revision
        0 when there is no store.
    epoch
        Name of this session of the monitor.
    notice
        What an operator should know of it; empty for nothing.
    merge
        Edits of an older recipe that wait to be merged; None for none.
    used
        Ids of ``once`` rules that have fired already in this run of the stack.
    """

    table: Table
    revision: int
    epoch: str
    notice: str = ""
    merge: Merge | None = None
    used: tuple[str, ...] = ()


def start_from_store(recipe: Table, settings: MonitorSettings) -> tuple[Start, RuleStore | None]:
    """Open the robot's store and begin a session in it; see :func:`start_in`."""
    epoch = uuid.uuid4().hex[:12]
    try:
        store = RuleStore.open(robot_folder())
    except (StoreError, OSError) as error:
        return _without(recipe, epoch, error), None
    return start_in(store, recipe, settings, epoch=epoch, stack=this_stack())


def start_in(
    store: RuleStore, recipe: Table, settings: MonitorSettings, *, epoch: str, stack: str
) -> tuple[Start, RuleStore | None]:
    """Begin a session in a store.

    Without a store that can be written, the recipe's table is in force and stays so: a table that
    nobody could come back to is worse than one that cannot be edited.

    Parameters
    ----------
    epoch, stack
        Names of this session of the monitor, and of this run of the stack.
    """
    try:
        boot = store.begin_session(recipe, epoch=epoch, stack=stack, safe_mode=settings.safe_mode)
        once = store.used_once()
    except StoreError as error:
        store.close()
        return _without(recipe, epoch, error), None
    used = tuple(rule.id for rule in boot.table.rules if (rule.id, rule_hash(rule)) in once)
    assert boot.revision is not None
    return Start(boot.table, boot.revision, epoch, boot.notice, boot.merge, used), store


def with_permissions(start: Start, permissions: Permissions) -> Start:
    """Tell of rules that may not do any more what they once were allowed to do.

    They stay in the table; what they may not do is refused when they fire.
    """
    refused = [
        f"'{rule.name or rule.id}' ({finding.text})"
        for rule in start.table.rules
        for finding in islice(forbidden(rule, permissions), 1)
    ]
    if not refused:
        return start
    text = f"rules may not do what they say, and will be refused it: {'; '.join(refused)}"
    return start._replace(notice="\n".join(filter(None, (start.notice, text))))


def _without(recipe: Table, epoch: str, error: Exception) -> Start:
    notice = f"{error}. The recipe's rules are in force, and rules cannot be edited"
    log.error("%s", notice)
    return Start(recipe, 0, epoch, notice)


def this_stack() -> str:
    """What tells this run of the stack from all others: our parent process, the supervisor."""
    parent = os.getppid()
    # The 22nd field is the time at which it started; the name in front of it may hold anything.
    fields = Path(f"/proc/{parent}/stat").read_text().rpartition(")")[2].split()
    return f"{parent}-{fields[19]}"
