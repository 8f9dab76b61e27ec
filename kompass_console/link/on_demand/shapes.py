"""Messages in, shapes out: what is drawn of a further topic, bounded whatever it says.

ValueError names the field when a message contradicts itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from kompass.algorithms.grid import OCCUPIED_FROM
from kompass.algorithms.mapping.point_cloud import read_points
from kompass.algorithms.rectangles import rectangles
from kompass.algorithms.transforms import Matrix, matrix_of
from kompass_console.link.graph import convert
from kompass_console.schema.world import Shape, ShapeLabel

MOST_POINTS = 8000  # of one topic
MOST_SEGMENTS = 4000
MOST_AREAS = 2000
MOST_LABELS = 50

_FARTHEST = 1e5  # m; what is farther away is a slip
_LIFT = 0.03  # m; what lies on the floor is drawn above the map
_ON_WALLS = 0.09  # m; a scan on top of the walls, or these would hide half of it
_MOST_CELLS = 400  # of a grid across; larger ones are drawn coarser
_ARROW = 0.25  # m

Points = npt.NDArray[np.float32]


class Part(NamedTuple):
    """A shape in a frame of its own, as it was at `stamp` (s); `note` says what is left out."""

    frame: str
    stamp: float
    shape: Shape
    note: str = ""


def path_part(message: Any) -> Part:
    """nav_msgs/Path: a line."""
    points = _positions([each.pose for each in message.poses])
    thinned = points[_spread(len(points), MOST_SEGMENTS)]
    return _part(message, Shape(segments=joined(thinned + _up(_LIFT))), _left_out(points, thinned))


def poses_part(message: Any) -> Part:
    """geometry_msgs/PoseArray: a stroke for each, in its heading, with a dot where it is."""
    chosen = _spread(len(message.poses), MOST_SEGMENTS)
    poses = [message.poses[i] for i in chosen]
    at = _positions(poses, keep=True) + _up(_LIFT)
    ahead = np.array([_ahead(pose.orientation) for pose in poses], np.float32).reshape(-1, 3)
    sound = _sound(at) & _sound(ahead)
    _some(sound, "poses")
    at, ahead = at[sound], ahead[sound]
    shape = Shape(points=at, segments=np.stack([at, at + _ARROW * ahead], axis=1))
    return _part(message, shape, _left_out(message.poses, poses))


def cloud_part(message: Any) -> Part:
    """sensor_msgs/PointCloud2: every so many-th of its points."""
    count = message.width * message.height
    step = max(1, -(-count // MOST_POINTS))
    width, height, point_step = message.width, message.height, message.point_step
    in_one = height == 1 or message.row_step == width * point_step
    if step > 1 and in_one and len(message.data) >= count * point_step:
        # Only those that are drawn are looked at.
        width, height, point_step = count // step, 1, point_step * step
    points = read_points(
        message.data,
        message.fields,
        width=width,
        height=height,
        point_step=point_step,
        row_step=message.row_step if height > 1 else width * point_step,
        big_endian=bool(message.is_bigendian),
    ).T
    points = points[_spread(len(points), MOST_POINTS)]
    note = "" if step == 1 else f"One in {step} of {count} points is drawn."
    return _part(message, Shape(points=_finite(points)), note)


def scan_part(message: Any) -> Part:
    """sensor_msgs/LaserScan: where its beams ended."""
    scan = convert.scan(message)
    with np.errstate(over="ignore", invalid="ignore"):
        angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
        hit = (scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max)
        ranges, angles = scan.ranges[hit], angles[hit]
        points = np.column_stack([ranges * np.cos(angles), ranges * np.sin(angles)])
    thinned = points[_spread(len(points), MOST_POINTS)]
    flat = np.column_stack([thinned, np.full(len(thinned), _ON_WALLS)])
    return _part(message, Shape(points=_finite(flat)), _left_out(points, thinned))


def grid_part(message: Any) -> Part:
    """nav_msgs/OccupancyGrid: its occupied cells."""
    grid = convert.grid(message)
    occupied = np.asarray(grid.cells >= OCCUPIED_FROM)
    coarser = max(1, -(-max(occupied.shape) // _MOST_CELLS))
    if coarser > 1:
        rows, columns = (-(-n // coarser) for n in occupied.shape)
        padded = np.zeros((rows * coarser, columns * coarser), np.bool_)
        padded[: occupied.shape[0], : occupied.shape[1]] = occupied
        occupied = np.asarray(padded.reshape(rows, coarser, columns, coarser).any(axis=(1, 3)))
    found = rectangles(occupied) * (grid.resolution * coarser)
    y0, x0, y1, x1 = found[:MOST_AREAS].T
    corners = np.stack([np.stack(xy, axis=1) for xy in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))], 1)
    flat = np.concatenate([corners, np.full((*corners.shape[:2], 1), _LIFT)], axis=2)
    areas = moved_points(flat, pose_matrix(message.info.origin))
    notes = []
    if coarser > 1:
        notes.append(f"It is drawn {coarser} times as coarse as it is.")
    if len(found) > MOST_AREAS:
        notes.append(f"Of {len(found)} areas the first {MOST_AREAS} are drawn.")
    return _part(message, Shape(areas=areas.astype(np.float32)), " ".join(notes))


def polygon_part(message: Any) -> Part:
    """geometry_msgs/PolygonStamped: its outline."""
    points = vertices(message.polygon.points)
    _some(_sound(points), "polygon.points")
    thinned = _finite(points[_spread(len(points), MOST_SEGMENTS)]) + _up(_LIFT)
    closed = np.concatenate([thinned, thinned[:1]])
    return _part(message, Shape(segments=joined(closed)), _left_out(points, thinned))


def combined(shapes: Sequence[Shape]) -> Shape:
    """Several shapes as one; those without colours of their own are grey among those with."""
    if len(shapes) == 1:
        return shapes[0]
    return Shape(
        points=np.concatenate([np.zeros((0, 3), np.float32), *(s.points for s in shapes)]),
        segments=np.concatenate([np.zeros((0, 2, 3), np.float32), *(s.segments for s in shapes)]),
        areas=np.concatenate([np.zeros((0, 4, 3), np.float32), *(s.areas for s in shapes)]),
        labels=tuple(label for s in shapes for label in s.labels),
        point_colours=_colours([(s.point_colours, len(s.points)) for s in shapes]),
        segment_colours=_colours([(s.segment_colours, len(s.segments)) for s in shapes]),
    )


def moved(shape: Shape, matrix: Matrix) -> Shape:
    """A shape taken to another frame; what is nowhere there, or too far away, is left out."""
    points = moved_points(shape.points, matrix)
    segments = moved_points(shape.segments, matrix)
    areas = moved_points(shape.areas, matrix)
    here = [_near(each) for each in (points, segments, areas)]
    labels = []
    for label in shape.labels:
        at = moved_points(np.array(label.at), matrix)
        if _near(at[None])[0]:
            labels.append(ShapeLabel(label.text, (float(at[0]), float(at[1]), float(at[2]))))
    return Shape(
        points=points[here[0]].astype(np.float32),
        segments=segments[here[1]].astype(np.float32),
        areas=areas[here[2]].astype(np.float32),
        labels=tuple(labels),
        point_colours=None if shape.point_colours is None else shape.point_colours[here[0]],
        segment_colours=None if shape.segment_colours is None else shape.segment_colours[here[1]],
    )


def moved_points(points: npt.NDArray[np.floating], matrix: Matrix) -> npt.NDArray[np.float64]:
    """Points (..., 3) under a matrix (4, 4)."""
    with np.errstate(over="ignore", invalid="ignore"):
        moved: npt.NDArray[np.float64] = points @ matrix[:3, :3].T + matrix[:3, 3]
    return moved


def pose_matrix(pose: Any) -> Matrix:
    """geometry_msgs/Pose as a matrix (4, 4); one that is not turned says so with zeros, too.

    Raises
    ------
    ValueError
        When it is not finite.
    """
    at, turned = pose.position, pose.orientation
    place, rotation = (at.x, at.y, at.z), (turned.x, turned.y, turned.z, turned.w)
    if not all(map(math.isfinite, (*place, *rotation))):
        raise ValueError("a pose is not finite")
    return matrix_of(place, rotation if any(rotation) else (0.0, 0.0, 0.0, 1.0))


def vertices(points: Sequence[Any]) -> Points:
    """A list of geometry_msgs/Point or Point32 as (N, 3)."""
    return np.array([(p.x, p.y, p.z) for p in points], np.float32).reshape(-1, 3)


def joined(points: npt.NDArray[np.floating]) -> Points:
    """Segments (N - 1, 2, 3) along a line of points (N, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1).astype(np.float32)


