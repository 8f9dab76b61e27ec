"""The contract of the routes of drills; what is said of a drive is in :mod:`kompass.drills`."""

from __future__ import annotations

from typing import Annotated, Literal, Self, TypeAlias

from pydantic import BaseModel, Field, model_validator
from pydantic_core import PydanticCustomError

from kompass.drills.compare import Verdict
from kompass.drills.drive import DriveResult, Outcome
from kompass.drills.scenario import Scenario, ScheduledFault
from kompass.rules.schema.table import Table
from kompass_console.schema.models import In

MOST_DRIVES = 200
DrillState: TypeAlias = Literal["running", "done", "failed", "canceled"]


class DrillOptions(In):
    """Which drives to make under the proposed table and under the one in force.

    `faults` are names as after `--faults`: `all`, a kind such as `kill` for each of the recipe's
    components, or one with its parameter. `world` null is the one in which the embedded robot
    drives now, else the first there is. `drives` are made under each of the two tables, and
    `faults_per_drive` of the faults break in each; a share `lasting` of them never ends.

    `scenario` is one of the person's own instead, as in a file of scenarios: it is driven so many
    times, with other noise each time, and says itself what breaks where.
    """

    faults: list[Annotated[str, Field(min_length=1, max_length=100)]] = Field(
        default_factory=lambda: ["all"], min_length=1, max_length=100
    )
    world: Annotated[str, Field(max_length=100)] | None = None
    faults_per_drive: Annotated[int, Field(ge=1, le=3)] = 1
    lasting: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    scenario: Scenario | None = None
    drives: Annotated[int, Field(ge=1, le=MOST_DRIVES)] = 20
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 1

    @model_validator(mode="after")
    def _drawn_or_own(self) -> Self:
        given = self.model_fields_set & {"faults", "world", "faults_per_drive", "lasting"}
        if self.scenario is not None and given:
            raise PydanticCustomError(
                "drawn_and_own",
                "{given} is of drawn drives, and scenario says it itself; leave one of them out",
                {"given": min(given)},
            )
        # Its drives are asked for by name, in addresses, where these two mean another place.
        if self.scenario is not None and self.scenario.name in (".", ".."):
            raise PydanticCustomError(
                "scenario_address",
                "scenario.name: {name} is no name of a drive; give letters and digits",
                {"name": self.scenario.name},
            )
        return self


class DrillRequest(DrillOptions):
    """A table to try against the one in force, and in which drives."""

    table: Table


class DrillStarted(BaseModel):
    """A drill runs; ask for it by its id."""

    id: str


class DrillFault(BaseModel):
    """A kind of fault, and what it does.

    `parameter` is what has to stand behind a colon, in capitals, as `NAME` of a process; empty for
    a fault that takes none. `example` is one that can be read, `choices` are all that can, where
    neither recipe nor world decides. What is `at_once` is over as it begins.
    """

    name: str
    text: str
    parameter: str
    example: str
    choices: list[str]
    at_once: bool


class DrillWorld(BaseModel):
    """A world of the embedded robot."""

    name: str
    title: str


class DrillDrive(BaseModel):
    """What came of a scenario under the two tables, in a line.

    `change` is of the proposed table against the one in force; `text` says how they differ, or,
    where they do not, what became of the robot. `why` is the end under the proposed table in a
    sentence: which rule stopped the robot, why it gave up.
    """

    name: str
    world: str
    faults: list[ScheduledFault]
    change: Literal["worse", "better", "other", "same"]
    text: str
    why: str
    proposed: Outcome
    in_force: Outcome


class DrillSummary(BaseModel):
    """What a drill comes to. `drives` are those that differ, the worse ones first, then the rest.

    `chance` is empty where there is no difference that chance could make; `notes` are sentences
    that one must know to judge it.
    """

    sentence: str
    chance: str
    notes: list[str]
    verdict: Verdict
    recipe: str
    proposed: str
    in_force: str
    drives: list[DrillDrive]


class DrillWish(BaseModel):
    """What was asked for: `faults` as they were named, in which world, how many under each table.

    `scenario` is the name of a person's own; null for drives that are drawn.
    """

    faults: list[str]
    world: str
    drives: int
    scenario: str | None


class DrillProgress(BaseModel):
    """How far a drill is, and what it came to or why it did not.

    `done` and `total` count drives under both tables together; `elapsed` and `left` are seconds,
    the latter from what the drives took so far, null before enough of them are
    over. `revision` is the
    one in force with which it compares; `by` who asked for it.
    """

    id: str
    state: DrillState
    by: str
    revision: int
    done: int
    total: int
    elapsed: float
    left: float | None
    error: str | None
    wish: DrillWish
    report: DrillSummary | None


class DrillRoom(BaseModel):
    """Whether there are drills here, of what, and the newest.

    `refusal` is null when there are; else why not, with the remedy. `own_world` is null when the
    robot at hand is not the embedded one. `robot` is the name of the embedded one that drives.
    """

    refusal: str | None
    remedy: str
    recipe: str
    own_world: str | None
    robot: str
    worlds: list[DrillWorld]
    faults: list[DrillFault]
    most_drives: int
    newest: DrillProgress | None


class DrillWall(BaseModel):
    """What stands somewhere (m, rad, frame `map`): a box, or a cylinder of diameter `length`."""

    x: float
    y: float
    yaw: float
    length: float
    width: float
    round: bool


class DrillPlace(BaseModel):
    """A world from above: corners of its floor, all that is solid, and its doorways by name.

    `bounds` are min x, min y, max x, max y (m), `start` is where its robot starts: x, y, yaw.
    """

    name: str
    title: str
    bounds: tuple[float, float, float, float]
    start: tuple[float, float, float]
    floor: list[tuple[float, float]]
    walls: list[DrillWall]
    doorways: list[str]


class RecordedScenario(BaseModel):
    """A scenario made of a recording, what is in it in words, and what was not carried over."""

    scenario: Scenario
    sentence: str
    remarks: list[str]


class DrillPair(BaseModel):
    """A scenario's drives under both tables, and where they were."""

    place: DrillPlace
    proposed: DriveResult
    in_force: DriveResult


class PlayedDrive(In):
    """A scenario of a drill to be shown in a view: from which second of it, and how many seconds
    of it pass in one. At `speed` 0 it stands still."""

    drill: Annotated[str, Field(max_length=100)]
    scenario: Annotated[str, Field(max_length=100)]
    moment: Annotated[float, Field(ge=0.0, le=1e6)] = 0.0
    speed: Annotated[float, Field(ge=0.0, le=100.0)] = 0.0
