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

And Fast DDS (2.14) says that it is there before it listens: what the others answer in that moment
is lost, and they answer once. Whoever comes late then hears of them only when they say again that
they are there, which all profiles with multicast have them do each second instead of each third. A
program that was started anew is back that much sooner. By unicast, as the middleware has it for one
machine, a word to all is 32 packets; so it is multicast on loopback, where that works.

Between participants of one process it passes words by direct calls, and loses some for good: of two
participants, one did not hear of a subscription that the other made later (two tries in five, with
seven such processes at a time; each time, with only the builtin words sent over UDP; over UDP
throughout, none of 77). So all profiles have it use the transport there too.
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
_LOOPBACK_UNICAST = Path(__file__).with_name("loopback_unicast.xml")
SUBNET_PROFILE = Path(__file__).with_name("subnet.xml")
_PEERS_PROFILE = Path(__file__).with_name("peers.xml")
_PEERS_PLACE = "<!-- peers -->"
_GROUP = "239.255.0.1"  # of DDS's discovery
_HEARD_WITHIN = 0.2  # s; on loopback it is there when it has been sent


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
        if names:
            profile = _profile_of([one for several in addresses for one in several])
        else:
            profile = LOOPBACK if _loopback_has_multicast() else _LOOPBACK_UNICAST
        environment[PROFILES] = str(profile)
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
    shipped = (LOOPBACK, _LOOPBACK_UNICAST, SUBNET_PROFILE)
    return Path(profiles) in shipped or Path(profiles).parent == _folder()


def addresses_of(peer: str) -> list[str]:
    """The IPv4 addresses of a machine; none when its name is not known."""
    try:
        found = socket.getaddrinfo(peer, None, socket.AF_INET, socket.SOCK_DGRAM)
    except (OSError, UnicodeError):
        return []
    return sorted({str(each[4][0]) for each in found})


def _loopback_has_multicast() -> bool:
    """Whether what is said to a group on 127.0.0.1 comes to who has joined it there."""
    here = socket.inet_aton("127.0.0.1")
    try:
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as speaker,
        ):
            listener.bind((_GROUP, 0))
            membership = socket.inet_aton(_GROUP) + here
            listener.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
            listener.settimeout(_HEARD_WITHIN)
            speaker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, here)
            speaker.bind(("127.0.0.1", 0))
            speaker.sendto(b"?", listener.getsockname())
            return bool(listener.recvfrom(1)[1] == speaker.getsockname())
    except OSError:
        return False


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
