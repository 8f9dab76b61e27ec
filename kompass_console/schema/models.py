"""The contract between the console and its page; `web/` is typed against the schema of these."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from kompass.algorithms.planning.failure import Reason
from kompass.missions.run import Phase
from kompass_console.schema.control_models import ControlInfo
from kompass_console.schema.look_models import MOST_EXTRAS, CameraInfo, ExtraInfo, TopicName
from kompass_console.schema.plain import plain
from kompass_console.schema.roles import Role

Theme = Literal["light", "dark"]
Fraction = Annotated[float, Field(ge=0.0, le=1.0)]
OnPicture = Annotated[tuple[Fraction, Fraction], Field(strict=False)]  # a list in JSON
Metres = Annotated[float, Field(allow_inf_nan=False, ge=-1e6, le=1e6)]
_LONGEST_REASON = 200  # characters
Radians = Annotated[float, Field(allow_inf_nan=False, ge=-100.0, le=100.0)]


class In(BaseModel):
    """Body of a request: unknown names are errors, and so are numbers that are not finite, and
    what is of another type: ``true`` is no 1, and ``"1"`` is none."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


class ErrorDetail(BaseModel):
    """What went wrong and why, and what to do; each one sentence."""

    title: str
    remedy: str


class ErrorAnswer(BaseModel):
    """Body of every answer that is not a success."""

    detail: ErrorDetail


class Login(In):
    """A role's token, and the name to show for who uses it; or the name of an account and its
    password."""

    token: str | None = Field(default=None, max_length=400)
    user: str | None = Field(default=None, max_length=400)
    password: str | None = Field(default=None, max_length=400)

    @model_validator(mode="after")
    def _one_proof(self) -> Self:
        if (self.token is None) == (self.password is None):
            raise ValueError("give a token, or a user and a password")
        if self.password is not None and not self.user:
            raise ValueError("give the user whose password it is")
        return self


class LoginWays(BaseModel):
    """How one may log in here: by name and password, by a token."""

    accounts: bool
    tokens: bool


class SessionInfo(BaseModel):
    """Who is logged in; `account` says whether by name and password, `key` which log-in it is."""

    user: str
    key: str
    role: Role
    account: bool = False


class Layers(BaseModel):
    """Which layers of the scene are drawn."""

    model_config = ConfigDict(extra="forbid")

    map: bool = True
    local_map: bool = True
    path: bool = True
    scan: bool = True
    robot: bool = True
    goal: bool = True
    trail: bool = True
    places: bool = True
    zones: bool = True


class LayersPatch(In):
    """Layers to switch; those left out stay as they are."""

    map: bool | None = None
    local_map: bool | None = None
    path: bool | None = None
    scan: bool | None = None
    robot: bool | None = None
    goal: bool | None = None
    trail: bool | None = None
    places: bool | None = None
    zones: bool | None = None


class View(BaseModel):
    """One page's scene and how it is shown; `extras` are the further topics that are drawn."""

    id: str
    follow: bool = False
    top: bool = False
    layers: Layers = Field(default_factory=Layers)
    extras: list[TopicName] = Field(default_factory=list)
    theme: Theme = "light"


class ViewPatch(In):
    """Settings of a view to change; those left out stay as they are."""

    follow: bool | None = None
    top: bool | None = None
    layers: LayersPatch | None = None
    extras: Annotated[list[TopicName], Field(max_length=MOST_EXTRAS)] | None = None
    theme: Theme | None = None


class PointXY(BaseModel):
    """A point of the floor in the map frame, m."""

    x: float
    y: float


class GestureCheck(In):
    """A press-drag-release on a view: fractions of the scene's width and height, from the top
    left. Without `end` it is a tap, and the goal has no heading."""

    view: str
    start: OnPicture
    end: OnPicture | None = None


class GoalRequest(In):
    """A goal in the map frame, m and rad. `view` is the one to draw the preview in."""

    x: Metres
    y: Metres
    yaw: Radians | None = None
    view: str | None = None


