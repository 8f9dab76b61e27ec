"""Serves a map from a file, latched, and loads another when asked."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar
from urllib.parse import unquote, urlparse

from nav2_msgs.srv import LoadMap
from pydantic import Field

from kompass.algorithms.grid import Grid
from kompass.algorithms.map_file import MapFileError, load_map
from kompass.components.base.component import Component
from kompass.components.base.component_config import ComponentConfig, ComponentRunType
from kompass.components.base.convert import grid_msg
from kompass.rclpy_ext.topic import LATCHED, AllowedTopics, Topic


class MapServerConfig(ComponentConfig):
    """Settings of the map server."""

    ignored_settings: ClassVar[Mapping[str, str]] = {
        "map_file_read_rate": "a map is read when it is asked for, and stays",
        **dict.fromkeys(
            ("pc_publish_row", "pc_frame", "grid_resolution", "z_ground_limit"),
            "maps come from an image with its yaml file, not from a point cloud",
        ),
    }

    loop_rate: float = Field(default=1.0, ge=0.01, le=1e3, description="Hz")
    map_file_path: str | None = Field(default=None, description="yaml file to serve at the start")


class MapServer(Component):
    """Publishes ``/map`` once, for everybody who comes later too.

    Without a file it waits for ``<node>/load_map``.
    """

    config: MapServerConfig
    config_class = MapServerConfig
    allowed_outputs: ClassVar = {"map": AllowedTopics(["OccupancyGrid"])}
    default_outputs: ClassVar = {"map": [Topic(name="/map", msg_type="OccupancyGrid")]}
    qos: ClassVar = {"map": LATCHED}
    allowed_run_types = (ComponentRunType.TIMED,)
    tells_missing_inputs = False

    def __init__(self, component_name: str = "map_server", **kwargs: Any) -> None:
        super().__init__(component_name, **kwargs)

    def create_interfaces(self) -> None:
        self.node.create_service(LoadMap, f"{self.node_name}/load_map", self._on_load_map)

    def custom_on_activate(self) -> None:
        path = self.config.map_file_path
        if path is None:
            return
        try:
            self._serve(load_map(Path(path)))
        except MapFileError as error:
            self.health.set_fail_system(message=str(error))
            self.warn(str(error))

    def _serve(self, grid: Grid) -> None:
        stamp = self.node.get_clock().now().to_msg()
        self.publish("map", grid_msg(grid, self.frames.world, stamp))
        self.health.set_healthy()

    def _on_load_map(
        self, request: LoadMap.Request, response: LoadMap.Response
    ) -> LoadMap.Response:
        if not self.is_active:
            response.result = LoadMap.Response.RESULT_UNDEFINED_FAILURE
            self.warn("load_map: the map server is not active")
            return response
        path = path_of(request.map_url)
        if not path.is_file():
            response.result = LoadMap.Response.RESULT_MAP_DOES_NOT_EXIST
            self.warn(f"load_map: there is no map file {path}")
            return response
        try:
            grid = load_map(path)
        except MapFileError as error:
            response.result = LoadMap.Response.RESULT_INVALID_MAP_DATA
            self.warn(f"load_map: {error}")
            return response
        self._serve(grid)
        response.map = grid_msg(grid, self.frames.world, self.node.get_clock().now().to_msg())
        response.result = LoadMap.Response.RESULT_SUCCESS
        return response


def path_of(url: str) -> Path:
    """The file of a map URL: a path, or ``file:///…``."""
    parsed = urlparse(url)
    return Path(unquote(parsed.path)) if parsed.scheme == "file" else Path(url)
