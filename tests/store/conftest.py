"""Fixtures of the store's tests."""

from tests.store.tables import robot
from tests.support.disk import databases

__all__ = ["databases", "robot"]
