"""What messages of cameras and detectors say, as the followers of a target take it."""

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import CameraInfo, Image
from vision_msgs.msg import Detection2DArray

from kompass.algorithms.tracking.box import Box
from kompass.algorithms.tracking.camera import Camera

_WHOLE, _REAL = ("16UC1", "mono16"), "32FC1"


def boxes_of(message: Detection2DArray) -> list[Box]:
    """The boxes of a message; the label of each is its likeliest class."""
    boxes = []
    for found in message.detections:
        likeliest = max(found.results, key=lambda one: one.hypothesis.score, default=None)
        boxes.append(
            Box(
                "" if likeliest is None else likeliest.hypothesis.class_id,
                found.bbox.center.position.x,
                found.bbox.center.position.y,
                found.bbox.size_x,
                found.bbox.size_y,
                found.id,
            )
        )
    return boxes


def camera_of(message: CameraInfo) -> Camera:
    """The camera of a message, whose images are taken to be without distortion.

    Raises
    ------
    ValueError
        It tells no size, or no focal length.
    """
    fx, _, cx, _, fy, cy, *_ = (float(value) for value in message.k)
    return Camera(message.width, message.height, fx, fy, cx, cy)


def depths_of(message: Image, factor: float) -> NDArray[np.float64]:
    """Depths (rows, columns) [m] of an image.

    Parameters
    ----------
    factor
        Of whole numbers [m]; real ones are metres.

    Raises
    ------
    ValueError
        It is no image of depths, or not whole.
    """
    kind: np.dtype[Any]
    if message.encoding in _WHOLE:
        kind, scale = np.dtype(np.uint16), factor
    elif message.encoding == _REAL:
        kind, scale = np.dtype(np.float32), 1.0
    else:
        known = ", ".join((*_WHOLE, _REAL))
        raise ValueError(f"its encoding is {message.encoding!r}; publish one of {known}")
    if bool(message.is_bigendian) != (sys.byteorder == "big"):
        kind = kind.newbyteorder()
    rows, columns, step = message.height, message.width, message.step
    if step < columns * kind.itemsize or len(message.data) < rows * step:
        raise ValueError(
            f"{len(message.data)} bytes are fewer than {rows} rows of {columns} depths need"
        )
    flat = np.frombuffer(message.data, dtype=np.uint8, count=rows * step).reshape(rows, step)
    row = np.ascontiguousarray(flat[:, : columns * kind.itemsize])
    return row.view(kind).astype(np.float64) * scale
