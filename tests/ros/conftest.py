"""One running stack for a module of tests."""

from tests.support.running import robot, stack

__all__ = ["robot", "stack"]
