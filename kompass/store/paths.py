"""Where a robot keeps its data on disk."""

import hashlib
import os
import re
from collections.abc import Mapping
from pathlib import Path

from kompass.store.errors import StoreUnwritable

DATA_DIR = "KOMPASS_DATA_DIR"
ROBOT_NAME = "KOMPASS_ROBOT_NAME"
STATE_HOME = "XDG_STATE_HOME"
MAX_NAME = 80


def robot_folder(environment: Mapping[str, str] = os.environ) -> Path:
    """Folder of the robot that the environment names: ``<data dir>/<robot>``.

    ``KOMPASS_ROBOT_NAME`` names the robot; without it this machine's name does.

    Raises
    ------
    StoreUnwritable
        When there is neither ``KOMPASS_DATA_DIR`` nor a home folder.
    """
    return data_dir(environment) / safe_name(environment.get(ROBOT_NAME) or os.uname().nodename)


def data_dir(environment: Mapping[str, str] = os.environ) -> Path:
    """Folder of all robots: ``KOMPASS_DATA_DIR``, else ``kompass`` in the XDG state folder.

    Raises
    ------
    StoreUnwritable
        When there is neither ``KOMPASS_DATA_DIR`` nor a home folder.
    """
    given = environment.get(DATA_DIR)
    if given:
        return Path(given).expanduser().absolute()
    state = environment.get(STATE_HOME, "")
    if Path(state).is_absolute():  # the XDG specification: a relative one is to be ignored
        return Path(state) / "kompass"
    home = environment.get("HOME", "")
    if not home:
        raise StoreUnwritable(
            f"there is no home folder to keep the rules in; set {DATA_DIR} or --data-dir"
        )
    return Path(home) / ".local" / "state" / "kompass"


def safe_name(robot: str) -> str:
    """A robot's name as the name of a folder; names that differ give folders that differ."""
    if re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*", robot) and len(robot) <= MAX_NAME:
        return robot
    kept = re.sub(r"[^A-Za-z0-9_.-]+", "_", robot)[: MAX_NAME - 9].lstrip("._-") or "robot"
    return f"{kept}-{hashlib.sha256(robot.encode()).hexdigest()[:8]}"
