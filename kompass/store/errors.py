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


class NoSuchPlace(StoreError):
    """There is no place with this number."""


class StalePlace(StoreError):
    """Somebody else has changed the place since a change of it began."""


class PlaceRefused(StoreError):
    """The name is taken, or there are as many places as there may be."""
