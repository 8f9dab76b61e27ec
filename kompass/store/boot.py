"""Which table is in force after a start: a pure decision on what is stored."""

from __future__ import annotations

import time as clock
from typing import NamedTuple

from kompass.rulebook.merge import merge
from kompass.rulebook.schema.revision import Origin
from kompass.rulebook.schema.table_view import Merge
from kompass.rules.schema.table import Table, table_hash
from kompass.store.session import MonitorSession

SOON = 60.0  # s after an apply in which a crash is put down to it
SOON_CRASHES = 2
AT_ONCE = 10.0  # s after its start in which a monitor that ends has not really lived
AT_ONCE_CRASHES = 3


class KeptRevision(NamedTuple):
    """A stored revision, with its table."""

    number: int
    table: Table
    author: str
    time: float
    origin: Origin


class OlderEdits(NamedTuple):
    """Edits that people made while the recipe was another one."""

    revision: int
    recipe: Table
    edited: Table


class StoreFacts(NamedTuple):
    """What is stored, as far as a start needs it.

    Attributes
    ----------
    active
        The last revision put in force while the recipe was as it is today; None for none.
    confirmed
        The confirmed revisions of this recipe that nobody took back, newest first.
    unconfirmed
        Numbers of those that were neither confirmed nor taken back nor superseded.
    edited
        Whether people have changed the table since the recipe is as it is today.
    older
        Edits of the recipe before; None for none.
    sessions
        Of the monitor, newest first.
    unreadable
        Sentences on revisions that would have been wanted and could not be read.
    machine
        The run of the machine.
    """

    active: KeptRevision | None = None
    confirmed: tuple[KeptRevision, ...] = ()
    unconfirmed: tuple[int, ...] = ()
    edited: bool = False
    older: OlderEdits | None = None
    sessions: tuple[MonitorSession, ...] = ()
    unreadable: tuple[str, ...] = ()
    machine: str = ""


class Boot(NamedTuple):
    """What a start does.

    Attributes
    ----------
    table
        In force.
    revision
        Its number; None when it is to be appended as a new revision with ``origin``, ``reason``
        and ``restores``, confirmed from the start.
    taken_back
        Revisions that have failed.
    notice
        What an operator must hear; empty for nothing.
    merge
        Edits of an older recipe, offered.
    """

    table: Table
    revision: int | None
    origin: Origin = "recipe"
    reason: str = ""
    restores: int | None = None
    taken_back: tuple[int, ...] = ()
    notice: str = ""
    merge: Merge | None = None
    safe_mode: bool = False


def choose(facts: StoreFacts, recipe_table: Table, safe_mode: bool, now: float) -> Boot:
    """Choose the table for a start.

    The last confirmed revision for this recipe; the recipe's own table when it is new, with the
    edits of the recipe before offered. A revision on probation does not survive a restart, and one
    that brings the monitor down is taken back.

    Parameters
    ----------
    now
        Seconds since the epoch.
    """
    notices = list(facts.unreadable)
    if safe_mode:
        return _recipe_in_safe_mode(facts, recipe_table, notices)
    if not facts.confirmed:
        boot = Boot(
            recipe_table, None, "recipe", "the recipe's table", taken_back=facts.unconfirmed
        )
    elif facts.unconfirmed:
        boot = _before_probation(facts, now)
    else:
        boot = _confirmed(facts, recipe_table, now)
    offered = None
    if facts.older is not None and not facts.edited:
        offered, text = _offer(facts.older, recipe_table)
        notices.append(text)
    if boot.notice:
        notices.insert(0, boot.notice)
    return boot._replace(notice="\n".join(notices), merge=offered)


def _recipe_in_safe_mode(facts: StoreFacts, recipe_table: Table, notices: list[str]) -> Boot:
    stored = next((kept for kept in facts.confirmed if kept.table == recipe_table), None)
    edits = facts.confirmed[0] if facts.confirmed and facts.edited else None
    notices.insert(0, "safe mode: the table of the recipe is in force")
    if edits is not None:
        notices.append(
            f"revision {edits.number} ({_whose(edits)}) is kept, and in force again after a start "
            "without --safe-mode"
        )
    return Boot(
        recipe_table,
        stored.number if stored else None,
        "recipe",
        "the recipe's table",
        notice="\n".join(notices),
        safe_mode=True,
    )


