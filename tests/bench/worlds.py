"""Two small worlds in BARN's form: posts in the way, and posts all around the goal."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any


def world_file(folder: Path, **changes: Any) -> Path:
    """A file of them, with fields of it changed."""
    # All too close together to pass between.
    row = [[1.2, round(-0.9 + 0.2 * k, 3), 0.075] for k in range(7)]
    turns = [math.tau * k / 44 for k in range(44)]
    pen = [[2.4 + 1.4 * math.cos(turn), 1.4 * math.sin(turn), 0.075] for turn in turns]
    whole = {
        "start": [0.0, 0.0, 0.0],
        "goal": [2.4, 0.0],
        "cylinder_radius": 0.075,
        "boxes": [],
        "worlds": [
            {
                "index": 1,
                "cylinders": row,
                "path": [[0.0, 0.0], [1.2, 0.6], [2.4, 0.0]],
                "optimal_length": 2.68,
            },
            {
                "index": 4,
                "cylinders": pen,
                "path": [[0.0, 0.0], [2.4, 0.0]],
                "optimal_length": 2.4,
            },
        ],
    }
    file = folder / "worlds.json"
    file.write_text(json.dumps(whole | changes), encoding="utf-8")
    return file
