"""A rule table as a file."""

from __future__ import annotations

from typing import Literal

from kompass.rulebook.table_view import TableView

Format = Literal["json", "yaml", "python"]


def table_text(view: str, kind: Format) -> tuple[str, int]:
    """The table of a `TableView` (JSON) as text, and the number of its revision."""
    from kompass.recipe import export

    shown = TableView.model_validate_json(view)
    write = {"json": export.to_json, "yaml": export.to_yaml, "python": export.to_python}
    return write[kind](shown.table), shown.revision
