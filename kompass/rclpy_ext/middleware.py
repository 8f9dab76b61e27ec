"""Choose how Fast DDS carries messages, before it is loaded.

Its shared memory locks a mutex between processes while it sends. A process that is killed in that
moment leaves it locked, and every other sender on the machine waits on it for seconds, the drive
manager included (seen: half of a stack hung in ``SharedMemManager::Port::try_push`` at its end;
``ros2/rmw_fastrtps`` issue 908 tells of the like).
UDP over loopback has nothing that a dead process could keep, and leaves no files behind.
"""

import os
from collections.abc import MutableMapping
from pathlib import Path

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"
TRANSPORTS = "FASTDDS_BUILTIN_TRANSPORTS"


def prepare_middleware(environment: MutableMapping[str, str] = os.environ) -> None:
    """Prefer UDP; what the user has chosen in these variables stays.

    ``ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST`` makes the middleware add shared memory whatever
    else is said, so that range is carried out by a profile of our own instead.
    """
    if PROFILES in environment:
        return
    environment.setdefault(TRANSPORTS, "UDPv4")
    if environment.get(RANGE, "").upper() == "LOCALHOST":
        environment[RANGE] = "SYSTEM_DEFAULT"
        environment[PROFILES] = str(Path(__file__).with_name("loopback.xml"))
