"""Texts of others, on one line: what people and programs send must not steer a terminal."""

import logging
import sys
from types import TracebackType

LONGEST = 2_000  # characters


def printable(text: str, longest: int = LONGEST) -> str:
    """A text with everything escaped that is no letter, sign or blank, cut to a length."""
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


class PrintableFormatter(logging.Formatter):
    """A record is one line, whatever its message holds; only a traceback has more."""

    def formatMessage(self, record: logging.LogRecord) -> str:
        record.message = printable(record.message)
        return super().formatMessage(record)

    def formatException(
        self,
        ei: tuple[type[BaseException], BaseException, TracebackType | None]
        | tuple[None, None, None],
    ) -> str:
        return "\n".join(printable(line) for line in super().formatException(ei).split("\n"))


def log_to_terminal(name: str, level: int = logging.INFO) -> None:
    """Let a logger, and those below it, write to the terminal; the first word on it holds."""
    logger = logging.getLogger(name)
    if not logger.handlers:
        handler = logging.StreamHandler(sys.stderr)
        handler.setFormatter(PrintableFormatter("%(asctime)s %(message)s", "%H:%M:%S"))
        logger.addHandler(handler)
        logger.setLevel(level)
