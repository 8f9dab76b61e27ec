"""A scenario: one drive as it is to be, in which world, where to, and what goes wrong when.

All times are seconds since the drive's start, lengths metres, angles radians, in the frame ``map``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from kompass.rules.schema.model import Model
from kompass.simulation.faults.fault_names import (
    AT_ONCE,
    MAP_WITHHELD,
    UnknownFault,
    check_camera,
    check_fault,
    check_place,
)
from kompass.simulation.physics.robot_model import robot_model, robot_names
from kompass.simulation.worlds.registry import world, world_names

LONGEST = 3600.0  # s that a drive may last
BODY_CLEARANCE = 0.05  # m between the robot's body and anything solid where it begins
_FAR = 1000.0  # m; beyond it no world of ours has anything


def _said(field: str, text: str) -> PydanticCustomError:
    """What is wrong with a field, from a check that looks at several."""
    return PydanticCustomError("scenario", "{text}", {"text": text, "field": field})


def _named(name: str) -> str:
    if not name.strip() or not name.isprintable() or name != name.strip():
        raise PydanticCustomError(
            "scenario_name", "no name to be printed in one line; give letters and digits"
        )
    return name


def _topic(name: str) -> str:
    if not re.fullmatch(r"/[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*", name):
        raise PydanticCustomError(
            "scenario_topic", "no full name of a topic; write for example /clicked_point"
        )
    return name


def _one_of(names: Callable[[], Iterable[str]], kind: str) -> Callable[[str], str]:
    """Checks a name against those that there are when it is read."""

    def check(name: str) -> str:
        known = tuple(names())
        if name not in known:
            raise PydanticCustomError(
                "scenario_unknown",
                "there is no such {kind}; choose one of: {known}",
                {"kind": kind, "known": ", ".join(known)},
            )
        return name

    return check


def _known_fault(name: str) -> str:
    try:
        return check_fault(name)
    except UnknownFault as error:
        raise PydanticCustomError("scenario_fault", "{text}", {"text": str(error)}) from None


# Strict: a number in quotation marks, or yes for 1, is a slip of the pen.
Metres = Annotated[float, Field(strict=True, ge=-_FAR, le=_FAR)]
Length = Annotated[float, Field(strict=True, gt=0.0, le=_FAR)]
Radians = Annotated[float, Field(strict=True, ge=-math.tau, le=math.tau)]
Moment = Annotated[float, Field(strict=True, ge=0.0, le=LONGEST)]
Name = Annotated[str, Field(min_length=1, max_length=100), AfterValidator(_named)]
RobotName = Annotated[str, AfterValidator(_one_of(robot_names, "robot"))]
USUAL_ROBOT = robot_names()[0]


class Start(Model):
    """Where the robot stands at first."""

    x: Metres
    y: Metres
    yaw: Radians = 0.0


class Goal(Model):
    """Where the robot is to go.

    Attributes
    ----------
    yaw
        Heading to arrive with; None for any.
    tolerance, heading_tolerance
        How near is there [m], [rad]; None for what the planner is set to.
    at
        When it is sent, whatever became of the goal before; None for as soon as that one has ended.
    topic
        Where it is published, as a click on the map is (``/clicked_point``); None for the planner's
        own way: its action, or else the topic that it takes goals from.
    """

    x: Metres
    y: Metres
    yaw: Radians | None = None
    topic: Annotated[str, AfterValidator(_topic)] | None = None
    tolerance: Annotated[float, Field(strict=True, gt=0.0, le=5.0)] | None = None
    heading_tolerance: Annotated[float, Field(strict=True, gt=0.0, le=math.pi)] | None = None
    at: Moment | None = None


class ScheduledFault(Model):
    """Something that breaks.

    Attributes
    ----------
    name
        A fault of the embedded robot, as after ``--fault``.
    at
        When it begins.
    duration
        Seconds after which it ends by itself; 0 for never.
    """

    name: Annotated[str, AfterValidator(_known_fault)]
    at: Moment
    duration: Moment = 0.0


class OperatorAct(Model):
    """What a person at the console does.

    Attributes
    ----------
    does
        ``stop`` presses STOP, ``release`` releases it.
    by
        Who.
    """

    at: Moment
    does: Literal["stop", "release"]
    by: Name = "operator"
    reason: str = ""


class Scenario(Model):
    """One drive as it is to be.

    Attributes
    ----------
    name
        What reports call it, and what pairs the drives of two tables.
    world
        Of the embedded robot.
    robot
        Which embedded robot drives, as after ``run --sim --robot``.
    seed
        Of all that is random in the drive: noise of sensors, delays of messages.
    start
        None for where the world has the robot start.
    limit
        When the drive ends at the latest.
    """

    name: Name
    world: Annotated[str, AfterValidator(_one_of(world_names, "world"))]
    robot: RobotName = USUAL_ROBOT
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**63)] = 0
    start: Start | None = None
    goals: Annotated[tuple[Goal, ...], Field(min_length=1, max_length=100)]
    faults: Annotated[tuple[ScheduledFault, ...], Field(max_length=100)] = ()
    operators: Annotated[tuple[OperatorAct, ...], Field(max_length=100)] = ()
    limit: Annotated[float, Field(strict=True, gt=0.0, le=LONGEST)] = 120.0

    @property
    def first_pose(self) -> tuple[float, float, float]:
        """Where the robot stands at first: x, y [m], yaw [rad]."""
        if self.start is None:
            return world(self.world).start
        return self.start.x, self.start.y, self.start.yaw

    @model_validator(mode="after")
    def _can_be_carried_out(self) -> Self:
        self._check_start()
        self._check_goals()
        self._check_faults()
        for field in ("goals", "faults", "operators"):
            for index, each in enumerate(getattr(self, field)):
                if each.at is not None and each.at >= self.limit:
                    raise _said(
                        f"{field}[{index}].at",
                        f"the drive is over at {self.limit:g} s (limit); give an earlier time, or "
                        "raise the limit",
                    )
        return self

    def _check_start(self) -> None:
        if self.start is None and self.robot == USUAL_ROBOT:
            return  # a world has room for it where it starts
        place, kind = world(self.world), robot_model(self.robot)
        x, y, yaw = pose = self.first_pose
        if not place.on_floor(np.array([[x, y]]))[0]:
            raise _said("start", f"that is off the floor of the {place.name}; move it")
        middle = [[x + kind.middle * math.cos(yaw), y + kind.middle * math.sin(yaw)]]
        points = np.concatenate([middle, kind.outline(pose)]) if kind.box else np.array(middle)
        required = BODY_CLEARANCE + (0.0 if kind.box else kind.radius)
        clearance = float(place.distance(points).min())
        if clearance < required:
            who = "a side of its body" if kind.box else "it"
            raise _said(
                "start",
                f"that is {max(clearance, 0.0):.2f} m from something solid; keep {who} "
                f"{required:g} m away"
                + ("" if self.start else f": the {place.name} has no room for {kind.name} there"),
            )

    def _check_goals(self) -> None:
        latest = 0.0
        for index, goal in enumerate(self.goals):
            if goal.heading_tolerance is not None and goal.yaw is None:
                raise _said(
                    f"goals[{index}].heading_tolerance",
                    "the goal asks for no heading; give its yaw, or leave this out",
                )
            if goal.at is None:
                continue
            if goal.at < latest:
                raise _said(
                    f"goals[{index}].at",
                    f"a goal before it in the list comes later ({latest:g} s); list goals in the "
                    "order of their times",
                )
            latest = goal.at

    def _check_faults(self) -> None:
        ends: dict[str, float] = {}
        for index, fault in enumerate(self.faults):
            try:
                check_place(fault.name, world(self.world))
                check_camera(fault.name, robot_model(self.robot))
            except UnknownFault as error:
                raise _said(f"faults[{index}].name", str(error)) from None
        for index, fault in sorted(enumerate(self.faults), key=lambda item: item[1].at):
            where = f"faults[{index}]"
            if fault.name == MAP_WITHHELD and fault.at:
                raise _said(f"{where}.at", "a map that was given cannot be withheld; give 0")
            if fault.name.startswith(AT_ONCE) and fault.duration:
                raise _said(f"{where}.duration", "this fault is over at once; leave it out")
            if fault.at < ends.get(fault.name, -math.inf):
                raise _said(
                    f"{where}.at", f"{fault.name} is on already then; let it end before that"
                )
            forever = fault.duration == 0.0 and not fault.name.startswith(AT_ONCE)
            ends[fault.name] = math.inf if forever else fault.at + fault.duration


def parent_model(steps: tuple[str | int, ...]) -> type[Model] | None:
    """The model that the last step of a way into a scenario is a field of, to offer its fields."""
    names = [step for step in steps[:-1] if isinstance(step, str)]
    models: dict[tuple[str, ...], type[Model]] = {
        (): Scenario,
        ("start",): Start,
        ("goals",): Goal,
        ("faults",): ScheduledFault,
        ("operators",): OperatorAct,
    }
    return models.get(tuple(names))
