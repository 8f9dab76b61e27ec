"""Points in space from the bytes of a point cloud (sensor_msgs/PointCloud2), of any layout."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

# Numbers of sensor_msgs/PointField; coordinates come as one of two of them.
_NAMES = ("INT8", "UINT8", "INT16", "UINT16", "INT32", "UINT32", "FLOAT32", "FLOAT64")
_FLOATS = {7: "f4", 8: "f8"}


class Field(Protocol):
    """One of the numbers of a point, as sensor_msgs/PointField says it."""

    @property
    def name(self) -> str: ...
    @property
    def offset(self) -> int: ...
    @property
    def datatype(self) -> int: ...


def read_points(
    data: bytes | bytearray | memoryview,
    fields: Sequence[Field],
    *,
    width: int,
    height: int,
    point_step: int,
    row_step: int,
    big_endian: bool = False,
) -> NDArray[np.float32]:
    """The coordinates (3, N) of a cloud's points in the sensor's frame [m]; NaN as it is sent.

    Parameters
    ----------
    data
        All rows of points, each point with what else is known of it.
    fields
        What a point is made of; ``x``, ``y`` and ``z`` are read.
    width, height
        Points of a row, and rows; one row when the cloud is not organized.
    point_step, row_step
        From one point, and from one row, to the next; there may be bytes between them [bytes].
    big_endian
        In which order the bytes of a number are.

    Raises
    ------
    ValueError
        It is no such cloud; names the field of the message and the remedy.
    """
    count = width * height
    if count == 0:
        return np.empty((3, 0), dtype=np.float32)
    offsets = [_offset(fields, axis, point_step, big_endian) for axis in "xyz"]
    if row_step < width * point_step and height > 1:
        raise ValueError(
            f"row_step = {row_step} is less than width x point_step = {width} x {point_step}; "
            "have its driver give the bytes of a whole row"
        )
    buffer = np.frombuffer(data, dtype=np.uint8)
    needed = row_step * (height - 1) + width * point_step
    if buffer.size < needed:
        raise ValueError(
            f"data has {buffer.size} bytes, and {height} rows of {width} points are {needed}; "
            "have its driver send whole clouds"
        )
    points = np.empty((3, height, width), dtype=np.float32)
    with np.errstate(over="ignore", invalid="ignore"):  # what float32 cannot hold is inf
        for axis, (offset, kind) in enumerate(offsets):
            points[axis] = np.ndarray(
                (height, width), kind, buffer.data, offset, (row_step, point_step)
            )
    return points.reshape(3, count)


def _offset(
    fields: Sequence[Field], axis: str, point_step: int, big_endian: bool
) -> tuple[int, np.dtype[np.floating]]:
    """Where in a point a coordinate is, and of which kind it is."""
    field = next((one for one in fields if one.name == axis), None)
    if field is None:
        names = ", ".join(one.name for one in fields) or "none"
        raise ValueError(f"fields has no {axis!r}, there are {names}; a cloud has x, y and z")
    if field.datatype not in _FLOATS:
        known = 1 <= field.datatype <= len(_NAMES)
        name = _NAMES[field.datatype - 1] if known else "none that is known"
        raise ValueError(
            f"fields: {axis} is of datatype {field.datatype} ({name}); have its driver give "
            "FLOAT32 or FLOAT64, in metres"
        )
    kind = np.dtype((">" if big_endian else "<") + _FLOATS[field.datatype])
    if field.offset < 0 or field.offset + kind.itemsize > point_step:
        raise ValueError(
            f"fields: {axis} at offset {field.offset} goes beyond a point of point_step = "
            f"{point_step} bytes; have its driver give the layout of its points"
        )
    return field.offset, kind
