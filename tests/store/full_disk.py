"""A monitor that starts on a full disk: run where a small one is mounted, on its folder."""

import os
import signal
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from kompass.store.errors import StoreUnwritable
from tests.store.tables import BY, Robot, edited

folder, ended = Path(sys.argv[1]), sys.argv[2]
robot = Robot(folder / "robot")
robot.start()
robot.store.append(edited("kept"), confirmed=True, **BY)
robot.stop()
if ended == "killed":
    robot.sessions += 1
    pid = os.fork()
    if pid == 0:
        robot.sessions -= 1
        robot.start()
        os.kill(os.getpid(), signal.SIGKILL)
    assert os.waitpid(pid, 0)[1] == signal.SIGKILL
with (folder / "ballast").open("wb", buffering=0) as ballast, suppress(OSError):
    while True:
        ballast.write(b"x" * 4096)

boot = robot.start()
assert (boot.table, boot.revision) == (edited("kept"), 2)
assert "free some space" in boot.notice, boot.notice
assert not robot.store.has_recovered()
with pytest.raises(StoreUnwritable, match="full"):
    robot.store.append(edited("late"), **BY)
with pytest.raises(StoreUnwritable, match="full"):
    robot.store.recover()
assert (robot.store.active, robot.store.table(2)) == (2, edited("kept"))

(folder / "ballast").unlink()
robot.store.recover()
assert robot.store.has_recovered()

assert robot.store.append(edited("late"), confirmed=True, **BY).parent == 2
robot.stop()
assert robot.start().table == edited("late")
robot.stop()
