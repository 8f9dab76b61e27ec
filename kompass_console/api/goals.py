"""Goals: checked where they are pressed, sent, canceled."""

from __future__ import annotations

import math
from typing import Any

from fastapi import APIRouter

from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.scene import unknown_view
from kompass_console.link.goal_check import STOPPED, Checked, above_horizon
from kompass_console.link.link import CANCEL_TIMEOUT
from kompass_console.scene.layers.preview import Preview
from kompass_console.scene.scene import DriveShown, PageNotConnected
from kompass_console.schema.models import GestureCheck, GoalCheck, GoalRequest, GoalSent
from kompass_console.schema.world import GoalMark
from kompass_console.web.auth import LoginSession
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/goals", tags=["goals"])

_SHORTEST_DRAG = 0.05  # m on the floor; less has no direction
_REMEDIES = {
    "no_map": "Load a map, then send the goal again.",
    "no_pose": "Check the robot's localization, then send the goal again.",
    "start_blocked": "Move the robot into the open, then send the goal again.",
    "no_planner": "Start the robot's program, or look at the planner's health.",
    "nobody_listens": "Start the robot's program, or look at the planner's health.",
}


@router.post("/check")
async def check(
    body: GestureCheck | GoalRequest, session: LoggedIn, console: CurrentConsole
) -> GoalCheck:
    """Would this goal be accepted? Nothing moves. The answer is drawn in the view."""
    goal = await _picked(body, session, console) if isinstance(body, GestureCheck) else body
    if goal is None:
        return above_horizon()
    checked = await console.checker.check(goal.x, goal.y, goal.yaw)
    if goal.view is not None and console.views.get(goal.view, session) is not None:
        _draw(console, goal.view, checked)
    return checked.check


@router.post("")
async def send(goal: GoalRequest, session: Operator, console: CurrentConsole) -> GoalSent:
    """Send the robot there, after checking the goal again unless it has only just passed."""
    checked = await console.checker.check_before_sending(goal.x, goal.y, goal.yaw)
    what: dict[str, Any] = {"x": goal.x, "y": goal.y, "yaw": goal.yaw}
    refusal = _refusal(console, checked)
    if refusal is not None or checked.topic is None:
        refusal = refusal or ConsoleError(409, checked.check.message, _REMEDIES["nobody_listens"])
        console.audit.record(session, "send goal", refusal.title, **what)
        raise refusal
    answer = checked.check
    speed = None
    if answer.length is not None and answer.duration:
        speed = answer.length / answer.duration
    running = _under_way(console)
    goal_id = console.link.goals.send(
        goal.x, goal.y, goal.yaw, checked.topic, by=session.user, speed=speed
    )
    if goal.view is not None and console.views.get(goal.view, session) is not None:
        console.scene.preview(goal.view, None)
    console.audit.record(
        session, "send goal", "sent", topic=checked.topic, before=running, after=goal_id, **what
    )
    return GoalSent(
        id=goal_id, topic=checked.topic, heading_used=answer.heading_used, note=answer.note
    )


@router.post("/cancel", status_code=202)
async def cancel(session: Operator, console: CurrentConsole) -> None:
    """Cancel the goal that runs; watch the state for the outcome."""
    before = _under_way(console)
    try:
        running = await console.link.goals.cancel(CANCEL_TIMEOUT)
    except NoAnswer as error:
        console.audit.record(session, "cancel goal", error.why, before=before)
        raise ConsoleError(
            503,
            f"The goal is not canceled: {error.why}.",
            "Press STOP if the robot must not go on.",
        ) from error
    outcome = "asked" if running else "no goal was running"
    console.audit.record(session, "cancel goal", outcome, before=before)


def _under_way(console: Console) -> str | None:
    """Id of the goal that is followed, for the audit log."""
    goal = console.link.goals.follower.info()
    over = goal is None or goal.phase in ("arrived", "failed", "canceled")
    return None if goal is None or over else goal.id


async def _picked(
    body: GestureCheck, session: LoginSession, console: Console
) -> GoalRequest | None:
    """The goal a gesture means; None when it is not on the floor."""
    if console.views.get(body.view, session) is None:
        raise unknown_view()
    try:
        points = await console.scene.pick(
            body.view, [body.start] if body.end is None else [body.start, body.end]
        )
    except PageNotConnected as error:
        raise ConsoleError(
            409, "The scene is not connected.", "Wait until it is drawn again, then repeat."
        ) from error
    except DriveShown as error:
        raise ConsoleError(
            409, "The scene shows a drill, and not the robot.", "Go back to the robot first."
        ) from error
    start, end = points[0], points[-1]
    if start is None or end is None:
        return None
    dx, dy = end[0] - start[0], end[1] - start[1]
    yaw = math.atan2(dy, dx) if math.hypot(dx, dy) > _SHORTEST_DRAG else None
    return GoalRequest(x=start[0], y=start[1], yaw=yaw, view=body.view)


def _draw(console: Console, view_id: str, checked: Checked) -> None:
    answer = checked.check
    mark = GoalMark(answer.x, answer.y, answer.yaw, active=False)
    console.scene.preview(view_id, Preview(mark, checked.preview))


def _refusal(console: Console, checked: Checked) -> ConsoleError | None:
    answer = checked.check
    if not answer.ok:
        remedy = _REMEDIES.get(answer.reason, "Choose another point.")
        return ConsoleError(409, answer.message, remedy)
    drive = console.link.drive.info()
    if drive is not None and drive.stopped:
        return ConsoleError(409, STOPPED, "Release STOP when the way is clear, then send it again.")
    if drive is not None and drive.driven_by:
        return ConsoleError(
            409,
            f"{drive.driven_by} drives by hand.",
            "Send the goal again when the wheel has been given up.",
        )
    return None
