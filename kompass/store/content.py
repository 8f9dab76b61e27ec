"""Tables as they are stored: each rule once, known by its content."""

import hashlib
import json
import sqlite3

from pydantic import ValidationError

from kompass.invalid import first_invalid
from kompass.rules.schema.identity_cache import IdentityCache
from kompass.rules.schema.interned import read_rule, text_of
from kompass.rules.schema.table import Rule, Table
from kompass.store.errors import MalformedTable, StoreCorrupt


def content_hash(text: str) -> str:
    """32 hex digits over a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def table_content(table: Table) -> str:
    """Hash over everything in a table, its names and notes included."""
    return content_hash(_listing([content_hash(text_of(rule)) for rule in table.rules]))


def write_table(connection: sqlite3.Connection, table: Table) -> str:
    """Store a table, within a transaction; its content hash.

    Raises
    ------
    MalformedTable
        When what would be stored could not be read back.
    """
    for rule in table.rules:
        _readable(rule)
    texts = list(map(text_of, table.rules))
    contents = list(map(content_hash, texts))
    connection.executemany(
        "INSERT OR IGNORE INTO rules VALUES (?, ?)", zip(contents, texts, strict=True)
    )
    listing = _listing(contents)
    content = content_hash(listing)
    connection.execute("INSERT OR IGNORE INTO tables VALUES (?, ?)", (content, listing))
    return content


def read_table(connection: sqlite3.Connection, content: str, what: str) -> Table:
    """Read a table back.

    Raises
    ------
    StoreCorrupt
        Naming ``what``, when it is not what was written, or this release cannot read it.
    """
    row = connection.execute("SELECT rules FROM tables WHERE content = ?", (content,)).fetchone()
    if row is None or content_hash(row[0]) != content:
        raise StoreCorrupt(f"{what} is damaged: its list of rules is not what was written")
    rules = []
    for place, wanted in enumerate(json.loads(row[0])):
        found = connection.execute("SELECT json FROM rules WHERE content = ?", (wanted,)).fetchone()
        if found is None or content_hash(found[0]) != wanted:
            raise StoreCorrupt(f"{what} is damaged: rule {place + 1} is not what was written")
        try:
            rules.append(read_rule(found[0]))
        except ValidationError as error:
            where, _, why = first_invalid(error)
            raise StoreCorrupt(
                f"{what} cannot be read by this release: rule {place + 1}, {where}: {why}"
            ) from None
    return Table(rules=tuple(rules))


def _check_readable(rule: Rule) -> None:
    """A rule may have been made around its validation; the next start would fall over it."""
    try:
        Rule.model_validate_json(text_of(rule))
    except ValidationError as error:
        where, value, why = first_invalid(error)
        raise MalformedTable(f"a rule cannot be stored: {where} = {value!r}: {why}") from None


_readable = IdentityCache[Rule, None](_check_readable)


def _listing(contents: list[str]) -> str:
    return json.dumps(contents, separators=(",", ":"))
