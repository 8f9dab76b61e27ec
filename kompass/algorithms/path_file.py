"""Paths on disk: a ``nav_msgs/Path`` as JSON, as ``save_plan_to_file`` of Kompass writes it."""

from __future__ import annotations

import json
import math
import os
import stat
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from kompass.algorithms.geometry import Floats, yaw_from_quaternion

LARGEST = 20_000_000  # bytes
LONGEST_NUMBER = 300  # digits; above 308 it is none that can be reckoned with


class PathFileError(ValueError):
    """A file of a path that cannot be used; the message names file, field, value and remedy."""


class SavedPath(NamedTuple):
    """What a file holds.

    Attributes
    ----------
    frame
        In which it is given; empty where the file does not say.
    poses
        (N, 3): x, y, yaw [m, m, rad].
    """

    frame: str
    poses: Floats


def load_path(path: Path) -> SavedPath:
    """Read the path of a file.

    Fields: ``poses``, each with ``pose.position.x``, ``.y`` and ``pose.orientation.x``, ``.y``,
    ``.z``, ``.w`` (0, 0, 0, 1 where left out), and ``header.frame_id``; others are passed over.

    Raises
    ------
    PathFileError
        The file is missing, none of plain text, too large or no JSON, or a field is unusable.
    """
    try:
        content = json.loads(_read(path), parse_int=_whole)
    except (UnicodeDecodeError, json.JSONDecodeError, RecursionError) as error:
        raise PathFileError(f"{path}: is no JSON ({error}); give a nav_msgs/Path as JSON") from None
    poses = content.get("poses") if isinstance(content, dict) else None
    if not isinstance(poses, list):
        raise PathFileError(f"{path}: poses: {_short(poses)}; give a list of poses")
    frame = _field(path, content, "header", "frame_id", default="")
    if not isinstance(frame, str):
        raise PathFileError(f"{path}: header.frame_id: {_short(frame)}; give the name of a frame")
    rows = [_pose(path, pose, f"poses[{index}]") for index, pose in enumerate(poses)]
    return SavedPath(frame, np.array(rows, dtype=np.float64).reshape(-1, 3))


def _whole(digits: str) -> int | float:
    """A whole number; one of too many digits is infinite, and refused where it stands."""
    return int(digits) if len(digits) <= LONGEST_NUMBER else float(digits)


def _read(path: Path) -> str:
    try:
        # A pipe would keep whoever opens it waiting.
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        with os.fdopen(descriptor, "rb") as file:
            found = os.fstat(descriptor)
            if not stat.S_ISREG(found.st_mode):
                raise PathFileError(f"{path}: is no plain file; give the file of a path")
            if found.st_size > LARGEST:
                raise PathFileError(
                    f"{path}: has {found.st_size} bytes; at most {LARGEST} are read: thin it out"
                )
            return file.read(LARGEST).decode()
    except FileNotFoundError:
        raise PathFileError(f"{path}: does not exist; give folder and name of a file") from None
    except OSError as error:
        raise PathFileError(f"{path}: cannot be read: {error.strerror}") from None


def _pose(path: Path, stamped: object, where: str) -> tuple[float, float, float]:
    x, y = (_number(path, stamped, where, "pose", "position", axis) for axis in ("x", "y"))
    usual = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    turn = [
        _number(path, stamped, where, "pose", "orientation", part, default=value)
        for part, value in usual.items()
    ]
    return x, y, yaw_from_quaternion(*turn)


def _number(path: Path, holder: object, where: str, *names: str, default: Any = None) -> float:
    value = _field(path, holder, *names, default=default, where=where)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        name = ".".join((where, *names))
        raise PathFileError(f"{path}: {name}: {_short(value)}; give a finite number")
    return float(value)


def _field(path: Path, holder: object, *names: str, default: Any, where: str = "") -> Any:
    for index, name in enumerate(names):
        if not isinstance(holder, dict):
            full = ".".join(part for part in (where, *names[:index]) if part)
            raise PathFileError(f"{path}: {full}: {_short(holder)}; give an object, {{…}}")
        holder = holder.get(name, default if name == names[-1] else {})
    return holder


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}…"
