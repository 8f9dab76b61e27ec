"""A table as somebody who wants to show or edit it gets it."""

from kompass.rulebook.schema.report import Finding
from kompass.rules.schema.model import Model
from kompass.rules.schema.table import Table


class Merge(Model):
    """The recipe changed since the edits of ``revision`` were made; they wait to be merged.

    Attributes
    ----------
    table
        The recipe's new table with the edits laid over it, ready to be checked and applied.
    conflicts
        One sentence for each edit that could not be laid over.
    """

    revision: int
    table: Table
    conflicts: tuple[str, ...] = ()


class TableView(Model):
    """A revision of the table.

    Attributes
    ----------
    conditions
        The condition of each rule as text, by rule id.
    actions
        Its actions as texts, by rule id.
    hashes
        Content hash of each rule.
    findings
        Lints that hold for it right now.
    from_recipe
        Ids of rules with code of the recipe: their code cannot be edited.
    merge
        Edits of an older recipe, offered for merge; None for none.
    """

    revision: int
    active: int
    confirmed: int
    probation_left: float
    notice: str
    robot: str
    table: Table
    conditions: dict[str, str]
    actions: dict[str, tuple[str, ...]]
    hashes: dict[str, str]
    findings: tuple[Finding, ...] = ()
    from_recipe: tuple[str, ...] = ()
    merge: Merge | None = None
    safe_mode: bool = False
