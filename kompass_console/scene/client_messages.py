"""What a browser may tell viser: where its camera is, and nothing else.

viser takes whatever its own client could send, and believes it: a camera of the wrong shape ends
its handler, one with a height of zero or at the point it looks at raises in the middle of drawing.
Clicks and drags are the page's own overlay; GUI values, uploads, public share tunnels and pictures
that nobody asked for have no business here.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Literal

import msgspec

_FARTHEST = 1e6  # m from the origin
_NEAREST = 1e-3  # m between the camera and the point it looks at
_UNIT = 0.01  # by which the norm of a rotation or direction may differ from 1

_Pixels = Annotated[float, msgspec.Meta(ge=1.0, le=32_768.0)]
_Angle = Annotated[float, msgspec.Meta(gt=0.0, lt=math.pi)]
_Distance = Annotated[float, msgspec.Meta(ge=0.0)]
_Vector = tuple[float, float, float]


class _ViewerCamera(msgspec.Struct, forbid_unknown_fields=True):
    """viser's message, field by field."""

    type: Literal["ViewerCameraMessage"]
    wxyz: tuple[float, float, float, float]
    position: _Vector
    fov: _Angle
    near: _Distance
    far: _Distance
    image_height: _Pixels
    image_width: _Pixels
    look_at: _Vector
    up_direction: _Vector


_decoder = msgspec.msgpack.Decoder(_ViewerCamera)


def allowed(data: bytes) -> bool:
    """Whether a scene message from a browser may reach viser."""
    try:
        camera = _decoder.decode(data)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError):
        return False
    return (
        _within((*camera.position, *camera.look_at), _FARTHEST)
        and math.isfinite(camera.near)
        and math.isfinite(camera.far)
        and _is_unit(camera.wxyz)
        and _is_unit(camera.up_direction)
        and math.dist(camera.position, camera.look_at) >= _NEAREST
    )


def _within(values: Iterable[float], largest: float) -> bool:
    # A comparison with NaN is false.
    return all(abs(value) <= largest for value in values)


def _is_unit(values: tuple[float, ...]) -> bool:
    return abs(math.hypot(*values) - 1.0) <= _UNIT
