"""The robot: its kind of drive, its shape, its limits and its frames."""

import enum
import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import AliasChoices, BeforeValidator, Field, PlainSerializer, model_validator

from kompass.settings import Settings


class RobotType(enum.Enum):
    """How the robot moves."""

    ACKERMANN = "ACKERMANN"
    DIFFERENTIAL_DRIVE = "DIFFERENTIAL_DRIVE"
    OMNI = "OMNI"


class RobotGeometry:
    """Shapes a robot may have, and what follows from their parameters (metres)."""

    class Type(enum.Enum):
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
                f"({', '.join(names)}, in metres), not {params.tolist()}"
            )
        if not np.all(np.isfinite(params)) or not np.all(params > 0):
            raise ValueError(f"geometry_params must all be greater than 0, not {params.tolist()}")

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


class LinearCtrlLimits(Settings):
    """Limits along one axis [m/s, m/s²]; a command below ``min_absolute_val`` is zero."""

    max_vel: float = Field(default=0.0, ge=0)
    max_acc: float = Field(default=0.0, ge=0)
    max_decel: float = Field(default=0.0, ge=0)
    min_absolute_val: float = Field(
        default=0.01, ge=0, validation_alias=AliasChoices("min_absolute_val", "min_vel")
    )


class AngularCtrlLimits(Settings):
    """Limits of rotation [rad/s, rad/s²] and of steering [rad]."""

    max_vel: float = Field(default=0.0, ge=0, validation_alias=AliasChoices("max_vel", "max_omega"))
    max_steer: float = Field(
        default=math.pi, ge=0, validation_alias=AliasChoices("max_steer", "max_ang")
    )
    max_acc: float = Field(default=0.0, ge=0)
    max_decel: float = Field(default=0.0, ge=0)
    min_absolute_val: float = Field(
        default=0.01, ge=0, validation_alias=AliasChoices("min_absolute_val", "min_omega")
    )


class RobotCtrlLimits(Settings):
    """Limits of all three planar axes."""

    vx_limits: LinearCtrlLimits
    omega_limits: AngularCtrlLimits
    vy_limits: LinearCtrlLimits = Field(default_factory=LinearCtrlLimits)


def _member_of(kind: type[enum.Enum]) -> Any:
    def read(value: Any) -> Any:
        if isinstance(value, str):
            try:
                return kind[value.strip().upper().replace(" ", "_")]
            except KeyError:
                names = ", ".join(member.name for member in kind)
                raise ValueError(f"{value!r} is none of {names}") from None
        return value

    return BeforeValidator(read)


Vector = Annotated[
    np.ndarray,
    BeforeValidator(lambda value: np.asarray(value, dtype=np.float64)),
    PlainSerializer(lambda value: value.tolist(), return_type=list),
]


class RobotConfig(Settings):
    """What the stack must know of the robot.

    Raises
    ------
    ValueError
        When ``geometry_params`` do not fit ``geometry_type``, or a limit is negative.
    """

    model_type: Annotated[RobotType, _member_of(RobotType)] = RobotType.ACKERMANN
    geometry_type: Annotated[RobotGeometry.Type, _member_of(RobotGeometry.Type)] = (
        RobotGeometry.Type.CYLINDER
    )
    geometry_params: Vector = Field(default_factory=lambda: np.array([0.2, 1.0]))
    ctrl_vx_limits: LinearCtrlLimits = Field(
        default_factory=lambda: LinearCtrlLimits(max_vel=1.0, max_acc=3.0, max_decel=5.0)
    )
    ctrl_omega_limits: AngularCtrlLimits = Field(
        default_factory=lambda: AngularCtrlLimits(
            max_vel=5.0, max_steer=math.pi, max_acc=10.0, max_decel=10.0
        )
    )
    ctrl_vy_limits: LinearCtrlLimits = Field(default_factory=LinearCtrlLimits)

    @model_validator(mode="after")
    def _shape_is_possible(self) -> "RobotConfig":
        RobotGeometry.check(self.geometry_type, self.geometry_params)
        return self

    @property
    def radius(self) -> float:
        """Radius of the circle around the footprint [m]."""
        return RobotGeometry.get_radius(self.geometry_type, self.geometry_params)

    @property
    def height(self) -> float:
        """Height [m]."""
        return RobotGeometry.get_height(self.geometry_type, self.geometry_params)

    @property
    def footprint(self) -> NDArray[np.float64]:
        """Corners in the robot's frame, anticlockwise, shape (N, 2) [m]."""
        return RobotGeometry.get_footprint(self.geometry_type, self.geometry_params)


class RobotFrames(Settings):
    """Names of the coordinate frames. What a message says in its header comes before these."""

    robot_base: str = "base_link"
    odom: str = "odom"
    world: str = "map"
    scan: str = "base_link"
    rgb: str = "camera_link"
    depth: str = "camera_depth_link"
    point_cloud: str = "point_cloud_link"


__all__ = [
    "AngularCtrlLimits",
    "LinearCtrlLimits",
    "RobotConfig",
    "RobotCtrlLimits",
    "RobotFrames",
    "RobotGeometry",
    "RobotType",
]
