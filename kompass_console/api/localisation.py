"""Where the robot is, as a person says: looked at beforehand, then told to its localiser."""

from __future__ import annotations

from fastapi import APIRouter
from starlette.concurrency import run_in_threadpool

from kompass_console.api.access import CurrentConsole, Operator
from kompass_console.api.gesture import on_floor
from kompass_console.api.goals import goal_under_way
from kompass_console.link.goal_check import look_at_map
from kompass_console.link.initial_pose import TOPIC
from kompass_console.link.localisation import LOST, Fit
from kompass_console.scene.layers.preview import Preview
from kompass_console.scene.layers.scan import scan_points
from kompass_console.schema.models import (
    GoalRequest,
    LocalisationProblem,
    LocateCheck,
    LocateFit,
    LocateGesture,
    LocateRequest,
    RobotPose,
)
from kompass_console.schema.world import GoalMark, Pose
from kompass_console.web.console import Console
from kompass_console.web.errors import ConsoleError

router = APIRouter(prefix="/api/localisation", tags=["localisation"])

_MOVES = (0.02, 0.05)  # m/s, rad/s
_BETTER = 0.05  # of the agreement; so much another place nearby must gain to be offered
_UNCOMPARED: dict[LocalisationProblem, str] = {
    "no_map": "There is no map to compare the scan with.",
    "no_scan": "There is no laser scan to compare with the map.",
    "no_pose": "The robot does not say where it is.",
    "too_little": "Too little of what the robot sees is on the map to compare them.",
}
_LITTLE = "That is little: the robot is elsewhere, or looks another way. Press again, nearer to it."
_NOT_THERE = {
    "no_map": ("There is no map yet, so there are no places.", "Load a map first."),
    "outside_map": ("This place is outside the map.", "Choose one on the map."),
    "occupied": ("This place is inside an obstacle of the map.", "Choose one that is free."),
}


@router.post("/check")
async def check_pose(
    body: LocateGesture | LocateRequest, session: Operator, console: CurrentConsole
) -> LocateCheck:
    """How well would scan and map agree there? The scan is drawn so; the robot is told nothing."""
    asked: GoalRequest | LocateRequest | None
    if isinstance(body, LocateGesture):
        asked = await on_floor(body, session, console)
        if asked is None:
            console.scene.preview(body.view, None)  # of the pick before
            return LocateCheck(ok=False, message="This is above the horizon; press on the floor.")
    else:
        asked = body
    pose = Pose(asked.x, asked.y, _heading(console) if asked.yaw is None else asked.yaw)
    wrong = _NOT_THERE.get(look_at_map(console.world, pose.x, pose.y))
    found = await run_in_threadpool(
        console.localisation.fit, pose, search=body.search and wrong is None
    )
    here = best = None
    note = ""
    if isinstance(found, tuple):
        here, best = found
        if best is not None and (best.agreement or 0.0) < max(
            LOST, (here.agreement or 0.0) + _BETTER
        ):
            best = None
        note = _note((best or here).agreement)
    else:
        note = _UNCOMPARED[found]
    if asked.view is not None and console.views.get(asked.view, session) is not None:
        console.scene.preview(asked.view, _drawn(pose, best or here, free=wrong is None))
    return LocateCheck(
        ok=wrong is None,
        message="" if wrong is None else " ".join(wrong),
        here=_said(here) or LocateFit(x=pose.x, y=pose.y, yaw=pose.yaw, agreement=None),
        best=_said(best),
        note=note,
    )


@router.post("", status_code=202)
async def set_pose(body: RobotPose, session: Operator, console: CurrentConsole) -> None:
    """Tell the robot's localiser that the robot is there; watch the state for what comes of it."""
    motion = console.world.motion.get()
    before = None if motion is None else [round(each, 3) for each in motion.value.pose]
    refusal = _refusal(console, body)
    if refusal is None:
        told = {"x": body.x, "y": body.y, "yaw": body.yaw}
        console.control.require(session, "locate robot", told)
    outcome = "told" if refusal is None else refusal.title
    console.audit.record(
        session, "locate robot", outcome, x=body.x, y=body.y, yaw=body.yaw, before=before
    )
    if refusal is not None:
        raise refusal
    console.link.initial_pose.send(body.x, body.y, body.yaw)


def _note(agreement: float | None) -> str:
    if agreement is None:
        return _UNCOMPARED["too_little"]
    return _LITTLE if agreement < LOST else ""


def _refusal(console: Console, place: RobotPose) -> ConsoleError | None:
    wrong = _NOT_THERE.get(look_at_map(console.world, place.x, place.y))
    if wrong is not None:
        return ConsoleError(409, *wrong)
    drive, motion = console.link.drive.info(), console.world.motion.get()
    # Who is told another place on the way turns for it at once.
    if goal_under_way(console) is not None:
        return ConsoleError(
            409, "The robot is on its way to a goal.", "Cancel the goal, then set its place."
        )
    if drive is not None and drive.driven_by:
        return ConsoleError(
            409,
            f"{drive.driven_by} drives by hand.",
            "Set its place when the wheel has been given up.",
        )
    if motion is not None and (abs(motion.value.v) > _MOVES[0] or abs(motion.value.w) > _MOVES[1]):
        return ConsoleError(409, "The robot moves.", "Set its place when it stands.")
    if not console.link.initial_pose.listened:
        return ConsoleError(
            409,
            f"Nobody listens on {TOPIC}, so nobody would be told.",
            "Start the robot's localiser, or remap what it listens to.",
        )
    return None


def _heading(console: Console) -> float:
    """As the robot thinks, where a person has said nothing of it."""
    motion = console.world.motion.get()
    return 0.0 if motion is None else motion.value.pose.yaw


def _drawn(pose: Pose, fit: Fit | None, *, free: bool) -> Preview:
    mark = GoalMark(*(pose if fit is None else fit.robot), active=False) if free else None
    refused = None if free else (pose.x, pose.y)
    if fit is None:
        return Preview(mark, refused=refused)
    return Preview(mark, scan=scan_points(fit.scan, fit.sensor), refused=refused)


def _said(fit: Fit | None) -> LocateFit | None:
    if fit is None:
        return None
    return LocateFit(x=fit.robot.x, y=fit.robot.y, yaw=fit.robot.yaw, agreement=fit.agreement)
