"""Goals: checked where they are pressed, sent, canceled."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter

from kompass.rclpy_ext.reply import NoAnswer
from kompass_console.api.access import CurrentConsole, LoggedIn, Operator
from kompass_console.api.gesture import on_floor
from kompass_console.api.places import place_to_go
from kompass_console.link.goal_check import STOPPED, Checked, above_horizon
from kompass_console.link.link import CANCEL_TIMEOUT
from kompass_console.scene.layers.preview import Preview
from kompass_console.schema.models import (
    GestureCheck,
    GoalCheck,
    GoalRequest,
    GoalSent,
    PlaceGoal,
)
from kompass_console.schema.world import GoalMark
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/goals", tags=["goals"])

_REMEDIES = {
    "no_map": "Load a map, then send the goal again.",
    "no_pose": "Check the robot's localization, then send the goal again.",
    "start_blocked": "Move the robot into the open, then send the goal again.",
    "no_planner": "Start the robot's program, or look at the planner's health.",
    "nobody_listens": "Start the robot's program, or look at the planner's health.",
}


@router.post("/check")
async def check(
    body: GestureCheck | GoalRequest | PlaceGoal, session: LoggedIn, console: CurrentConsole
) -> GoalCheck:
    """Would this goal be accepted? Nothing moves. The answer is drawn in the view."""
    if isinstance(body, GestureCheck):
        goal = await on_floor(body, session, console)
        if goal is None:
            console.scene.preview(body.view, None)  # of the pick before
            return above_horizon()
    else:
        goal, _ = await _meant(body, console)
    checked = await console.checker.check(goal.x, goal.y, goal.yaw)
    if goal.view is not None and console.views.get(goal.view, session) is not None:
        _draw(console, goal.view, checked)
    return checked.check


@router.post("")
async def send(
    body: GoalRequest | PlaceGoal, session: Operator, console: CurrentConsole
) -> GoalSent:
    """Send the robot there, after checking the goal again unless it has only just passed."""
    interrupted = console.link.drive.since()
    goal, name = await _meant(body, console)
    checked = await console.checker.check_before_sending(goal.x, goal.y, goal.yaw)
    what: dict[str, Any] = {"x": goal.x, "y": goal.y, "yaw": goal.yaw}
    if name:
        what["place"] = name
    refusal = _refusal(console, checked, interrupted=interrupted())
    if refusal is not None or checked.topic is None:
        refusal = refusal or ConsoleError(409, checked.check.message, _REMEDIES["nobody_listens"])
        console.audit.record(session, "send goal", refusal.title, **what)
        raise refusal
    console.control.require(session, "send goal", what)
    answer = checked.check
    speed = None
    if answer.length is not None and answer.duration:
        speed = answer.length / answer.duration
    running = goal_under_way(console)
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
    before = goal_under_way(console)
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


def goal_under_way(console: Console) -> str | None:
    """Id of the goal that is followed, for the audit log."""
    goal = console.link.goals.follower.info()
    over = goal is None or goal.phase in ("arrived", "failed", "canceled")
    return None if goal is None or over else goal.id


async def _meant(body: GoalRequest | PlaceGoal, console: Console) -> tuple[GoalRequest, str]:
    """The goal, and the name of the place that it is; empty when it is a point only."""
    if isinstance(body, GoalRequest):
        return body, ""
    place = await place_to_go(console, body.place, body.version)
    pose = place.pose
    return GoalRequest(x=pose.x, y=pose.y, yaw=pose.yaw, view=body.view), place.name


def _draw(console: Console, view_id: str, checked: Checked) -> None:
    console.scene.preview(view_id, preview_of(checked))


def preview_of(checked: Checked) -> Preview:
    """Where the robot would go and by which way; of a refused goal, the place itself and the
    nearest one where it could."""
    answer = checked.check
    if answer.ok:
        return Preview(GoalMark(answer.x, answer.y, answer.yaw, active=False), checked.preview)
    nearest = answer.nearest
    mark = None if nearest is None else GoalMark(nearest.x, nearest.y, answer.yaw, active=False)
    return Preview(mark, refused=(answer.x, answer.y))


def _refusal(console: Console, checked: Checked, *, interrupted: bool) -> ConsoleError | None:
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
    if interrupted:
        return ConsoleError(
            409,
            "STOP was pressed, or the wheel taken, after this goal was asked for.",
            "Send it again if it is still wanted.",
        )
    return None