def _before_probation(facts: StoreFacts, now: float) -> Boot:
    """Back to the confirmed revision: probation ends with the monitor's session."""
    back, active = facts.confirmed[0], facts.active
    if active is None or active.number not in facts.unconfirmed:
        return Boot(back.table, back.number, taken_back=facts.unconfirmed)
    reason = (
        f"revision {active.number} ({_whose(active)}, {_ago(now - active.time)}) was not confirmed "
        "before the monitor ended"
    )
    return Boot(
        back.table,
        None,
        "taken back",
        reason,
        back.number,
        facts.unconfirmed,
        f"{reason}: revision {back.number} is in force again",
    )


def _confirmed(facts: StoreFacts, recipe_table: Table, now: float) -> Boot:
    newest = facts.confirmed[0]
    crashes = _crashes(newest, facts.sessions, facts.machine, now)
    if crashes:
        return _after_crashes(facts, recipe_table, crashes)
    if (
        not facts.edited
        and newest.table != recipe_table
        and table_hash(newest.table) == table_hash(recipe_table)
    ):
        # Only names or notes of the recipe have changed.
        return Boot(recipe_table, None, "recipe", "names and notes of the recipe")
    return Boot(newest.table, newest.number)


def _after_crashes(facts: StoreFacts, recipe_table: Table, crashes: str) -> Boot:
    newest = facts.confirmed[0]
    said = f"revision {newest.number} ({_whose(newest)}) brought the monitor down {crashes}"
    failed = table_hash(newest.table)
    for kept in facts.confirmed[1:]:
        if table_hash(kept.table) != failed:
            notice = f"{said}: it has been taken back, and revision {kept.number} is in force again"
            return Boot(kept.table, None, "taken back", said, kept.number, (newest.number,), notice)
    if table_hash(recipe_table) != failed:
        notice = f"{said}: it has been taken back, and the table of the recipe is in force"
        return Boot(recipe_table, None, "taken back", said, None, (newest.number,), notice)
    notice = f"{said}; there is no other table to go back to: read the log, and mend the recipe"
    return Boot(newest.table, newest.number, notice=notice)


def _crashes(
    kept: KeptRevision, sessions: tuple[MonitorSession, ...], machine: str, now: float
) -> str:
    """Say how often a revision brought the monitor down; empty if it did not, or too rarely.

    When an unclean session ended is not known; at the latest when the next one began. A machine
    that lost its power has ended it from outside.
    """
    soon = at_once = 0
    in_a_row, after, ended_by = True, machine, now
    for session in sessions:
        crashed = (
            session.ended is None and session.revision == kept.number and session.machine == after
        )
        if crashed and ended_by - kept.time <= SOON:
            soon += 1
        in_a_row = in_a_row and crashed and ended_by - session.started <= AT_ONCE
        at_once += in_a_row
        after, ended_by = session.machine, session.started
    if soon >= SOON_CRASHES:
        return f"{soon} times within {SOON:.0f} s of being applied"
    if at_once >= AT_ONCE_CRASHES:
        return f"{at_once} times in a row within {AT_ONCE:.0f} s"
    return ""


def _offer(older: OlderEdits, recipe_table: Table) -> tuple[Merge, str]:
    table, conflicts = merge(older.recipe, older.edited, recipe_table)
    text = (
        f"the recipe has changed: its own table is in force, and the edits of revision "
        f"{older.revision} wait to be merged"
    )
    return Merge(revision=older.revision, table=table, conflicts=tuple(conflicts)), text


def _whose(kept: KeptRevision) -> str:
    return f"{kept.author}, {clock.strftime('%Y-%m-%d %H:%M', clock.gmtime(kept.time))} UTC"


def _ago(seconds: float) -> str:
    for unit, length in (("day", 86400.0), ("hour", 3600.0), ("minute", 60.0)):
        if seconds >= length:
            count = int(seconds // length)
            return f"{count} {unit}{'s' if count > 1 else ''} ago"
    return "just now"
