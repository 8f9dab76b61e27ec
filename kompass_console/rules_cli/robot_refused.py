"""What a robot does not do."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kompass_console.cli_error import CliError

if TYPE_CHECKING:
    from kompass.rulebook.schema.report import CheckReport, Conflict

REFUSED = 1  # exit code, as the help tells it


class RobotRefused(CliError):
    """The robot did not do it; ``body`` says why in full."""

    def __init__(
        self, text: str, body: CheckReport | Conflict | None = None, code: int = REFUSED
    ) -> None:
        super().__init__(code, text)
        self.body = body