class PlaceGoal(In):
    """A place to go to, of the version that was looked at."""

    place: Annotated[int, Field(ge=1, le=2**53)]
    version: Annotated[int, Field(ge=1, le=2**53)]
    view: str | None = None


GoalReason = Literal[
    Reason,
    "above_horizon",
    "no_planner",
    "nobody_listens",
]


class GoalCheck(BaseModel):
    """Whether the robot can go there, how far (m), how long (s) and by which way (x, y, x, y, … in
    m), or why not and the nearest point where it could."""

    ok: bool
    x: float
    y: float
    yaw: float | None
    reason: GoalReason
    message: str
    nearest: PointXY | None = None
    length: float | None = None
    duration: float | None = None
    way: list[float] = Field(default_factory=list)
    heading_used: bool = False
    note: str = ""


class GoalSent(BaseModel):
    """A goal that was published, and on which topic."""

    id: str
    topic: Literal["/goal_pose", "/clicked_point"]
    heading_used: bool
    note: str = ""


class LocateGesture(GestureCheck):
    """A press-drag-release on a view that says where the robot is. Without `end` its heading
    stays. `search` asks for the best place nearby, too."""

    search: bool = True


class LocateRequest(In):
    """Where the robot is, in the map frame, m and rad; without `yaw` its heading stays. `view` is
    the one to draw the scan in, `search` as in LocateGesture."""

    x: Metres
    y: Metres
    yaw: Radians | None = None
    view: str | None = None
    search: bool = True


class RobotPose(In):
    """Where the robot is to believe that it is, in the map frame, m and rad."""

    x: Metres
    y: Metres
    yaw: Radians


class LocateFit(BaseModel):
    """A place (m, rad) and how well scan and map agree there, from 0 to 1; null where too little
    is known."""

    x: float
    y: float
    yaw: float
    agreement: float | None


class LocateCheck(BaseModel):
    """Whether the robot can be told that it is there, or why not.

    `best` is the place nearby where scan and map agree best, where that is clearly better; `note`
    says why nothing can be compared, or what must be done before.
    """

    ok: bool
    message: str
    here: LocateFit | None = None
    best: LocateFit | None = None
    note: str = ""


def cut_reason(text: str) -> str:
    """A reason for STOP, cut where it is too long: that is none not to stop."""
    return plain(text, _LONGEST_REASON)


class StopRequest(In):
    """Why STOP was pressed; may be empty."""

    reason: Annotated[str, AfterValidator(cut_reason)] = ""


class StopAnswer(BaseModel):
    """What the drive manager answered. Standstill is not promised here: watch `State.drive`."""

    accepted: bool
    message: str


class StopSeen(BaseModel):
    """What the drive manager says of STOP: whether it is latched, and whether the robot stands."""

    stopped: bool
    standstill: bool


class OpenStop(BaseModel):
    """STOP for those who are not logged in: whether there is one here, and what became of it.

    `seen` is None while the drive manager is silent. Whether a robot moves that nobody has stopped
    is not told.
    """

    offered: bool
    seen: StopSeen | None


class RobotInfo(BaseModel):
    """The robot's name and the radius (m) of the circle around its footprint.

    `problem` says what of its own description is not drawn, and why; empty when all of it is.
    """

    name: str
    radius: float | None
    problem: str = ""


class PoseInfo(BaseModel):
    """Measured pose in the map frame (m, rad) and twist (m/s, rad/s), with its age in s."""

    x: float
    y: float
    yaw: float
    v: float
    w: float
    age: float


StreamKey = Literal["odometry", "scan", "map", "local_map", "path"]


class StreamInfo(BaseModel):
    """One thing the console reads: from which topic, how old, and whether that is too old.

    `rate` is how many messages came a second (Hz), over the last two seconds; null while unknown,
    and for what is sent once and kept.
    """

    key: StreamKey
    label: str
    topic: str | None
    age: float | None
    deadline: float | None
    stale: bool
    rate: float | None = None


