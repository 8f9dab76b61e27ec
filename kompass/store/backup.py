"""The confirmed table once more, in a small file of its own: for when the database is damaged."""

from __future__ import annotations

import logging
from pathlib import Path

from pydantic import ValidationError

from kompass.rulebook.schema.revision import Revision
from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Table
from kompass.store.content import table_content
from kompass.store.durable import write_whole

FILE = "confirmed.json"
_logger = logging.getLogger("kompass.store")


class Backup(Model):
    """The confirmed table, and the recipe's own of the same time.

    Attributes
    ----------
    content
        Hash of ``table``, so that half a file is no table.
    """

    revision: int
    author: str
    role: str
    time: float
    recipe: Table
    table: Table
    content: str


def backup_of(revision: Revision, table: Table, recipe: Table) -> Backup:
    """Make a copy of a confirmed revision."""
    return Backup(
        revision=revision.number,
        author=revision.author,
        role=revision.role,
        time=revision.time,
        recipe=recipe,
        table=table,
        content=table_content(table),
    )


def write_backup(folder: Path, backup: Backup) -> None:
    """Replace the file; one that cannot be written is logged, for the database has the table."""
    path = folder / FILE
    try:
        write_whole(path, backup.model_dump_json(indent=1).encode())
    except OSError as error:
        _logger.error("cannot write %s: %s", path, error.strerror)


def read_backup(folder: Path) -> Backup | None:
    """The file's content; None when there is none that is whole."""
    try:
        backup = Backup.model_validate_json((folder / FILE).read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValidationError) as error:
        _logger.error("cannot read %s: %s", folder / FILE, error)
        return None
    return backup if table_content(backup.table) == backup.content else None
