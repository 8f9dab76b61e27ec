"""Settings of the algorithms of the controller, section by section of the configuration file."""

import dataclasses
import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self, get_type_hints

from pydantic import Field, create_model, model_validator

from kompass.algorithms.bounded import USUAL_BOUNDS
from kompass.algorithms.following.dvz import DVZ
from kompass.algorithms.following.dwa import DWA
from kompass.algorithms.following.follower import PathFollower
from kompass.algorithms.following.mppi import MPPI
from kompass.algorithms.following.pure_pursuit import PurePursuit
from kompass.algorithms.following.stanley import Stanley, StanleyLaw
from kompass.algorithms.footprint import Footprint
from kompass.algorithms.tracking.rgb_follower import VisionRGBFollower
from kompass.algorithms.tracking.rgbd_follower import VisionRGBDFollower
from kompass.algorithms.tracking.vision_follower import VisionFollower
from kompass.components.base.robot_limits import motion_model, velocity_limits
from kompass.components.controller.controllers_id import ControllersID
from kompass.robot import RobotConfig
from kompass.settings import Settings

# Facing farther off than this the robot turns first: swinging in while driving would take it off
# the path by more than the clearance that the path keeps.
TURN_IN_PLACE = 0.4  # rad
# A little more than the drive manager's default critical zone: the algorithm must turn away from
# an obstacle before the gate behind it stops the robot.
CLEARANCE = 0.06  # m

COMMON_NAMES = {
    "goal_dist_tolerance": "goal_tolerance",
    "goal_orientation_tolerance": "heading_tolerance",
}
ELSEWHERE = "it has no meaning for the algorithm here"


