"""Faults of the map: there is none, or it is wrong about the place where the robot stands."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from nav2_msgs.srv import LoadMap
from nav_msgs.msg import OccupancyGrid

from kompass.algorithms.grid import OCCUPIED, Grid
from kompass.algorithms.map_file import save_map
from kompass.bus.node import Node
from kompass.rclpy_ext.qos import LATCHED_PROFILE
from kompass.share import map_path
from kompass.simulation.faults.fault_manager import FaultRefused, NotYet
from kompass.simulation.faults.fault_names import MAP_WITHHELD
from kompass.simulation.robot import SimulatedRobot
from kompass.simulation.worlds.rasterize import rasterize

SERVICE = "/map_server/load_map"
START_OCCUPIED = "start_occupied"
SPOT = 0.05  # m; radius of what the map shows where the robot is


class MapFaults:
    """Has the map server serve what the fault asks for, and the world's own map afterwards.

    Parameters
    ----------
    node
        Of the simulator.
    robot
        Whose place and world the map is of.
    withheld
        Whether the map server was started without a map.
    """

    def __init__(self, node: Node, robot: SimulatedRobot, *, withheld: bool) -> None:
        self._node = node
        self._robot = robot
        self._client = node.create_client(LoadMap, SERVICE)
        self._withheld = withheld
        self._arrived = False
        if withheld:
            node.create_subscription(OccupancyGrid, "/map", self._on_map, LATCHED_PROFILE)

    def knows(self, name: str) -> bool:
        return name in (MAP_WITHHELD, START_OCCUPIED)

    def begin(self, name: str) -> bool:
        if name == MAP_WITHHELD:
            if not self._withheld:
                raise FaultRefused(
                    "the map is out already and cannot be withheld any more; start the simulator "
                    f"with --fault {MAP_WITHHELD}"
                )
            self._withheld = False
            # Somebody may have been quicker with another map than this process with its start.
            return not self._arrived
        if not self._client.service_is_ready():
            raise NotYet(f"there is no {SERVICE} to give the wrong map to; start a map server")
        x, y, _ = self._robot.truth().pose
        # The server has read the file when it answers; the folder goes then.
        folder = tempfile.TemporaryDirectory(prefix="kompass-map-")
        path = Path(folder.name) / "wrong.yaml"
        save_map(_with_spot(rasterize(self._robot.world), x, y), path)
        self._load(path, folder)
        return True

    def end(self, name: str) -> None:
        self._load(map_path(self._robot.world.name), None)

    def ended(self) -> Iterable[str]:
        return (MAP_WITHHELD,) if self._arrived else ()

    def _on_map(self, _message: OccupancyGrid) -> None:
        self._arrived = True

    def _load(self, path: Path, folder: tempfile.TemporaryDirectory[str] | None) -> None:
        def answered(future: Any) -> None:
            if folder is not None:
                folder.cleanup()
            result = future.result().result
            if result != LoadMap.Response.RESULT_SUCCESS:
                self._node.get_logger().error(f"{SERVICE} refused {path}: result {result}")

        future = self._client.call_async(LoadMap.Request(map_url=str(path)))
        future.add_done_callback(answered)


def _with_spot(grid: Grid, x: float, y: float) -> Grid:
    """A grid with all within ``SPOT`` of a point occupied, and its own cell in any case."""
    rows, columns = np.indices(grid.cells.shape)
    centers = grid.cell_to_world(np.column_stack([columns.ravel(), rows.ravel()]))
    away = np.hypot(centers[:, 0] - x, centers[:, 1] - y).reshape(grid.cells.shape)
    cells = np.where(away <= max(SPOT, grid.resolution), OCCUPIED, grid.cells).astype(np.int8)
    return Grid(cells, grid.resolution, grid.origin)
