"""The robot: its kind of drive, its shape, its limits and its frames."""

import enum
import math
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import (
    AliasChoices,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    model_validator,
)

from kompass.porting import absent_names
from kompass.settings import Settings, ignored_of, notice_once

# Wheels that steer by more than this would drive the robot across itself [rad].
STEEPEST = 1.5
# Who steers by less cannot be told from who cannot steer: the turn is hundreds of bodies wide.
SLIGHTEST = 0.01
# What no robot on the ground has: a slip of units, or of a digit.
LARGEST = 100.0  # m, any measure of its shape
FASTEST = 100.0  # m/s, and rad/s
HARDEST = 1e4  # m/s², and rad/s²
# What hardly one has: it is told, for it is most likely a slip of units.
UNLIKELY_RADIUS = 5.0  # m
UNLIKELY_TURN = 6 * math.pi  # rad/s


class RobotType(enum.StrEnum):
    """How the robot moves."""

    ACKERMANN = "ACKERMANN"
    DIFFERENTIAL_DRIVE = "DIFFERENTIAL_DRIVE"
    OMNI = "OMNI"


class RobotGeometry:
    """Shapes a robot may have, and what follows from their parameters (metres)."""

    class Type(enum.StrEnum):
        """Shape; the parameters of each are in the table below."""

        BOX = "BOX"  # length, width, height
        CYLINDER = "CYLINDER"  # radius, height
        SPHERE = "SPHERE"  # radius
        ELLIPSOID = "ELLIPSOID"  # semi-axes along x, y, z
        CAPSULE = "CAPSULE"  # radius, height of the straight part
        CONE = "CONE"  # radius, height

    PARAMETERS = {  # noqa: RUF012 - a table, never changed
        Type.BOX: ("length", "width", "height"),
        Type.CYLINDER: ("radius", "height"),
        Type.SPHERE: ("radius",),
        Type.ELLIPSOID: ("semi-axis x", "semi-axis y", "semi-axis z"),
        Type.CAPSULE: ("radius", "height"),
        Type.CONE: ("radius", "height"),
    }

    @classmethod
    def check(cls, kind: Type, params: NDArray[np.float64]) -> None:
        """Raise ValueError, naming what is needed, when the parameters do not fit the shape."""
        names = cls.PARAMETERS[kind]
        if params.shape != (len(names),):
            raise ValueError(
                f"geometry_params of a {kind.name} are {len(names)} numbers "
                f"({', '.join(names)}, in metres), not {params.tolist()}; to change the type and "
                "its parameters together, make a new RobotConfig"
            )
        if not np.all((params > 0) & (params <= LARGEST)):
            raise ValueError(
                f"geometry_params must all be greater than 0 and at most {LARGEST:g} m, "
                f"not {params.tolist()}"
            )

    @classmethod
    def get_radius(cls, kind: Type, params: NDArray[np.float64]) -> float:
        """Radius of the circle around the footprint [m]."""
        cls.check(kind, params)
        if kind is cls.Type.BOX:
            return float(math.hypot(params[0], params[1]) / 2)
        if kind is cls.Type.ELLIPSOID:
            return float(max(params[0], params[1]))
        return float(params[0])

    @classmethod
    def get_height(cls, kind: Type, params: NDArray[np.float64]) -> float:
        """Height [m]."""
        cls.check(kind, params)
        if kind is cls.Type.SPHERE:
            return float(2 * params[0])
        if kind is cls.Type.ELLIPSOID:
            return float(2 * params[2])
        if kind is cls.Type.CAPSULE:
            return float(params[1] + 2 * params[0])
        return float(params[-1])

    @classmethod
    def get_footprint(cls, kind: Type, params: NDArray[np.float64]) -> NDArray[np.float64]:
        """Corners of the footprint in the robot's frame, anticlockwise, shape (N, 2) [m]."""
        cls.check(kind, params)
        if kind is cls.Type.BOX:
            x, y = params[0] / 2, params[1] / 2
            return np.array([[x, y], [-x, y], [-x, -y], [x, -y]])
        angles = np.linspace(0, 2 * math.pi, 24, endpoint=False)
        y_axis = params[1] if kind is cls.Type.ELLIPSOID else params[0]
        return np.stack([params[0] * np.cos(angles), y_axis * np.sin(angles)], axis=1)


