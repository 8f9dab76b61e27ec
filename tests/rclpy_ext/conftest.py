"""Tests here spin an executor of rclpy themselves."""

from tests.support.spinning import spinning as spinning
