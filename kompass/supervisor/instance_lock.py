"""One stack of a name on a ROS domain: a second one is refused before it moves anything."""

import fcntl
import os
import tempfile
from pathlib import Path


class AlreadyRunning(RuntimeError):
    """Another stack on this machine runs the same nodes on the same ROS domain."""


def lock_instance(names: list[str], namespace: str = "") -> list[int]:
    """Lock node names on this machine's ROS domain, for as long as this process lives.

    The lock is one on a file, which the kernel gives back when the process ends in whatever
    way. Stacks on other machines are noticed over DDS by the components themselves.

    Parameters
    ----------
    names
        Of all nodes of the stack.
    namespace
        ROS namespace of the nodes.

    Returns
    -------
    list[int]
        File descriptors to keep open.

    Raises
    ------
    AlreadyRunning
        Naming the node and the process that has it.
    """
    domain = os.environ.get("ROS_DOMAIN_ID", "0") or "0"
    folder = Path(os.environ.get("XDG_RUNTIME_DIR") or tempfile.gettempdir())
    folder = folder / f"kompass-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    held: list[int] = []
    for name in names:
        full = f"{namespace.strip('/')}.{name}".strip(".")
        path = folder / f"domain-{domain}.{full}.lock"
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = os.read(descriptor, 32).decode(errors="replace").strip() or "unknown"
            for other in [*held, descriptor]:
                os.close(other)
            raise AlreadyRunning(
                f"another stack already runs '{name}' on ROS domain {domain} (process {owner}); "
                "stop it, or choose another domain with --domain-id"
            ) from None
        os.ftruncate(descriptor, 0)
        os.write(descriptor, str(os.getpid()).encode())
        held.append(descriptor)
    return held
