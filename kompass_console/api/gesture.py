"""What a press, drag and release on a view means on the floor."""

from __future__ import annotations

import math

from kompass_console.api.scene import unknown_view
from kompass_console.scene.scene import DriveShown, PageNotConnected
from kompass_console.schema.models import GestureCheck, GoalRequest
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

_SHORTEST_DRAG = 0.05  # m on the floor; less has no direction


async def on_floor(
    gesture: GestureCheck, session: LoginSession, console: Console
) -> GoalRequest | None:
    """The place and heading that a gesture means; None when it is not on the floor.

    Raises
    ------
    ConsoleError
        When there is no such view, or it does not show the robot.
    """
    points = await points_on_floor(gesture.view, gesture.start, gesture.end, session, console)
    if points is None:
        return None
    start, end = points[0], points[1] or points[0]
    dx, dy = end[0] - start[0], end[1] - start[1]
    yaw = math.atan2(dy, dx) if math.hypot(dx, dy) > _SHORTEST_DRAG else None
    return GoalRequest(x=start[0], y=start[1], yaw=yaw, view=gesture.view)


async def points_on_floor(
    view: str,
    start: tuple[float, float],
    end: tuple[float, float] | None,
    session: LoginSession,
    console: Console,
) -> tuple[tuple[float, float], tuple[float, float] | None] | None:
    """Where a press and its release, fractions of the picture, are on the floor [m].

    None when one of them is above the horizon.

    Raises
    ------
    ConsoleError
        When there is no such view, or it does not show the robot.
    """
    if console.views.get(view, session) is None:
        raise unknown_view()
    try:
        points = await console.scene.pick(
            view,
            [start] if end is None else [start, end],
        )
    except PageNotConnected as error:
        raise ConsoleError(
            409, "The scene is not connected.", "Wait until it is drawn again, then repeat."
        ) from error
    except DriveShown as error:
        raise ConsoleError(
            409, "The scene shows a drill, and not the robot.", "Go back to the robot first."
        ) from error
    first, last = points[0], points[-1]
    if first is None or last is None:
        return None
    return first, None if end is None else last
