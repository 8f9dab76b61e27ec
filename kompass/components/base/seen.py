"""What a sensor's message says of what is around the robot, whatever kind of message it is."""

from typing import Any, TypeAlias

from sensor_msgs.msg import PointCloud2

from kompass.algorithms.footprint import Footprint
from kompass.algorithms.mapping.cloud_memory import CloudMemory
from kompass.algorithms.mapping.cloud_view import CloudView
from kompass.algorithms.mapping.point_cloud import read_points
from kompass.algorithms.mapping.scan_points import PlacedScan
from kompass.components.base.location_source import LocationSource
from kompass.components.base.sensor_settings import SensorSettings

SENSOR_INPUTS = ["LaserScan", "PointCloud2"]
MOST_SENSORS = 10  # optional ones beside the first, as many as upstream takes

Seen: TypeAlias = PlacedScan | CloudView


def stamp_of(message: Any) -> float:
    """When something was measured [s]."""
    return float(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)


def cloud_memory(settings: SensorSettings) -> CloudMemory:
    """A memory for the clouds of one sensor, as it is set."""
    robot = settings.robot
    body = 0.0 if robot is None else Footprint(robot.footprint).inscribed_radius
    return CloudMemory(body, settings.cloud_memory)


def read_seen(message: Any, location: LocationSource, settings: SensorSettings) -> Seen:
    """A scan or a cloud, placed on the robot by the frame that it names.

    Raises
    ------
    TransformError
        It is not known where its sensor is.
    ValueError
        It says nothing of what is around the robot; why, and what to do.
    """
    mounted = location.mounting(message.header.frame_id, stamp_of(message))
    if not isinstance(message, PointCloud2):
        scan = PlacedScan.of(
            message.ranges,
            message.angle_min,
            message.angle_increment,
            message.range_min,
            message.range_max,
            mounted,
        )
        if scan.fault:
            raise ValueError(scan.fault)
        return scan
    points = read_points(
        message.data,
        message.fields,
        width=message.width,
        height=message.height,
        point_step=message.point_step,
        row_step=message.row_step,
        big_endian=message.is_bigendian,
    )
    band = settings.height_band
    if not band.low < band.high:
        raise ValueError(
            f"cloud_min_height = {band.low:g} m is above the robot, of {band.high:g} m; give a "
            "lower one, or cloud_max_height"
        )
    view = CloudView(points, mounted, band, message.width)
    if not (view.measured or settings.clouds_may_be_empty):
        raise ValueError(
            "it has no point that was measured; look whether the sensor is covered or broken, or "
            "set clouds_may_be_empty if it shows obstacles only"
        )
    return view
