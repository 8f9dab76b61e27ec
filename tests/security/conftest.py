"""What an attacker meets: the console of the other tests, and a robot of its own."""

from tests.console.conftest import console, domain
from tests.support.running import robot

__all__ = ["console", "domain", "robot"]