ComponentState = Literal[
    "healthy",
    "algorithm_failure",
    "component_failure",
    "system_failure",
    "general_failure",
    "silent",
]


ProcessPhase = Literal["starting", "active", "busy", "stuck", "dead", "given up", "unknown"]


class ProcessInfo(BaseModel):
    """The process of a component, as its supervisor sees it. `reason` is of its last death.

    `restarted` is how long ago (s) it was started again the last time; null when it was not while
    this console has looked. `cpu` is its share of one processor over the last two seconds, `memory`
    what it has in the machine's memory (bytes), with what it shares; null while unknown.
    """

    name: str
    state: ProcessPhase
    pid: int
    restarts: int
    reason: str
    restarted: float | None = None
    cpu: float | None = None
    memory: int | None = None


class InputInfo(BaseModel):
    """A topic that a component listens to and the console too, its age in s and its rate in Hz."""

    topic: str
    age: float | None
    stale: bool
    rate: float | None = None


class ComponentInfo(BaseModel):
    """Health of one component as it says itself, or `silent` when it has stopped saying.

    `sources` are all of whom it complains, by kind in `src_*`. `process` is null where nobody
    supervises it; `inputs` are those of its topics whose age the console knows, `outputs` the
    topics that it publishes and another component or the console reads.
    """

    name: str
    label: str
    status: ComponentState
    message: str
    sources: list[str]
    src_topics: list[str] = Field(default_factory=list)
    src_components: list[str] = Field(default_factory=list)
    src_algorithms: list[str] = Field(default_factory=list)
    process: ProcessInfo | None = None
    inputs: list[InputInfo] = Field(default_factory=list)
    outputs: list[str] = Field(default_factory=list)
    age: float
    topic: str


class DriveInfo(BaseModel):
    """The last gate before the wheels: STOP, measured standstill, and what limits the speed.

    `driven_by` is who drives by hand, and empty when nobody does.
    """

    available: bool
    stopped: bool
    standstill: bool
    stopped_by: str
    reason: str
    limited_by: str
    driven_by: str
    speed_factor: float
    age: float


GoalPhase = Literal["sent", "accepted", "driving", "arrived", "failed", "canceled"]


class GoalInfo(BaseModel):
    """The goal being followed: distance left (m), time left (s), miss at arrival (m).

    `elapsed` is from its beginning to now, or to its end; `ended` is how long ago (s) that was.
    `hindrance` says what is in the way of a goal under way; empty where nothing is.
    """

    id: str
    phase: GoalPhase
    x: float
    y: float
    yaw: float | None
    sent_by: str
    message: str
    distance_left: float | None
    eta: float | None
    error: float | None
    elapsed: float
    ended: float | None = None
    hindrance: str = ""


LocalisationProblem = Literal["no_map", "no_scan", "no_pose", "too_little"]


class LocalisationInfo(BaseModel):
    """How well the newest scan fits the map where the robot thinks it is, from 0 to 1.

    `agreement` is null where that cannot be said, and `problem` says why; `age` (s) is the scan's.
    `lost` is whether it has been bad for some seconds.
    """

    agreement: float | None = None
    lost: bool = False
    problem: LocalisationProblem | None = None
    age: float | None = None


class SimulationInfo(BaseModel):
    """Simulated seconds per real second."""

    rate: float
    age: float


class BatteryInfo(BaseModel):
    """The robot's battery. `charge` is from 0 to 1; `low` below a fifth, until it is a quarter
    again; `voltage` (V) is null where it is not told."""

    charge: float
    charging: bool
    low: bool
    voltage: float | None
    topic: str
    age: float


class RulesInfo(BaseModel):
    """The table of rules in force, for the top bar.

    `available` is false when its monitor is silent or there is none; the numbers are its last
    ones then. `probation_left` (s) is 0 when nothing is on probation; `alarms` counts those that
    rules have raised and nobody has put away.
    """

    available: bool = False
    revision: int = 0
    confirmed: int = 0
    probation_left: float = 0.0
    notice: str = ""
    alarms: int = 0
    age: float | None = None


