"""The robot's own store of its rules and its places. No ROS: SQLite, a thread for the journal."""

from kompass.store.boot import Boot, choose
from kompass.store.errors import (
    MalformedTable,
    NoSuchPlace,
    NoSuchRevision,
    PlaceRefused,
    StalePlace,
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
from kompass.store.place_store import PlaceStore
from kompass.store.store import RuleStore

__all__ = [
    "Boot",
    "JournalBounds",
    "MalformedTable",
    "NoSuchPlace",
    "NoSuchRevision",
    "PlaceRefused",
    "PlaceStore",
    "Refusal",
    "RuleStore",
    "StalePlace",
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
