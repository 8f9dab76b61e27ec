"""What an attacker meets: the console of the other tests."""

from tests.console.conftest import console, domain

__all__ = ["console", "domain"]