class _Limits(Settings):
    """What the limits of all axes have in common."""

    # Whoever is given limits takes a copy: a later change of the giver's is none of the taker's.
    model_config = ConfigDict(revalidate_instances="always")

    max_vel: float
    max_acc: float | None
    max_decel: float | None
    min_absolute_val: float

    @model_validator(mode="after")
    def _can_move(self) -> Self:
        if self.max_vel == 0:
            return self
        for name, value in (("max_acc", self.max_acc), ("max_decel", self.max_decel)):
            if value == 0:
                raise ValueError(
                    f"{name} = 0 with max_vel = {self.max_vel:g}: the axis could never "
                    f"{'start' if name == 'max_acc' else 'stop'}; give a {name} above 0, or leave "
                    "it out for half a second between 0 and max_vel"
                )
        if self.min_absolute_val > self.max_vel:
            raise ValueError(
                f"min_absolute_val = {self.min_absolute_val:g} is above max_vel = "
                f"{self.max_vel:g}: no command would be large enough; give a smaller one"
            )
        return self


class LinearCtrlLimits(_Limits):
    """Limits along one axis [m/s, m/s²].

    Raises
    ------
    ValueError
        When a limit is negative, not finite or beyond any robot, when an axis that moves has an
        acceleration of 0, or when no command would reach ``min_absolute_val``.
    """

    max_vel: float = Field(default=0.0, ge=0, le=FASTEST, description="m/s; 0 for no motion")
    max_acc: float | None = Field(
        default=None, ge=0, le=HARDEST, description="m/s²; left out: reaches max_vel in 0.5 s"
    )
    max_decel: float | None = Field(
        default=None, ge=0, le=HARDEST, description="m/s²; left out: stops from max_vel in 0.5 s"
    )
    min_absolute_val: float = Field(
        default=0.01,
        ge=0,
        le=FASTEST,
        validation_alias=AliasChoices("min_absolute_val", "min_vel"),
        description="m/s; what is slower is sent as 0",
    )


class AngularCtrlLimits(_Limits):
    """Limits of rotation [rad/s, rad/s²] and of steering [rad]; see :class:`LinearCtrlLimits`."""

    max_vel: float = Field(
        default=0.0,
        ge=0,
        le=FASTEST,
        validation_alias=AliasChoices("max_vel", "max_omega"),
        description="rad/s; 0 for no rotation",
    )
    max_steer: float = Field(
        default=math.pi,
        ge=0,
        le=math.pi,
        validation_alias=AliasChoices("max_steer", "max_ang"),
        description="rad; of ACKERMANN the largest steering angle, of the wheel that would be "
        "midway between the two; no other robot has one",
    )
    max_acc: float | None = Field(
        default=None, ge=0, le=HARDEST, description="rad/s²; left out: reaches max_vel in 0.5 s"
    )
    max_decel: float | None = Field(
        default=None, ge=0, le=HARDEST, description="rad/s²; left out: stops from max_vel in 0.5 s"
    )
    min_absolute_val: float = Field(
        default=0.01,
        ge=0,
        le=FASTEST,
        validation_alias=AliasChoices("min_absolute_val", "min_omega"),
        description="rad/s; what is slower is sent as 0",
    )


class RobotCtrlLimits(Settings):
    """Limits of all three planar axes."""

    vx_limits: LinearCtrlLimits
    omega_limits: AngularCtrlLimits
    vy_limits: LinearCtrlLimits = Field(default_factory=LinearCtrlLimits)


def _member_of(kind: type[enum.Enum]) -> Any:
    def read(value: Any) -> Any:
        if isinstance(value, kind) or not isinstance(value, str):
            return value
        # Other releases write "Type.CYLINDER".
        name = value.strip().rpartition(".")[2].upper().replace(" ", "_")
        if name not in kind.__members__:
            raise ValueError(f"{value!r} is none of {', '.join(kind.__members__)}")
        return kind[name]

    return BeforeValidator(read)


