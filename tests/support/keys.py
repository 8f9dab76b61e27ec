"""One key for all robots of a run, so that whatever a test starts may ask them for changes."""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

from kompass.signing.key import RobotKey
from kompass.store.robot_key import GIVEN


def give_key() -> None:
    """Have this process and its children take a new key, unless they were told of one."""
    if GIVEN in os.environ:
        return
    folder = Path(tempfile.mkdtemp(prefix="kompass-key-"))
    atexit.register(shutil.rmtree, folder)
    file = folder / "robot.key"
    file.touch(0o600)
    file.write_text(RobotKey.new().text)
    os.environ[GIVEN] = str(file)
