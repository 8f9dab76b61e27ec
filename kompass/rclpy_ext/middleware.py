"""Choose how Fast DDS carries messages, before it is loaded.

Its shared memory locks a mutex between processes while it sends. A process that is killed in that
moment leaves it locked, and every other sender on the machine waits on it for seconds, the drive
manager included (seen: half of a stack hung in ``SharedMemManager::Port::try_push`` at its end;
``ros2/rmw_fastrtps`` issue 908 tells of the like).
UDP over loopback has nothing that a dead process could keep, and leaves no files behind.

But the kernel gives a socket 208 KiB, and drops what comes while it is full: of point clouds of
20,000 points, sent best effort, three of four were lost, and all that a stack's processes tell a
new one of themselves in its first moment overran it, too. So all profiles ask for 4 MiB, of which
the kernel gives as much as ``net.core.rmem_max`` allows.
"""

import hashlib
import os
import socket
import tempfile
from collections.abc import MutableMapping, Sequence
from pathlib import Path

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PEERS = "ROS_STATIC_PEERS"  # names or addresses, with semicolons between
MIDDLEWARE = "RMW_IMPLEMENTATION"
PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"
TRANSPORTS = "FASTDDS_BUILTIN_TRANSPORTS"


LOOPBACK = Path(__file__).with_name("loopback.xml")
SUBNET_PROFILE = Path(__file__).with_name("subnet.xml")
_PEERS_PROFILE = Path(__file__).with_name("peers.xml")
_PEERS_PLACE = "<!-- peers -->"


def prepare_middleware(environment: MutableMapping[str, str] = os.environ) -> None:
    """Prefer UDP, with room; what the user has chosen in these variables stays.

    ``ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`` makes the middleware add shared memory whatever
    else is said, and listen on every interface: a neighbour that names this machine as its peer
    comes in. So that range is carried out by a profile of our own instead, bound to loopback, or
    by one that looks for the ``ROS_STATIC_PEERS``.

    Raises
    ------
    PermissionError
        When the folder for the profile with the peers belongs to somebody else.
    """
    chosen = environment.get(PROFILES)
    if not is_fast_dds(environment) or chosen not in {None, str(SUBNET_PROFILE)}:
        return
    environment.setdefault(TRANSPORTS, "UDPv4")
    if environment.get(RANGE, "").upper() == "LOCALHOST":
        names = peers(environment)
        addresses = [addresses_of(name) for name in names]
        if not all(addresses):
            environment.pop(PROFILES, None)
            return  # the middleware says which, and starts nothing
        environment[RANGE] = "SYSTEM_DEFAULT"
        environment[PROFILES] = str(
            _profile_of([one for several in addresses for one in several]) if names else LOOPBACK
        )
    else:
        environment[PROFILES] = str(SUBNET_PROFILE)


def is_fast_dds(environment: MutableMapping[str, str] = os.environ) -> bool:
    """Whether the environment chooses Fast DDS, as it does when it says nothing."""
    return "fastrtps" in (environment.get(MIDDLEWARE) or "rmw_fastrtps_cpp")


def peers(environment: MutableMapping[str, str] = os.environ) -> list[str]:
    """The peers that the environment names."""
    return [name.strip() for name in environment.get(PEERS, "").split(";") if name.strip()]


def is_ours(profiles: str) -> bool:
    """Whether a file of profiles is one that `prepare_middleware` chose."""
    return profiles in {str(LOOPBACK), str(SUBNET_PROFILE)} or Path(profiles).parent == _folder()


def addresses_of(peer: str) -> list[str]:
    """The IPv4 addresses of a machine; none when its name is not known."""
    try:
        found = socket.getaddrinfo(peer, None, socket.AF_INET, socket.SOCK_DGRAM)
    except (OSError, UnicodeError):
        return []
    return sorted({str(each[4][0]) for each in found})


def _folder() -> Path:
    base = Path(os.environ.get("XDG_RUNTIME_DIR") or tempfile.gettempdir())
    return base / f"kompass-{os.getuid()}"


def _profile_of(addresses: Sequence[str]) -> Path:
    """Write the profile that looks for these machines; one file for each set of them."""
    place = "\n          ".join(
        f"<locator><udpv4><address>{address}</address></udpv4></locator>" for address in addresses
    )
    text = _PEERS_PROFILE.read_text(encoding="utf-8").replace(_PEERS_PLACE, place)
    folder = _folder()
    folder.mkdir(mode=0o700, exist_ok=True)
    if folder.lstat().st_uid != os.getuid():
        raise PermissionError(
            f"{folder} belongs to another user, and the network is not told by what others can "
            "write; set XDG_RUNTIME_DIR to a folder of your own"
        )
    path = folder / f"peers-{hashlib.sha256(text.encode()).hexdigest()[:16]}.xml"
    writing = path.with_suffix(f".{os.getpid()}")
    writing.write_text(text, encoding="utf-8")
    writing.replace(path)  # never half a profile: without one, everybody would be let in
    return path
