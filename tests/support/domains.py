"""ROS domains for tests, so that parallel runs on one machine do not hear each other."""

import fcntl
import os
import random
import tempfile
from pathlib import Path

# Below 101 the ports of a domain stay clear of the system's ephemeral ones.
_DOMAINS = range(1, 101)
# Locks of this process: the kernel gives them back when it ends, in whatever way.
_held: list[int] = []


def next_domain() -> int:
    """A domain that this run has not used yet, and that no other run uses.

    Raises
    ------
    RuntimeError
        When all domains are taken.
    """
    folder = Path(tempfile.gettempdir()) / f"kompass-test-domains-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    for domain in random.sample(_DOMAINS, len(_DOMAINS)):
        descriptor = os.open(folder / str(domain), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            continue
        _held.append(descriptor)
        return domain
    raise RuntimeError(f"all {len(_DOMAINS)} ROS domains for tests are taken on this machine")
