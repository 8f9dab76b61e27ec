"""Paths as files, as Kompass saves them."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path


def save_path(
    file: Path,
    path: Sequence[tuple[float, float, float]],
    frame: str = "map",
    changed: Mapping[str, object] | None = None,
) -> Path:
    """Write poses (x, y, yaw) into a file, with some fields other than they would be."""
    content = {
        "header": {"stamp": {"sec": 1, "nanosec": 0}, "frame_id": frame},
        "poses": [
            {
                "header": {"frame_id": frame},
                "pose": {
                    "position": {"x": x, "y": y, "z": 0.0},
                    "orientation": {"z": math.sin(yaw / 2), "w": math.cos(yaw / 2)},
                },
            }
            for x, y, yaw in path
        ],
    }
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(content | dict(changed or {})), encoding="utf-8")
    return file
