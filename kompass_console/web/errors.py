"""Errors that people read: what and why, and what to do about it."""

from __future__ import annotations

from collections.abc import Mapping

from starlette.exceptions import HTTPException


class ConsoleError(HTTPException):
    """An answer other than success: HTTP status, one sentence of what and why, one of remedy."""

    def __init__(
        self, status: int, title: str, remedy: str, headers: Mapping[str, str] | None = None
    ) -> None:
        super().__init__(status, title, dict(headers or {}))
        self.title = title
        self.remedy = remedy
