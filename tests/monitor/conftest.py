"""Tests here spin an executor of rclpy themselves, and spoil disks."""

from tests.support.disk import databases
from tests.support.spinning import spinning

__all__ = ["databases", "spinning"]