def _part(message: Any, shape: Shape, note: str = "") -> Part:
    return Part(str(message.header.frame_id), convert.seconds(message.header.stamp), shape, note)


def _positions(poses: Sequence[Any], *, keep: bool = False) -> Points:
    """Where poses are, (N, 3); without those that are not finite, unless they are to be kept."""
    points = vertices([pose.position for pose in poses])
    if keep:
        return points
    sound = _sound(points)
    _some(sound, "poses")
    return points[sound]


def _ahead(q: Any) -> tuple[float, float, float]:
    """Where the x axis of a turned frame points, of length 1."""
    length = math.sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w)
    if length == 0.0:
        return 1.0, 0.0, 0.0
    x, y, z, w = q.x / length, q.y / length, q.z / length, q.w / length
    return 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)


def _spread(count: int, most: int) -> npt.NDArray[np.int64]:
    """At most so many indices of `count`, first and last among them."""
    if count <= most:
        return np.arange(count)
    return np.linspace(0, count - 1, most).astype(np.int64)


def _left_out(whole: Sequence[Any] | Points, drawn: Sequence[Any] | Points) -> str:
    if len(drawn) >= len(whole):
        return ""
    return f"{len(drawn)} of {len(whole)} points are drawn."


def _some(sound: npt.NDArray[np.bool_], field: str) -> None:
    if len(sound) > 0 and not sound.any():
        raise ValueError(f"{field}: none of {len(sound)} is finite")


def _finite(points: npt.NDArray[np.floating]) -> Points:
    return points[_sound(points)].astype(np.float32)


def _sound(points: npt.NDArray[np.floating]) -> npt.NDArray[np.bool_]:
    """Which of points (N, 3) are finite."""
    sound: npt.NDArray[np.bool_] = np.isfinite(points).all(axis=1)
    return sound


def _near(points: npt.NDArray[np.floating]) -> npt.NDArray[np.bool_]:
    """Which of things (N, …, 3) are near with all their points."""
    with np.errstate(invalid="ignore"):
        far = ~(np.abs(points) < _FARTHEST)
    near: npt.NDArray[np.bool_] = ~far.any(axis=tuple(range(1, far.ndim)))
    return near


def _up(height: float) -> Points:
    return np.array([0.0, 0.0, height], np.float32)


_GREY = (128, 128, 128)


def _colours(given: Sequence[tuple[npt.NDArray[np.uint8] | None, int]]) -> Any:
    if all(colours is None for colours, _ in given):
        return None
    full = [
        np.tile(np.array(_GREY, np.uint8), (count, 1)) if colours is None else colours
        for colours, count in given
    ]
    return np.concatenate(full)
