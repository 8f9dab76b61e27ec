"""Fixtures of the store's tests."""

from tests.store.tables import robot

__all__ = ["robot"]
