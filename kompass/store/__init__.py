"""The robot's own store of its rules. No ROS: SQLite, a lock and one thread for the journal."""

from kompass.store.boot import Boot, choose
from kompass.store.errors import (
    MalformedTable,
    NoSuchRevision,
    StaleRevision,
    StoreBusy,
    StoreClosed,
    StoreCorrupt,
    StoreError,
    StoreTooNew,
    StoreUnwritable,
)
from kompass.store.journal import JournalBounds, Refusal
from kompass.store.paths import data_dir, robot_folder, safe_name
from kompass.store.store import RuleStore

__all__ = [
    "Boot",
    "JournalBounds",
    "MalformedTable",
    "NoSuchRevision",
    "Refusal",
    "RuleStore",
    "StaleRevision",
    "StoreBusy",
    "StoreClosed",
    "StoreCorrupt",
    "StoreError",
    "StoreTooNew",
    "StoreUnwritable",
    "choose",
    "data_dir",
    "robot_folder",
    "safe_name",
]
