"""A cloud that is sent best effort finds room: its datagrams come at once, and none comes again."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from kompass.rclpy_ext.middleware import PEERS, PROFILES, RANGE

pytestmark = pytest.mark.ros

WANTED = 4_194_304  # bytes
# In a process of its own: a profile is read when DDS is loaded.
LARGEST = """
import os, socket
from pathlib import Path
import kompass, rclpy
rclpy.init()
node = rclpy.create_node("alone")
sizes = []
for link in Path("/proc/self/fd").iterdir():
    if os.path.exists(link) and os.readlink(link).startswith("socket:"):
        with socket.socket(fileno=os.dup(int(link.name))) as one:
            if one.family == socket.AF_INET and one.type == socket.SOCK_DGRAM:
                sizes.append(one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF))
print(max(sizes))
os._exit(0)
"""


@pytest.mark.parametrize("peers", ["", "127.0.0.1"], ids=["this machine", "peers"])
def test_sockets_have_as_much_room_as_the_kernel_lets_them(peers: str, tmp_path: Path) -> None:
    environment = {name: value for name, value in os.environ.items() if name != PROFILES}
    environment |= {RANGE: "LOCALHOST", PEERS: peers, "XDG_RUNTIME_DIR": str(tmp_path)}
    said = subprocess.run(
        [sys.executable, "-c", LARGEST], env=environment, capture_output=True, text=True, check=True
    )
    allowed = int(Path("/proc/sys/net/core/rmem_max").read_text(encoding="ascii"))
    # The kernel keeps twice what it is asked for: half of that is its own bookkeeping.
    assert int(said.stdout) == 2 * min(WANTED, allowed)