class FollowerSettings(Settings):
    """What a section may hold. A field left out (None) has the algorithm's own default."""

    ignored_settings: ClassVar[Mapping[str, str]] = dict.fromkeys(
        (
            "control_time_step",
            "max_point_interpolation_distance",
            "path_segment_length",
            "loosing_goal_distance",
            "speed_regulation_curvature",
            "speed_regulation_angular",
            "min_speed_regulation_factor",
            "curvature_horizon_tolerance",
        ),
        ELSEWHERE,
    )
    follower: ClassVar[type[Any]]
    section: ClassVar[str] = ""
    # Names of other releases for the same thing.
    synonyms: ClassVar[Mapping[str, str]] = {}
    # Of the parameters, where the stack needs others than the algorithm alone would have.
    defaults: ClassVar[Mapping[str, Any]] = {}

    @model_validator(mode="before")
    @classmethod
    def _translate(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            return given
        return {
            cls.synonyms.get(key) or COMMON_NAMES.get(key, key): value
            for key, value in given.items()
        }

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        self.params()
        return self

    def params(self, **defaults: Any) -> Any:
        """The algorithm's parameters; ``defaults`` where the section says nothing."""
        stated = {name: value for name, value in self if value is not None}
        return self.follower.params_class(**{**defaults, **stated})


def _section(
    algorithm: ControllersID,
    follower: type[PathFollower[Any]] | type[VisionFollower[Any]],
    *,
    synonyms: Mapping[str, str] | None = None,
    ignored: Mapping[str, str] | None = None,
    defaults: Mapping[str, Any] | None = None,
) -> Any:
    """A settings model with the fields of a parameter class, each of which may be left out."""
    params = follower.params_class
    kinds = get_type_hints(params)
    chosen = dict(defaults or {})
    # What holds without a setting is told by the reference; two come from the controller's own.
    left_out = {item.name: item.default for item in dataclasses.fields(params)}
    if issubclass(follower, PathFollower):
        chosen = {"turn_in_place_angle": TURN_IN_PLACE, **chosen}
        left_out |= {name: f"the controller's {given}" for given, name in COMMON_NAMES.items()}
    left_out |= chosen
    fields: dict[str, Any] = {
        item.name: (
            kinds[item.name] | None,
            Field(
                default=None,
                description=f"left out: {left_out[item.name]}",
                ge=params.bounds.get(item.name, USUAL_BOUNDS)[0],
                le=params.bounds.get(item.name, USUAL_BOUNDS)[1],
            ),
        )
        for item in dataclasses.fields(params)
    }
    model = create_model(
        f"{algorithm.value}Config",
        __base__=FollowerSettings,
        __doc__=f"Settings of {algorithm.value}; see {params.__name__}.",
        __module__=__name__,
        **fields,
    )
    model.follower = follower
    model.section = algorithm.value
    model.synonyms = synonyms or {}
    model.ignored_settings = ignored or {}
    model.defaults = chosen
    return model


StanleyConfig: Any = _section(
    ControllersID.STANLEY,
    Stanley,
    ignored={"min_angular_vel": ELSEWHERE},
)
PurePursuitConfig: Any = _section(
    ControllersID.PURE_PURSUIT,
    PurePursuit,
    synonyms={"lookahead_gain_forward": "lookahead_gain"},
    ignored=dict.fromkeys(
        ("wheel_base", "prediction_horizon", "path_search_step", "max_search_candidates"), ELSEWHERE
    ),
)
DWAConfig: Any = _section(
    ControllersID.DWA,
    DWA,
    synonyms={"max_linear_samples": "linear_samples", "max_angular_samples": "angular_samples"},
    ignored={
        # Taking these numbers over would say something else than was meant.
        "control_horizon": "it is counted in steps of another length; give prediction_time",
        "prediction_horizon": "it is counted in steps of another length; give prediction_time",
        "costs_weights": "they belong to other costs; give path_weight, goal_weight, …",
        **dict.fromkeys(
            ("octree_resolution", "max_num_threads", "drop_samples", "allow_reverse"), ELSEWHERE
        ),
    },
    defaults={"clearance": CLEARANCE},
)
DVZConfig: Any = _section(
    ControllersID.DVZ,
    DVZ,
    ignored={"min_angular_vel": ELSEWHERE},
    defaults={"clearance": CLEARANCE},
)
MPPIConfig: Any = _section(
    ControllersID.MPPI,
    MPPI,
    # It turns by plans under which obstacles are looked at, and passes gaps that just fit.
    defaults={"clearance": 0.03, "turn_in_place_angle": math.pi},
)
_VISION_IGNORED = dict.fromkeys(
    ("control_time_step", "control_horizon", "prediction_horizon", "buffer_size"), ELSEWHERE
)
VisionRGBFollowerConfig: Any = _section(
    ControllersID.VISION_IMG,
    VisionRGBFollower,
    ignored={**_VISION_IGNORED, "target_distance": "an image alone tells no distance"},
)
VisionRGBDFollowerConfig: Any = _section(
    ControllersID.VISION_DEPTH,
    VisionRGBDFollower,
    ignored={
        **_VISION_IGNORED,
        # Taking these numbers over would say something else than was meant.
        "error_pose": "it is counted otherwise; give place_deviation",
        "error_vel": "it is counted otherwise; give target_acceleration",
        "error_acc": "it is counted otherwise; give target_acceleration",
    },
)
SECTIONS = {
    ControllersID.STANLEY: StanleyConfig,
    ControllersID.PURE_PURSUIT: PurePursuitConfig,
    ControllersID.DWA: DWAConfig,
    ControllersID.DVZ: DVZConfig,
    ControllersID.MPPI: MPPIConfig,
    ControllersID.VISION_IMG: VisionRGBFollowerConfig,
    ControllersID.VISION_DEPTH: VisionRGBDFollowerConfig,
}


def make_follower(
    settings: FollowerSettings, robot: RobotConfig, **defaults: Any
) -> PathFollower[Any]:
    """The algorithm of a section, set up for a robot.

    Parameters
    ----------
    defaults
        Parameters for what the section leaves out.
    """
    if issubclass(settings.follower, StanleyLaw) and robot.turning_radius > 0:
        steer = robot.ctrl_omega_limits.max_steer
        wheel_base = robot.turning_radius * math.tan(steer)
        defaults = {"max_steer": steer, "wheel_base": wheel_base, **defaults}
    params = settings.params(**{**settings.defaults, **defaults})
    # What is slower never reaches the wheels, unless the section itself wants it so.
    crawl = {
        name: max(getattr(params, name), axis.min_absolute_val)
        for name, axis in (
            ("min_speed", robot.ctrl_vx_limits),
            ("min_turn_rate", robot.ctrl_omega_limits),
        )
        if getattr(settings, name) is None
    }
    follower: PathFollower[Any] = settings.follower(
        dataclasses.replace(params, **crawl),
        footprint=Footprint(robot.footprint),
        **_limits(robot),
    )
    return follower


def make_tracker(
    settings: FollowerSettings, robot: RobotConfig
) -> VisionRGBFollower | VisionRGBDFollower:
    """The vision algorithm of a section, set up for a robot."""
    tracker: VisionRGBFollower | VisionRGBDFollower = settings.follower(
        settings.params(),
        **_limits(robot),
    )
    return tracker


def _limits(robot: RobotConfig) -> dict[str, Any]:
    """What the robot's axes can do and how it moves, as followers take it."""
    limits = velocity_limits(robot)
    return {
        "max_v": limits.vx.max_vel,
        "max_omega": limits.omega.max_vel,
        "acc": limits.vx.max_acc,
        "decel": limits.vx.max_decel,
        "omega_acc": limits.omega.max_acc,
        "motion": motion_model(robot),
    }
