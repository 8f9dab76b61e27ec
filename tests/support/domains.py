"""ROS domains for tests, so that parallel runs on one machine do not hear each other."""

import fcntl
import gc
import os
import random
import tempfile
from pathlib import Path

# Below 101 the ports of a domain stay clear of the system's ephemeral ones. A stack never comes to
# where nodes of the tests' own processes were: some of them outlive the test that made them.
_OF_STACKS = range(1, 41)
_OF_NODES = range(41, 100)
# Locks of this process: the kernel gives them back when it ends, in whatever way.
_held: dict[int, int] = {}


def next_domain(*, stack: bool = False) -> int:
    """A domain that nobody else uses, this run or another, until it is given back.

    Parameters
    ----------
    stack
        Whether a whole stack will run on it, in processes of its own.

    Raises
    ------
    RuntimeError
        When all domains are taken.
    """
    if not stack:
        # A node that ended is kept by rings of references, and a participant as long as its node:
        # on the domain that it had, the next one would meet it.
        gc.collect()
    folder = Path(tempfile.gettempdir()) / f"kompass-test-domains-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    domains = _OF_STACKS if stack else _OF_NODES
    for domain in random.sample(domains, len(domains)):
        descriptor = os.open(folder / str(domain), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(descriptor)
            continue
        _held[domain] = descriptor
        return domain
    raise RuntimeError(f"all {len(domains)} ROS domains for tests are taken on this machine")


def give_back(domain: int) -> None:
    """Let others have a domain on which nothing runs any more."""
    descriptor = _held.pop(domain, None)
    if descriptor is not None:
        os.close(descriptor)
