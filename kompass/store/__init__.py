"""The robot's own store of rules, places and missions. No ROS: SQLite, a thread for the journal."""

from kompass.store.boot import Boot, choose
from kompass.store.errors import (
    ChangeRefused,
    EntryRefused,
    MalformedTable,
    NoSuchEntry,
    NoSuchRevision,
    StaleEntry,
    StaleRevision,
    StoreBusy,
    StoreClosed,
    StoreCorrupt,
    StoreError,
    StoreTooNew,
    StoreUnwritable,
)
from kompass.store.journal import JournalBounds, Refusal
from kompass.store.mission_store import MissionStore
from kompass.store.paths import data_dir, robot_folder, safe_name
from kompass.store.place_store import PlaceStore
from kompass.store.store import RuleStore

__all__ = [
    "Boot",
    "ChangeRefused",
    "EntryRefused",
    "JournalBounds",
    "MalformedTable",
    "MissionStore",
    "NoSuchEntry",
    "NoSuchRevision",
    "PlaceStore",
    "Refusal",
    "RuleStore",
    "StaleEntry",
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