class PlacesInfo(BaseModel):
    """Changes whenever the list of places does, or the map that the robot has."""

    available: bool = False
    revision: int = 0
    map: str | None = None


class ZonesInfo(BaseModel):
    """Changes whenever the list of zones does; `masks` with the masks of the recipe."""

    available: bool = False
    revision: int = 0
    masks: int = 0


class TimelineInfo(BaseModel):
    """Changes whenever the timeline does; `newest` is the number of its newest entry."""

    available: bool = False
    newest: int = 0
    changes: int = 0


class MissionRunInfo(BaseModel):
    """The mission that runs or ran last.

    `waypoint` counts from 1 to `waypoints`, `round` from 1 to `rounds` (0: without end). `place` is
    where it goes or is; empty when that was deleted. `task` is what is done there now, `ask` what a
    person is to confirm, `left` how long a wait still lasts (s). `elapsed` is the time (s) since
    the phase began; `step` counts the phases, and goes with what a person decides about one.
    `reason` is why it is paused or over, `decided_by` who wanted that.
    """

    number: int
    mission: int
    name: str
    by: str
    phase: Phase
    step: int
    elapsed: float
    round: int
    rounds: int
    waypoint: int
    waypoints: int
    attempt: int
    place: str
    task: str
    ask: str
    left: float | None
    reason: str
    decided_by: str
    skipped: list[str] = Field(default_factory=list)


class QueuedMission(BaseModel):
    """A mission that waits for its turn."""

    number: int
    name: str
    by: str


class MissionsInfo(BaseModel):
    """What runs, and what waits. `revision` changes whenever the list of missions does. `notice`
    is what an operator must hear; empty when all is well."""

    available: bool = False
    revision: int = 0
    notice: str = ""
    run: MissionRunInfo | None = None
    queue: list[QueuedMission] = Field(default_factory=list)


class RosInfo(BaseModel):
    """Where on DDS the console listens."""

    domain_id: int
    middleware: str


class LogInfo(BaseModel):
    """The robot's log: whether anybody writes to it, and the numbers of its newest line and of its
    newest warning or error."""

    available: bool = False
    newest: int = 0
    newest_warning: int = 0


class State(BaseModel):
    """Everything the page shows in numbers and words, at one moment (`time`, epoch s).

    `audit_problem` says why the audit log is not written, or what of it is missing; else empty.
    `webhook_problem` says which webhooks take no notices, and why.
    """

    type: Literal["state"] = "state"
    seq: int
    time: float
    robot: RobotInfo
    pose: PoseInfo | None
    localisation: LocalisationInfo
    streams: list[StreamInfo]
    components: list[ComponentInfo]
    drive: DriveInfo | None
    goal: GoalInfo | None
    simulation: SimulationInfo | None
    battery: BatteryInfo | None = None
    rules: RulesInfo
    places: PlacesInfo
    zones: ZonesInfo
    timeline: TimelineInfo
    missions: MissionsInfo
    log: LogInfo
    extras: list[ExtraInfo] = Field(default_factory=list)
    cameras: list[CameraInfo] = Field(default_factory=list)
    processes: list[ProcessInfo]
    ros: RosInfo
    viewers: int
    control: ControlInfo = ControlInfo()
    audit_problem: str = ""
    webhook_problem: str = ""


class Hello(BaseModel):
    """First message of the state websocket."""

    type: Literal["hello"] = "hello"
    session: SessionInfo
    version: str


class Ping(In):
    """What the page may send on the state websocket; answered by Pong with the same `t`."""

    type: Literal["ping"] = "ping"
    t: float


class Pong(BaseModel):
    """Answer to Ping."""

    type: Literal["pong"] = "pong"
    t: float


class StateMessage(BaseModel):
    """Any message the server sends on `/api/state`."""

    message: Annotated[Hello | State | Pong, Field(discriminator="type")]
