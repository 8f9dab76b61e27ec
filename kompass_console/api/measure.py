"""How far it is from one point of the floor to another."""

from __future__ import annotations

import numpy as np
from fastapi import APIRouter

from kompass_console.api.access import CurrentConsole, LoggedIn
from kompass_console.api.gesture import points_on_floor
from kompass_console.api.scene import unknown_view
from kompass_console.scene.layers.preview import Preview
from kompass_console.schema.measure_models import MOST_POINTS, MeasuredPoints, MeasureSketch

router = APIRouter(prefix="/api/measure", tags=["scene"])

_FULL = f"A measurement has at most {MOST_POINTS} points. Clear it, and begin again."


@router.post("")
async def measure(
    body: MeasureSketch, session: LoggedIn, console: CurrentConsole
) -> MeasuredPoints:
    """Add what was pressed to a line of points, and show the line on that view; nothing is kept."""
    if console.views.get(body.view, session) is None:
        raise unknown_view()
    points, problem = list(body.points), ""
    if body.start is not None:
        found = await points_on_floor(body.view, body.start, body.end, session, console)
        if found is None:
            problem = "This is above the horizon; press the floor."
        else:
            start, end = found
            fresh = [start] if end is None else [start, end] if not points else [end]
            if len(points) + len(fresh) > MOST_POINTS:
                problem = _FULL
            else:
                points += [(round(x, 3), round(y, 3)) for x, y in fresh]
    shown = points if len(points) > 1 else points * 2
    console.scene.preview(body.view, Preview(None, path=np.asarray(shown)) if points else None)
    return MeasuredPoints(points=points, problem=problem)
