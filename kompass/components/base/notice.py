"""Tell the recipe's author something that is no error, once."""

import logging

_told: set[str] = set()


def notice_once(text: str) -> None:
    """Log a warning, the same one once in the life of the process."""
    if text not in _told:
        _told.add(text)
        logging.getLogger("kompass.config").warning(text)
