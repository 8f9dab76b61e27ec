"""Settings of the path-following algorithms, section by section of the configuration file."""

import dataclasses
from collections.abc import Mapping
from typing import Any, ClassVar, Self, get_type_hints

from pydantic import Field, create_model, model_validator

from kompass.algorithms.following.dwa import DWA, DWAParams
from kompass.algorithms.following.follower import FollowerParams, PathFollower
from kompass.algorithms.following.pure_pursuit import PurePursuit, PurePursuitParams
from kompass.algorithms.following.stanley import Stanley, StanleyParams
from kompass.components.base.notice import notice_once
from kompass.components.base.robot_limits import velocity_limits
from kompass.components.controller.controllers_id import ControllersID
from kompass.robot import RobotConfig
from kompass.settings import Settings

# Facing farther off than this the robot turns first: swinging in while driving would take it off
# the path by more than the clearance that the path keeps.
TURN_IN_PLACE = 0.4  # rad
# A little more than the drive manager's default critical zone: the algorithm must turn away from
# an obstacle before the gate behind it stops the robot.
DWA_CLEARANCE = 0.06  # m

COMMON_NAMES = {
    "goal_dist_tolerance": "goal_tolerance",
    "goal_orientation_tolerance": "heading_tolerance",
}
COMMON_UNUSED = (
    "control_time_step",
    "max_point_interpolation_distance",
    "path_segment_length",
    "loosing_goal_distance",
    "speed_regulation_curvature",
    "speed_regulation_angular",
    "min_speed_regulation_factor",
    "curvature_horizon_tolerance",
)


class FollowerSettings(Settings):
    """What a section may hold. A field left out (None) has the algorithm's own default."""

    params_class: ClassVar[type[FollowerParams]] = FollowerParams
    section: ClassVar[str] = ""
    # Names of other releases for the same thing.
    synonyms: ClassVar[Mapping[str, str]] = {}
    # Known elsewhere, without meaning here: accepted, and said once.
    unused: ClassVar[tuple[str, ...]] = ()

    @model_validator(mode="before")
    @classmethod
    def _translate(cls, given: Any) -> Any:
        if not isinstance(given, dict):
            return given
        taken = {}
        for key, value in given.items():
            if key in cls.unused or key in COMMON_UNUSED:
                notice_once(f"{cls.section}: '{key}' has no effect here")
                continue
            taken[cls.synonyms.get(key) or COMMON_NAMES.get(key, key)] = value
        return taken

    @model_validator(mode="after")
    def _is_possible(self) -> Self:
        self.params()
        return self

    def params(self, **defaults: Any) -> Any:
        """The algorithm's parameters; ``defaults`` where the section says nothing."""
        stated = {name: value for name, value in self if value is not None}
        return self.params_class(**{**defaults, **stated})


def _section(
    algorithm: ControllersID,
    params: type[FollowerParams],
    synonyms: Mapping[str, str] | None = None,
    unused: tuple[str, ...] = (),
) -> Any:
    """A settings model with the fields of a parameter class, each of which may be left out."""
    kinds = get_type_hints(params)
    fields: dict[str, Any] = {
        item.name: (
            kinds[item.name] | None,
            Field(default=None, description=f"left out: {item.default}"),
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
    model.params_class = params
    model.section = algorithm.value
    model.synonyms = synonyms or {}
    model.unused = unused
    return model


StanleyConfig: Any = _section(ControllersID.STANLEY, StanleyParams, unused=("min_angular_vel",))
PurePursuitConfig: Any = _section(
    ControllersID.PURE_PURSUIT,
    PurePursuitParams,
    {"lookahead_gain_forward": "lookahead_gain"},
    ("wheel_base", "prediction_horizon", "path_search_step", "max_search_candidates"),
)
DWAConfig: Any = _section(
    ControllersID.DWA,
    DWAParams,
    {"max_linear_samples": "linear_samples", "max_angular_samples": "angular_samples"},
    # Horizons were counted in steps of a length that is set elsewhere, and the weights belong to
    # other costs: taking the numbers over would say something else than was meant.
    (
        "control_horizon",
        "prediction_horizon",
        "octree_resolution",
        "costs_weights",
        "max_num_threads",
        "drop_samples",
        "allow_reverse",
    ),
)
SECTIONS = {
    ControllersID.STANLEY: StanleyConfig,
    ControllersID.PURE_PURSUIT: PurePursuitConfig,
    ControllersID.DWA: DWAConfig,
}


def make_follower(
    algorithm: ControllersID, settings: FollowerSettings, robot: RobotConfig, **defaults: Any
) -> PathFollower:
    """The algorithm, set up for a robot.

    Parameters
    ----------
    settings
        The algorithm's section.
    defaults
        Parameters for what the section leaves out.
    """
    limits = velocity_limits(robot)
    speeds = {
        "max_v": limits.vx.max_vel,
        "max_omega": limits.omega.max_vel,
        "acc": limits.vx.max_acc,
        "decel": limits.vx.max_decel,
        "omega_acc": limits.omega.max_acc,
    }
    defaults = {"turn_in_place_angle": TURN_IN_PLACE, **defaults}
    if algorithm is ControllersID.DWA:
        params = settings.params(clearance=DWA_CLEARANCE, **defaults)
        return DWA(params, robot_radius=robot.radius, **speeds)
    kind = Stanley if algorithm is ControllersID.STANLEY else PurePursuit
    return kind(settings.params(**defaults), **speeds)
