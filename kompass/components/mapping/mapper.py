"""The local map: what the scan shows around the robot, as a grid that turns with it."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np
from pydantic import Field, model_validator

from kompass.algorithms.geometry import compose
from kompass.algorithms.grid import Grid
from kompass.algorithms.mapping.local_map import LocalMapBuilder
from kompass.algorithms.mapping.scan_points import scan_fault
from kompass.algorithms.transforms import TransformError
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentConfig, ComponentRunType
from kompass.components.base.convert import grid_msg
from kompass.components.base.location_source import LocationSource
from kompass.rclpy_ext.topic import AllowedTopics, QoSConfig, Topic
from kompass.settings import Settings

# 50 m × 50 m at 5 cm: 60 MB while it is made, and 1 MB in each message.
MOST_CELLS = 1_000_000


class MapConfig(Settings):
    """Size of the local map: at most a million cells.

    Raises
    ------
    ValueError
        When it would have more, or less than one.
    """

    ignored_settings: ClassVar[Mapping[str, str]] = {
        "padding": "the map is as large as it is said to be",
        "filter_limit": "readings beyond the map are left out anyway",
        "max_points_per_line": "no lines are drawn; every cell looks its reading up",
        "max_num_threads": "a map is made in one piece",
        "bayesian_update": "each map is of one scan",
        "baysian_update": "each map is of one scan",
    }

    width: float = Field(default=3.0, ge=0.1, le=100, description="m, ahead and behind")
    height: float = Field(default=3.0, ge=0.1, le=100, description="m, to the sides")
    resolution: float = Field(default=0.05, ge=0.001, le=10, description="m")

    @model_validator(mode="after")
    def _is_a_local_map(self) -> Self:
        if self.resolution > min(self.width, self.height):
            raise ValueError(
                f"resolution = {self.resolution:g} m is coarser than the map of {self.width:g} m × "
                f"{self.height:g} m; give a smaller one"
            )
        cells = round(self.width / self.resolution) * round(self.height / self.resolution)
        if cells > MOST_CELLS:
            finest = math.sqrt(self.width * self.height / MOST_CELLS)
            raise ValueError(
                f"width = {self.width:g} m and height = {self.height:g} m with resolution = "
                f"{self.resolution:g} m are {cells} cells, more than {MOST_CELLS}; give a smaller "
                f"map, or a resolution of {finest:.3g} m or more"
            )
        return self


class LocalMapperConfig(ComponentConfig):
    """Settings of the local mapper."""

    ignored_settings: ClassVar[Mapping[str, str]] = {"scan_model": "rays are taken as they are"}

    loop_rate: float = Field(default=10.0, ge=0.1, le=1e3, description="Hz")
    map_params: MapConfig = Field(default_factory=MapConfig)
    sensor_timeout: float = Field(
        default=0.5, gt=0, le=60, description="s; an older scan is no map"
    )
    location_timeout: float = Field(default=0.5, gt=0, le=60, description="s")


class LocalMapper(Component):
    """Publishes a robot-centred occupancy grid of each new scan, with the scan's stamp."""

    config: LocalMapperConfig
    config_class = LocalMapperConfig
    allowed_inputs: ClassVar = {
        "sensor_data": AllowedTopics(["LaserScan"]),
        "location": AllowedTopics(["Odometry", "PoseStamped", "Pose"]),
    }
    allowed_outputs: ClassVar = {"local_map": AllowedTopics(["OccupancyGrid"])}
    default_inputs: ClassVar = {
        "sensor_data": [Topic(name="/scan", msg_type="LaserScan")],
        "location": [Topic(name="/odom", msg_type="Odometry")],
    }
    default_outputs: ClassVar = {
        "local_map": [Topic(name="/local_map/occupancy_layer", msg_type="OccupancyGrid")]
    }
    qos: ClassVar = {"local_map": QoSConfig(queue_size=1)}
    allowed_run_types = (ComponentRunType.TIMED,)
    tells_missing_inputs = False

    def __init__(self, component_name: str = "mapper", **kwargs: Any) -> None:
        super().__init__(component_name, **kwargs)

    def init_variables(self) -> None:
        self._mapped: object = None
        self._set_up()

    def custom_on_activate(self) -> None:
        self._location = LocationSource(self)

    def custom_on_deactivate(self) -> None:
        self._location.close()

    def on_config_changed(self, names: set[str]) -> None:
        self._set_up()

    def _set_up(self) -> None:
        size = self.config.map_params
        self._builder = LocalMapBuilder(size.width, size.height, size.resolution)

    def _execution_step(self) -> None:
        source, location = self.input("sensor_data"), self.input("location")
        given = (
            (source, self.config.sensor_timeout),
            (location, self.config.location_timeout),
        )
        missing = [f"/{item.topic.name}" for item, limit in given if item.age() > limit]
        reasons = filter(None, (item.too_old(limit) for item, limit in given))
        if missing and len(self.awaits(source, location)) >= len(missing):
            self.health.set_healthy(f"waiting for {', '.join(missing)}")
            return
        if missing:
            self.health.set_fail_system(topics=missing, message="; ".join(reasons))
            return
        scan = source.message
        if scan is self._mapped:
            return
        measured = np.asarray(scan.ranges, dtype=np.float64)
        rays = (scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max)
        fault = scan_fault(measured, *rays)
        if fault:
            text = f"what is on /{source.topic.name} cannot be used: {fault}"
            self.health.set_fail_system(topics=[f"/{source.topic.name}"], message=text)
            return
        pose = self._location.pose()
        try:
            mounted = self._location.of_sensor(scan.header.frame_id)
        except TransformError as error:
            if self._mapped is None and self.is_starting:
                self.health.set_healthy("waiting for /tf_static")
                return
            self.health.set_fail_system(topics=["/tf_static"], message=str(error))
            return
        if pose is None:
            self.health.set_fail_system(topics=["/tf"], message="the location cannot be placed")
            return
        cells = self._builder.update(measured, *rays, mounted)
        x, y, yaw = (float(value) for value in compose(pose, self._builder.origin))
        grid = Grid(cells, self._builder.resolution, (x, y, yaw))
        self._mapped = scan
        self.publish("local_map", grid_msg(grid, self.frames.world, scan.header.stamp))
        self.health.set_healthy()