def _own_numbers(value: ArrayLike) -> NDArray[np.float64]:
    """A copy that nobody can write to: what is checked stays as it was checked."""
    try:
        given = np.array(value)
        numbers = given.astype(np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{value!r} is no list of numbers") from None
    listed = value if isinstance(value, list | tuple) else ()
    if given.dtype.kind in "bUSc" or any(isinstance(one, bool | np.bool_) for one in listed):
        raise ValueError(f"{value!r} is no list of numbers")
    numbers.setflags(write=False)
    return numbers


Vector = Annotated[
    np.ndarray,
    BeforeValidator(_own_numbers),
    PlainSerializer(lambda value: value.tolist(), return_type=list),
]


class RobotConfig(Settings):
    """What the stack must know of the robot; nothing of it is guessed.

    ``base_link`` of an ACKERMANN lies midway between the wheels that are not steered: that is the
    place which moves as a twist says. Its tightest turn has the radius
    ``wheel_base / tan(ctrl_omega_limits.max_steer)``; see :attr:`turning_radius`.

    It is a value: given to a component or a launcher, it is copied, and so is the array of
    ``geometry_params``, which cannot be written to afterwards (assign another). What is refused
    leaves it as it was. ``model_dump_json()`` and ``model_validate_json()`` are each other's
    inverse.

    Raises
    ------
    ValueError
        When something was left out, ``geometry_params`` do not fit ``geometry_type``, a limit
        cannot be meant, the robot could neither drive nor turn, or something is said of it that
        its kind of drive does not have.
    """

    model_config = ConfigDict(revalidate_instances="always")

    model_type: Annotated[RobotType, _member_of(RobotType)]
    geometry_type: Annotated[RobotGeometry.Type, _member_of(RobotGeometry.Type)]
    geometry_params: Vector = Field(description="m; as many as the type has")
    ctrl_vx_limits: LinearCtrlLimits = Field(description="forwards and backwards")
    ctrl_omega_limits: AngularCtrlLimits = Field(description="rotation")
    ctrl_vy_limits: LinearCtrlLimits = Field(
        default_factory=LinearCtrlLimits, description="sideways; none unless stated"
    )
    geometry_offset: float = Field(
        default=0.0,
        ge=-LARGEST,
        le=LARGEST,
        description="m; how far ahead of base_link the middle of the shape lies",
    )
    wheel_base: float | None = Field(
        default=None,
        ge=0.001,
        le=LARGEST,
        description="m; of ACKERMANN, from the axle of base_link to the one that steers. Left out: "
        "the length of the body, which no wheel base exceeds, and so a turn as wide as it may be",
    )

    @model_validator(mode="before")
    @classmethod
    def _is_whole(cls, given: Any) -> Any:
        # Of a name that is none of the robot's the base says which was meant.
        if isinstance(given, dict) and set(given) <= {*cls.model_fields, *ignored_of(cls)}:
            needed = [name for name, field in cls.model_fields.items() if field.is_required()]
            left_out = [name for name in needed if name not in given]
            if left_out:
                raise ValueError(
                    f"{', '.join(left_out)} left out; a robot is described whole: "
                    f"RobotConfig({', '.join(f'{name}=…' for name in needed)})"
                )
        return given

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        RobotGeometry.check(self.geometry_type, self.geometry_params)
        for name, limits, what in (
            ("ctrl_vx_limits", self.ctrl_vx_limits, "drive"),
            ("ctrl_omega_limits", self.ctrl_omega_limits, "turn"),
        ):
            if limits.max_vel == 0:
                raise ValueError(
                    f"{name}.max_vel = 0: the robot could not {what}; give what it can do"
                )
        half = self._length / 2
        if not abs(self.geometry_offset) < half:
            raise ValueError(
                f"geometry_offset = {self.geometry_offset:g} m: base_link would lie outside the "
                f"body; give less than half of its length, {half:g} m"
            )
        self._check_drive()
        self._judge_units()
        return self

    def _judge_units(self) -> None:
        if self.radius > UNLIKELY_RADIUS:
            notice_once(
                f"geometry_params = {self.geometry_params.tolist()}: the robot's radius is "
                f"{self.radius:g} m; they are metres"
            )
        turn = self.ctrl_omega_limits.max_vel
        if turn > UNLIKELY_TURN:
            notice_once(
                f"ctrl_omega_limits.max_vel = {turn:g} rad/s: that is {turn / math.tau:.0f} turns "
                "in a second; it is in radians"
            )

    def _check_drive(self) -> None:
        if self.model_type is RobotType.DIFFERENTIAL_DRIVE and self.ctrl_vy_limits.max_vel > 0:
            raise ValueError(
                f"ctrl_vy_limits.max_vel = {self.ctrl_vy_limits.max_vel:g} m/s: a "
                "DIFFERENTIAL_DRIVE cannot move sideways; leave it out, or say OMNI"
            )
        if self.model_type is not RobotType.ACKERMANN:
            if self.wheel_base is not None:
                raise ValueError(
                    f"wheel_base = {self.wheel_base:g} m: only ACKERMANN has one, and model_type "
                    f"is {self.model_type}; leave it out"
                )
            return
        most = self.ctrl_omega_limits.max_steer
        if not SLIGHTEST <= most <= STEEPEST:
            raise ValueError(
                f"ctrl_omega_limits.max_steer = {most:.2f} rad: how tightly an ACKERMANN can turn "
                f"comes from its largest steering angle; give it, between {SLIGHTEST:g} and "
                f"{STEEPEST:g}"
            )
        if self.wheel_base is not None and self.wheel_base > self._length:
            raise ValueError(
                f"wheel_base = {self.wheel_base:g} m: the body is {self._length:g} m long, and "
                "its wheels are under it; give what lies between its axles"
            )
        if self.ctrl_vy_limits.max_vel > 0:
            raise ValueError(
                f"ctrl_vy_limits.max_vel = {self.ctrl_vy_limits.max_vel:g} m/s: an ACKERMANN "
                "cannot move sideways; leave it out"
            )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, RobotConfig):
            return NotImplemented
        return self.model_dump() == other.model_dump()

    def __copy__(self) -> Self:
        return self.__deepcopy__()

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        copied = super().__deepcopy__(memo)
        copied.geometry_params.setflags(write=False)
        return copied

    @property
    def radius(self) -> float:
        """Radius of the circle around ``base_link`` that holds the footprint [m]."""
        if self.geometry_offset == 0.0:
            return RobotGeometry.get_radius(self.geometry_type, self.geometry_params)
        return float(np.hypot(*self.footprint.T).max())

    @property
    def turning_radius(self) -> float:
        """Radius of the tightest turn that ``base_link`` can drive [m]; 0 turns on the spot."""
        if self.model_type is not RobotType.ACKERMANN:
            return 0.0
        base = self._length if self.wheel_base is None else self.wheel_base
        return base / math.tan(self.ctrl_omega_limits.max_steer)

    @property
    def _length(self) -> float:
        corners = RobotGeometry.get_footprint(self.geometry_type, self.geometry_params)
        return float(np.ptp(corners[:, 0]))

    @property
    def height(self) -> float:
        """Height [m]."""
        return RobotGeometry.get_height(self.geometry_type, self.geometry_params)

    @property
    def footprint(self) -> NDArray[np.float64]:
        """Corners in the robot's frame, anticlockwise, shape (N, 2) [m]."""
        corners = RobotGeometry.get_footprint(self.geometry_type, self.geometry_params)
        corners[:, 0] += self.geometry_offset
        return corners


class RobotFrames(Settings):
    """Names of the coordinate frames. What a message says in its header comes before these."""

    model_config = ConfigDict(revalidate_instances="always")

    robot_base: str = Field(default="base_link", min_length=1)
    odom: str = Field(default="odom", min_length=1)
    world: str = Field(default="map", min_length=1)
    scan: str = Field(default="base_link", min_length=1)
    rgb: str = Field(default="camera_link", min_length=1)
    depth: str = Field(default="camera_depth_link", min_length=1)
    point_cloud: str = Field(default="point_cloud_link", min_length=1)


__all__ = [
    "AngularCtrlLimits",
    "LinearCtrlLimits",
    "RobotConfig",
    "RobotCtrlLimits",
    "RobotFrames",
    "RobotGeometry",
    "RobotType",
]

__getattr__ = absent_names("kompass.robot")
