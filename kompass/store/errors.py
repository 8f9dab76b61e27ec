"""What can go wrong with the store; each message says what, where and what to do."""


class StoreError(Exception):
    """The store cannot do what was asked; nothing was changed."""


class StoreBusy(StoreError):
    """Another process writes this store."""


class StoreUnwritable(StoreError):
    """The folder or the file cannot be written: rights, a read-only or a full disk."""


class StoreTooNew(StoreError):
    """A newer release has written the file."""


class StoreCorrupt(StoreError):
    """What is stored is damaged, or cannot be read by this release."""


class StoreClosed(StoreError):
    """The store was closed."""


class MalformedTable(StoreError):
    """A table breaks the rules of its own model."""


class NoSuchRevision(StoreError):
    """There is no revision with this number."""


class StaleRevision(StoreError):
    """Another revision is in force than the one that a change began from."""


class ChangeRefused(StoreError):
    """Whoever asked for a change can mend what is wrong with it."""


class NoSuchEntry(ChangeRefused):
    """There is no place, mission or zone with this number."""


class StaleEntry(ChangeRefused):
    """Somebody else has changed the place, mission or zone since a change of it began."""


class EntryRefused(ChangeRefused):
    """The name is taken, or there are as many as there may be."""
