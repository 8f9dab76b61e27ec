"""A rule table as a file."""

from __future__ import annotations

from kompass.recipe.export import Format, export
from kompass.rulebook.schema.table_view import TableView

SUFFIX: dict[Format, str] = {"json": "json", "yaml": "yaml", "python": "py"}


def table_text(view: str, kind: Format) -> tuple[str, int]:
    """The table of a `TableView` (JSON) as text, and the number of its revision."""
    shown = TableView.model_validate_json(view)
    title = f"{shown.robot}, revision {shown.revision}"
    return export(shown.table, kind, title=title), shown.revision
