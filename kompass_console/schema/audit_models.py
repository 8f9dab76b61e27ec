"""What the page is told of the audit log."""

from __future__ import annotations

from pydantic import BaseModel, JsonValue


class AuditLine(BaseModel):
    """Who did what, from which address, and how it ended; `time` is ISO 8601 in UTC.

    `session` is the beginning of the log-in's id. `details` has what else is known, `before` and
    `after` where something was changed.
    """

    seq: int
    time: str
    who: str
    role: str
    session: str
    address: str
    what: str
    outcome: str
    details: dict[str, JsonValue]


class AuditPage(BaseModel):
    """Lines of the audit log, newest first. `problem` says why it is not written now, or what of
    it is missing; empty when all is well."""

    lines: list[AuditLine]
    more: bool
    problem: str
