"""A new history after a damaged one."""

from __future__ import annotations

from kompass.rulebook.schema.revision import Origin
from kompass.rules.schema.table import Table, table_hash
from kompass.store.backup import Backup
from kompass.store.revisions import RevisionEntry, Revisions
from kompass.store.session import MONITOR


def rebuild(revisions: Revisions, backup: Backup | None, journal: int) -> str:
    """Begin an empty list of revisions with what was last confirmed; what to say of it.

    Parameters
    ----------
    journal
        The greatest revision that the journal tells of: its entries must not come to mean
        another table.
    """
    revisions.begin_after(max(backup.revision if backup else 0, journal))
    if backup is None:
        return "the history of the rules is lost, and the recipe's table is in force"
    steps: list[tuple[Table, str, str, Origin]] = [(backup.recipe, MONITOR, MONITOR, "recipe")]
    if backup.table != backup.recipe:
        steps.append((backup.table, backup.author, backup.role, "edit"))
    reason = f"restored after damage, from revision {backup.revision}"
    recipe, parent = table_hash(backup.recipe), None
    for table, author, role, origin in steps:
        entry = RevisionEntry(parent, author, role, backup.time, reason, origin, recipe, None)
        parent = revisions.append(table, entry)
        revisions.settle(parent, "confirmed", backup.time, author, role)
    return (
        f"the history of the rules is lost but for the last confirmed revision {backup.revision}, "
        f"which is now revision {parent}"
    )
