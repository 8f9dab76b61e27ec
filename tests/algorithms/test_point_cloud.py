"""Clouds of any layout are read as the same points; what is no cloud is refused with a remedy."""

from __future__ import annotations

import math
import struct
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from kompass.algorithms.mapping.point_cloud import read_points

FLOAT32, FLOAT64, UINT16 = 7, 8, 4


class Field(NamedTuple):
    name: str
    offset: int
    datatype: int = FLOAT32


XYZ = [Field("x", 0), Field("y", 4), Field("z", 8)]
coordinates = st.one_of(
    st.floats(-50, 50, width=32), st.sampled_from([math.nan, math.inf, -math.inf])
)


def packed(points: NDArray[np.float64]) -> dict[str, Any]:
    """The usual layout of points (N, 3), in one row."""
    count = len(points)
    return {
        "data": points.astype("<f4").tobytes(),
        "fields": XYZ,
        "width": count,
        "height": 1,
        "point_step": 12,
        "row_step": 12 * count,
    }


@st.composite
def clouds(draw: st.DrawFn) -> tuple[dict[str, Any], NDArray[np.float32]]:
    """A message of any layout, and the points that are in it."""
    height, width = draw(st.integers(1, 4)), draw(st.integers(0, 5))
    points = draw(
        st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=height * width,
                 max_size=height * width)
    )  # fmt: skip
    order = draw(st.permutations("xyz"))
    big_endian, offset, fields = draw(st.booleans()), draw(st.integers(0, 7)), []
    for axis in order:
        double = draw(st.booleans())
        fields.append(Field(axis, offset, FLOAT64 if double else FLOAT32))
        offset += (8 if double else 4) + draw(st.integers(0, 5))
    fields.insert(draw(st.integers(0, 3)), Field("intensity", 0, UINT16))
    point_step = offset + draw(st.integers(0, 9))
    row_step = point_step * width + draw(st.integers(0, 9))
    data = bytearray(draw(st.binary(min_size=row_step * height, max_size=row_step * height)))
    for index, point in enumerate(points):
        start = index // width * row_step + index % width * point_step
        for field in fields:
            if field.name in "xyz":
                kind = (">" if big_endian else "<") + ("d" if field.datatype == FLOAT64 else "f")
                value = point["xyz".index(field.name)]
                struct.pack_into(kind, data, start + field.offset, value)
    message: dict[str, Any] = {
        "data": bytes(data),
        "fields": fields,
        "width": width,
        "height": height,
        "point_step": point_step,
        "row_step": row_step,
        "big_endian": big_endian,
    }
    return message, np.array(points, dtype=np.float32).reshape(-1, 3)


@given(clouds())
@settings(max_examples=200, deadline=None)
def test_whatever_the_layout_the_points_are_the_same(
    made: tuple[dict[str, Any], NDArray[np.float32]],
) -> None:
    message, points = made
    np.testing.assert_array_equal(read_points(**message), points.T)


def test_a_last_row_may_end_with_its_last_point() -> None:
    points = np.arange(18.0).reshape(6, 3)
    message = packed(points) | {"width": 3, "height": 2, "row_step": 40}
    rows = points.astype("<f4").tobytes()
    message["data"] = rows[:36] + bytes(4) + rows[36:]
    np.testing.assert_array_equal(read_points(**message), points.T)


def test_a_number_that_is_too_large_is_none() -> None:
    fields = [Field("x", 0, FLOAT64), Field("y", 8, FLOAT64), Field("z", 16, FLOAT64)]
    message = packed(np.zeros((1, 3))) | {"fields": fields, "point_step": 24, "row_step": 24}
    message["data"] = struct.pack("<ddd", 1e300, 0.0, 0.0)
    assert np.isinf(read_points(**message)[0, 0])


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"fields": []}, "fields has no 'x', there are none; a cloud has x, y and z"),
        ({"fields": XYZ[:2]}, "fields has no 'z', there are x, y"),
        ({"fields": [*XYZ[:2], Field("z", 8, UINT16)]}, r"z is of datatype 4 \(UINT16\); have"),
        ({"fields": [*XYZ[:2], Field("z", 8, 99)]}, r"datatype 99 \(none that is known\)"),
        ({"fields": [*XYZ[:2], Field("z", 10)]}, "z at offset 10 goes beyond a point of"),
        ({"point_step": 0}, "x at offset 0 goes beyond a point of point_step = 0 bytes"),
        ({"data": b"1234"}, "data has 4 bytes, and 1 rows of 6 points are 72"),
        ({"width": 7}, "data has 72 bytes, and 1 rows of 7 points are 84"),
        ({"width": 3, "height": 2, "row_step": 20}, "row_step = 20 is less than width x point_st"),
    ],
)
def test_what_is_no_cloud_is_refused_with_the_field_and_the_remedy(
    wrong: dict[str, Any], said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        read_points(**(packed(np.zeros((6, 3))) | wrong))


@given(
    st.binary(max_size=60), st.integers(0, 9), st.integers(0, 9), st.integers(0, 40),
    st.integers(0, 90), st.integers(0, 40), st.integers(0, 10),
)  # fmt: skip
@settings(max_examples=300, deadline=None)
def test_whatever_is_sent_is_read_or_refused(
    data: bytes, width: int, height: int, point_step: int, row_step: int, offset: int, kind: int
) -> None:
    fields = [Field("x", 0), Field("y", offset, kind), Field("z", 4)]
    said = ""
    try:
        points = read_points(
            data, fields, width=width, height=height, point_step=point_step, row_step=row_step
        )
    except ValueError as error:
        said = str(error)
    if said:
        assert "; have its driver" in said
    else:
        assert points.shape == (3, width * height)
