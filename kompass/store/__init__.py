"""The robot's own store: rules, places, missions, zones, its timeline. No ROS: SQLite."""

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
from kompass.store.timeline_store import TimelineStore
from kompass.store.zone_store import ZoneStore

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
    "TimelineStore",
    "ZoneStore",
    "choose",
    "data_dir",
    "robot_folder",
    "safe_name",
]
