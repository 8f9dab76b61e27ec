"""The local map: what the sensors show around the robot, as a grid that turns with it."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AliasChoices, Field, model_validator

from kompass.algorithms.geometry import Pose2D, compose, inverse, transform_points
from kompass.algorithms.grid import FREE, OCCUPIED, UNKNOWN, Grid
from kompass.algorithms.mapping.cloud_view import CloudView
from kompass.algorithms.mapping.local_map import LocalMapBuilder
from kompass.algorithms.mapping.occupancy_memory import OccupancyMemory, SensorModel
from kompass.algorithms.transforms import TransformError
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentRunType
from kompass.components.base.convert import grid_msg
from kompass.components.base.location_source import LocationSource
from kompass.components.base.ports import Input
from kompass.components.base.seen import (
    MOST_SENSORS,
    SENSOR_INPUTS,
    Seen,
    cloud_memory,
    read_seen,
    stamp_of,
)
from kompass.components.base.sensor_settings import SensorSettings
from kompass.rclpy_ext.topic import AllowedTopics, QoSConfig, Topic
from kompass.settings import Settings

# 50 m × 50 m at 5 cm: 60 MB while it is made, and 1 MB in each message.
MOST_CELLS = 1_000_000
# m above the lowest height that counts; where a cloud looks lower than this, nothing stands.
SEEN_TO_FLOOR = 0.05
# Who is so far from where it was at the last scan was put there, and what was seen lies elsewhere.
JUMP = 0.5  # m


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
    }

    width: float = Field(default=3.0, ge=0.1, le=100, description="m, ahead and behind")
    height: float = Field(default=3.0, ge=0.1, le=100, description="m, to the sides")
    resolution: float = Field(default=0.05, ge=0.001, le=10, description="m")
    bayesian_update: bool = Field(
        default=False,
        validation_alias=AliasChoices("bayesian_update", "baysian_update"),
        description="whether what was seen before is remembered; else each map is of one scan",
    )

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
        if self.bayesian_update and max(self.width, self.height) > 4 * min(self.width, self.height):
            raise ValueError(
                f"width = {self.width:g} m and height = {self.height:g} m with bayesian_update: "
                "what is remembered is as wide as the map is long; give sides of at most 1 to 4"
            )
        return self


class ScanModelConfig(Settings):
    """How far scans are believed, where they are remembered.

    Raises
    ------
    ValueError
        The probabilities are not in the order p_empty < p_prior < p_occupied.
    """

    ignored_settings: ClassVar[Mapping[str, str]] = {
        "range_sure": "a reading is believed the same at any range",
        "wall_size": "an obstacle is the cell in which a ray ends",
        "angle_step": "scanners tell their angles themselves, and clouds are taken point by point",
        "max_height": "heights that count are set with height_band",
        "min_height": "heights that count are set with height_band",
        "range_max": "readings count up to what the sensor tells, and to the map's edge",
    }

    p_prior: float = Field(default=0.6, gt=0, lt=1, description="before anything was seen")
    p_occupied: float = Field(default=0.9, gt=0, lt=1, description="where a ray ends")
    p_empty: float = Field(default=0.1, gt=0, lt=1, description="where a ray passes")

    @model_validator(mode="after")
    def _is_a_model(self) -> Self:
        self.model()
        return self

    def model(self) -> SensorModel:
        """As the memory takes it."""
        return SensorModel(self.p_prior, self.p_occupied, self.p_empty)


class LocalMapperConfig(SensorSettings):
    """Settings of the local mapper."""

    loop_rate: float = Field(default=10.0, ge=0.1, le=1e3, description="Hz")
    map_params: MapConfig = Field(default_factory=MapConfig)
    scan_model: ScanModelConfig = Field(
        default_factory=ScanModelConfig, description="only with bayesian_update"
    )
    sensor_timeout: float = Field(
        default=0.5, gt=0, le=60, description="s; an older scan is no map"
    )
    location_timeout: float = Field(default=0.5, gt=0, le=60, description="s")


class LocalMapper(Component):
    """Publishes a robot-centred occupancy grid of each new scan, with the scan's stamp.

    With ``bayesian_update`` it has what was seen before, too; what is seen now is occupied at once.
    With several sensors it is made whenever the first of them speaks, of the newest that each has
    said. What one of them sees is occupied, whatever another one looks over.
    """

    config: LocalMapperConfig
    config_class = LocalMapperConfig
    allowed_inputs: ClassVar = {
        "sensor_data": AllowedTopics(SENSOR_INPUTS, 1, MOST_SENSORS),
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
        self._layers = [
            _Layer(LocalMapBuilder(size.width, size.height, size.resolution), self.config)
            for _ in self._topics_in["sensor_data"]
        ]

    def _execution_step(self) -> None:
        sources, location = self._inputs["sensor_data"], self.input("location")
        given = (
            *((source, self.config.sensor_timeout) for source in sources),
            (location, self.config.location_timeout),
        )
        missing = [f"/{item.topic.name}" for item, limit in given if item.age() > limit]
        reasons = filter(None, (item.too_old(limit) for item, limit in given))
        if missing and len(self.awaits(*sources, location)) >= len(missing):
            self.health.set_healthy(f"waiting for {', '.join(missing)}")
            return
        if missing:
            self.health.set_fail_system(topics=missing, message="; ".join(reasons))
            return
        newest = sources[0].message
        if newest is self._mapped:
            return
        pose = self._location.pose()
        if not all(
            self._take_in(source, layer, pose)
            for source, layer in zip(sources, self._layers, strict=True)
        ):
            return
        if pose is None:
            self.health.set_fail_system(topics=["/tf"], message="the location cannot be placed")
            return
        cells = self._layers[0].cells(pose)
        for layer in self._layers[1:]:
            np.maximum(cells, layer.cells(pose), out=cells)
        builder = self._layers[0].builder
        x, y, yaw = (float(value) for value in compose(pose, builder.origin))
        grid = Grid(cells, builder.resolution, (x, y, yaw))
        self._mapped = newest
        self.publish("local_map", grid_msg(grid, self.frames.world, newest.header.stamp))
        self.health.set_healthy()

    def _take_in(self, source: Input, layer: "_Layer", pose: Pose2D | None) -> bool:
        """Have a sensor's layer show its newest message; False when it says nothing."""
        message, topic = source.message, f"/{source.topic.name}"
        if message is layer.taken:
            return True
        # The map is where the robot is now, and so is what the first sensor has just seen.
        first = layer is self._layers[0]
        there = pose if first else self._location.pose_at(stamp_of(message))
        try:
            seen = read_seen(message, self._location, self.config)
        except ValueError as error:
            text = f"what is on {topic} cannot be used: {error}"
            self.health.set_fail_system(topics=[topic], message=text)
            return False
        except TransformError as error:
            if self._mapped is None and self.is_starting:
                self.health.set_healthy("waiting for /tf_static")
                return False
            self.health.set_fail_system(topics=["/tf_static"], message=str(error))
            return False
        if there is not None:
            layer.take(message, seen, there, self.clock.monotonic())
        return True


