"""The local map: what the scan shows around the robot, as a grid that turns with it."""

from typing import ClassVar

import numpy as np
from pydantic import Field

from kompass.algorithms.geometry import compose
from kompass.algorithms.grid import Grid
from kompass.algorithms.mapping.local_map import LocalMapper as ScanMapper
from kompass.components.component_config import ComponentConfig
from kompass.components.convert import grid_msg
from kompass.components.located import Located
from kompass.components.topic import AllowedTopics, QoSConfig, Topic
from kompass.settings import Settings
from kompass.tf import TransformError


class MapConfig(Settings):
    """Size of the local map."""

    width: float = Field(default=3.0, ge=0.1, le=100, description="m, ahead and behind")
    height: float = Field(default=3.0, ge=0.1, le=100, description="m, to the sides")
    resolution: float = Field(default=0.05, gt=0, le=10, description="m")


class LocalMapperConfig(ComponentConfig):
    """Settings of the local mapper."""

    loop_rate: float = Field(default=10.0, ge=0.1, le=1e3, description="Hz")
    map_params: MapConfig = Field(default_factory=MapConfig)
    sensor_timeout: float = Field(default=0.5, gt=0, description="s; an older scan is no map")
    location_timeout: float = Field(default=0.5, gt=0, description="s")


class LocalMapper(Located):
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

    def __init__(self, component_name: str = "mapper", **kwargs: object) -> None:
        super().__init__(component_name, **kwargs)

    def init_variables(self) -> None:
        size = self.config.map_params
        self._mapper = ScanMapper(size.width, size.height, size.resolution)
        self._mapped: object = None

    def _execution_step(self) -> None:
        source, location = self.input("sensor_data"), self.input("location")
        missing = [
            f"/{item.topic.name}"
            for item, limit in (
                (source, self.config.sensor_timeout),
                (location, self.config.location_timeout),
            )
            if item.age() > limit
        ]
        if missing:
            self.health.set_fail_system(topics=missing, message=f"nothing on {', '.join(missing)}")
            return
        scan = source.message
        if scan is self._mapped:
            return
        pose = self.pose()
        try:
            mounted = self.sensor_pose(scan.header.frame_id)
        except TransformError as error:
            self.health.set_fail_system(topics=["/tf_static"], message=str(error))
            return
        if pose is None:
            self.health.set_fail_system(topics=["/tf"], message="the location cannot be placed")
            return
        cells = self._mapper.update(
            np.asarray(scan.ranges, dtype=np.float64),
            scan.angle_min,
            scan.angle_increment,
            scan.range_min,
            scan.range_max,
            mounted,
        )
        x, y, yaw = (float(value) for value in compose(pose, self._mapper.origin))
        grid = Grid(cells, self._mapper.resolution, (x, y, yaw))
        self._mapped = scan
        self.publish("local_map", grid_msg(grid, self.frames.world, scan.header.stamp))
        self.health.set_healthy()
