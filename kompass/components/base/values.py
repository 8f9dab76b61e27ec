"""Between messages and the plain values that the code of a component works with."""

import numbers
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from kompass.components.base.convert import pose_of, quaternion_msg
from kompass.rclpy_ext.messages import fill, part_to_plain

_NUMBERS = {
    **dict.fromkeys(("Float32", "Float64"), float),
    **dict.fromkeys(("Int8", "Int16", "Int32", "Int64", "Byte", "Char"), int),
    **dict.fromkeys(("UInt8", "UInt16", "UInt32", "UInt64"), int),
}
_ARRAYS = tuple(f"{kind}MultiArray" for kind in ("Float32", "Float64", "Int16", "Int32", "Int64"))


def value_of(message: Any) -> Any:
    """What a message says, as a plain value.

    ``data`` of numbers, truth values and texts; an array in its shape for a ``…MultiArray``;
    (x, y, z) [m] of points; (x, y, z, yaw) [m, rad] of poses; (x, y, z, yaw, speed) [m, rad, m/s]
    of odometry; the velocities (vx, vy, omega) [m/s, m/s, rad/s] of a Twist. Any other message is
    given as it is.
    """
    kind = type(message).__name__
    if kind in _NUMBERS or kind in ("Bool", "String"):
        return part_to_plain(message.data)
    if kind in _ARRAYS:
        array = np.array(message.data)
        shape = [dimension.size for dimension in message.layout.dim]
        return array.reshape(shape) if shape and int(np.prod(shape)) == array.size else array
    if kind in ("Point", "PointStamped"):
        point = getattr(message, "point", message)
        return np.array([point.x, point.y, point.z])
    if kind in ("Twist", "TwistStamped"):
        twist = getattr(message, "twist", message)
        return np.array([twist.linear.x, twist.linear.y, twist.angular.z])
    if kind in ("Pose", "PoseStamped", "Odometry"):
        pose = message
        while hasattr(pose, "pose"):
            pose = pose.pose
        values = [pose.position.x, pose.position.y, pose.position.z, pose_of(pose)[2]]
        if kind == "Odometry":
            linear = message.twist.twist.linear
            values.append(float(np.hypot(linear.x, linear.y)))
        return np.array(values)
    return message


def message_of(kind: type[Any], value: Any) -> Any:
    """A message of a plain value, the other way round than :func:`value_of`.

    Parameters
    ----------
    kind
        Message class.
    value
        A message of that class, a mapping of its fields, or what ``value_of`` gives of one; a
        pose may also be (x, y, yaw).

    Raises
    ------
    TypeError
        When it cannot be made; says what is taken.
    """
    if isinstance(value, kind):
        return value
    name = kind.__name__
    make, taken = _MAKERS.get(name, (None, ""))
    try:
        if isinstance(value, Mapping):
            return fill(kind(), dict(value))
        if make is not None:
            return make(kind, value)
    except (AssertionError, AttributeError, TypeError, ValueError) as error:
        raise TypeError(_refused(name, value, taken, error)) from None
    raise TypeError(_refused(name, value, taken))


def _refused(name: str, value: Any, taken: str, error: Exception | None = None) -> str:
    other = f"{taken}, " if taken else ""
    why = f" ({error})" if error is not None and str(error) else ""
    return (
        f"{value!r} makes no {name}{why}; give {other}a {name} message, or a mapping of its fields"
    )


def _number(kind: type[Any], value: Any) -> Any:
    wanted: Callable[[Any], Any] = _NUMBERS[kind.__name__]
    fits = numbers.Real if wanted is float else numbers.Integral
    if isinstance(value, bool | np.bool_) or not isinstance(value, fits):
        raise TypeError
    return fill(kind(), {"data": wanted(value)})


def _text(kind: type[Any], value: Any) -> Any:
    if not isinstance(value, str):
        raise TypeError
    return fill(kind(), {"data": value})


def _truth(kind: type[Any], value: Any) -> Any:
    if not isinstance(value, bool | np.bool_):
        raise TypeError
    return kind(data=bool(value))


def _array(kind: type[Any], value: Any) -> Any:
    from std_msgs.msg import MultiArrayDimension

    array = np.asarray(value)
    fits = "fiu" if kind.__name__.startswith("Float") else "iu"
    if array.size and array.dtype.kind not in fits:
        raise TypeError
    message = fill(kind(), {"data": array.ravel().tolist()})
    stride = array.size
    for index, size in enumerate(array.shape):
        label = f"axis {index}"
        message.layout.dim.append(MultiArrayDimension(label=label, size=size, stride=stride))
        stride //= size or 1
    return message


def _floats(value: Any, *counts: int) -> list[float]:
    if isinstance(value, str | bytes) or not isinstance(value, Sequence | np.ndarray):
        raise TypeError
    if len(value) not in counts:
        raise ValueError(f"there are {len(value)}")
    return [float(each) for each in value]


def _point(kind: type[Any], value: Any) -> Any:
    message = kind()
    point = getattr(message, "point", message)
    point.x, point.y, point.z = _floats(value, 3)
    return message


def _pose(kind: type[Any], value: Any) -> Any:
    message = kind()
    pose = getattr(message, "pose", message)
    x, y, *z, yaw = _floats(value, 3, 4)
    pose.position.x, pose.position.y, pose.position.z = x, y, (z[0] if z else 0.0)
    pose.orientation = quaternion_msg(yaw)
    return message


def _twist(kind: type[Any], value: Any) -> Any:
    message = kind()
    twist = getattr(message, "twist", message)
    twist.linear.x, twist.linear.y, twist.angular.z = _floats(value, 3)
    return message


_Maker = Callable[[type[Any], Any], Any]
_MAKERS: dict[str, tuple[_Maker | None, str]] = {
    **{
        name: (_number, "a number" if kind is float else "a whole number")
        for name, kind in _NUMBERS.items()
    },
    "Bool": (_truth, "True or False"),
    "String": (_text, "a text"),
    **dict.fromkeys(_ARRAYS, (_array, "an array of numbers")),
    **dict.fromkeys(("Point", "PointStamped"), (_point, "(x, y, z)")),
    **dict.fromkeys(("Pose", "PoseStamped"), (_pose, "(x, y, yaw) or (x, y, z, yaw)")),
    **dict.fromkeys(("Twist", "TwistStamped"), (_twist, "(vx, vy, omega)")),
}