class _Layer:
    """What one sensor has seen last, and where the robot was then."""

    def __init__(self, builder: LocalMapBuilder, config: LocalMapperConfig) -> None:
        self.builder = builder
        self.taken: object = None
        self._floor = config.height_band.low + SEEN_TO_FLOOR
        self._memory = cloud_memory(config)
        self._now = 0.0
        size = builder.rows, builder.cols, builder.resolution
        remembers = config.map_params.bayesian_update
        self._before = OccupancyMemory(*size, config.scan_model.model()) if remembers else None
        self._remembered: object = None
        self._last: Pose2D | None = None

    def take(self, message: object, seen: Seen, pose: Pose2D, now: float) -> None:
        """Show this from now on."""
        self.taken, self._seen, self._there, self._now = message, seen, pose, now
        if isinstance(seen, CloudView):
            self._memory.see(seen, pose, now)

    def cells(self, pose: Pose2D) -> NDArray[np.int8]:
        """The map (rows, cols) around a robot that is at a pose (x, y, yaw) now."""
        now = self._seen_now(pose)
        if self._before is None:
            return now
        last, self._last = self._last, pose
        if last is not None and math.hypot(pose[0] - last[0], pose[1] - last[1]) > JUMP:
            self._before.forget()
        if self.taken is not self._remembered:
            self._before.take(now, pose)
            self._remembered = self.taken
        cells = self._before.cells(pose)
        cells[now == OCCUPIED] = OCCUPIED
        return cells

    def _seen_now(self, pose: Pose2D) -> NDArray[np.int8]:
        builder, seen = self.builder, self._seen
        if not isinstance(seen, CloudView):
            if pose == self._there:
                return builder.update(*seen.rays, seen.sensor)
            moved = compose(compose(inverse(pose), self._there), seen.sensor)
            return builder.update(*seen.rays, moved)
        grid = Grid(
            np.full((builder.rows, builder.cols), UNKNOWN, np.int8),
            builder.resolution,
            tuple(compose(pose, builder.origin).tolist()),
        )
        rows, cols = np.indices(grid.cells.shape).reshape(2, -1)
        places = transform_points(
            inverse(self._there), grid.cell_to_world(np.stack([cols, rows], axis=1))
        )
        floor = np.full(len(places), self._floor)
        free = seen.sees_through(places, floor - SEEN_TO_FLOOR, floor)
        grid.cells[rows[free], cols[free]] = FREE
        met = np.concatenate(
            [transform_points(self._there, seen.points), self._memory.points(self._now)]
        )
        cols, rows = grid.world_to_cell(met[grid.contains(met)]).T
        grid.cells[rows, cols] = OCCUPIED
        return grid.cells
