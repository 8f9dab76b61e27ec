"""ROS domains for tests, so that parallel runs on one machine do not hear each other."""

import itertools
import os

# Below 101 the ports of a domain stay clear of the system's ephemeral ones.
_FIRST, _LAST = 1, 100
_offset = os.getpid() * 7
_numbers = itertools.count()


def next_domain() -> int:
    """A domain that this run has not used yet."""
    return _FIRST + (_offset + next(_numbers)) % (_LAST - _FIRST)
