"""Transforms connect frames by the newest of each, and say which link is missing."""

import math

import numpy as np
import pytest

from kompass.algorithms.transforms import TransformError, TransformTree, matrix_of


def planar(x: float, y: float, yaw: float) -> np.ndarray:
    return matrix_of((x, y, 0.0), (0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)))


def test_a_chain_of_frames_is_multiplied_in_order() -> None:
    tree = TransformTree()
    tree.add("map", "odom", 0.0, planar(1, 0, math.pi / 2))
    tree.add("odom", "base", 0.0, planar(2, 0, 0))
    tree.add("base", "scan", 0.0, planar(0, 0.1, 0), static=True)
    assert tree.planar("map", "scan") == pytest.approx((0.9, 2.0, math.pi / 2))
    assert tree.planar("scan", "map") == pytest.approx((-2.0, 0.9, -math.pi / 2))


def test_frames_of_one_parent_are_connected() -> None:
    tree = TransformTree()
    tree.add("base", "left", 0.0, planar(0, 1, 0), static=True)
    tree.add("base", "right", 0.0, planar(0, -1, 0), static=True)
    assert tree.planar("left", "right") == pytest.approx((0, -2, 0))


@pytest.mark.parametrize("order", [(1.0, 2.0, 3.0), (3.0, 1.0, 2.0), (2.0, 3.0, 1.0)])
def test_of_a_moving_frame_the_newest_counts_whenever_it_arrives(order: list[float]) -> None:
    tree = TransformTree()
    for stamp in order:
        tree.add("odom", "base", stamp, planar(stamp, 0, 0))
    assert tree.planar("odom", "base")[0] == 3.0


def test_of_a_static_frame_the_last_to_arrive_counts() -> None:
    tree = TransformTree()
    tree.add("base", "scan", 5.0, planar(0.1, 0, 0), static=True)
    tree.add("base", "scan", 0.0, planar(0.2, 0, 0), static=True)
    assert tree.planar("base", "scan")[0] == 0.2


def test_a_frame_may_move_to_another_parent() -> None:
    tree = TransformTree()
    tree.add("odom", "base", 5.0, planar(1, 0, 0))
    tree.add("map", "base", 1.0, planar(2, 0, 0))
    assert tree.planar("map", "base")[0] == 2.0
    with pytest.raises(TransformError, match="'base' leads to 'map'"):
        tree.lookup("odom", "base")


def test_a_missing_link_is_named() -> None:
    tree = TransformTree()
    tree.add("odom", "base", 0.0, planar(0, 0, 0))
    tree.add("mast", "camera", 0.0, planar(0, 0, 0), static=True)
    with pytest.raises(TransformError, match="'camera' leads to 'mast', 'base' to 'odom'"):
        tree.lookup("base", "camera")


def test_a_loop_of_frames_ends_in_an_error_and_not_in_a_loop() -> None:
    tree = TransformTree()
    tree.add("a", "b", 0.0, planar(0, 0, 0))
    tree.add("b", "a", 0.0, planar(0, 0, 0))
    with pytest.raises(TransformError):
        tree.lookup("c", "a")


def test_what_moves_between_two_frames_is_as_old_as_its_oldest_part() -> None:
    tree = TransformTree()
    tree.add("odom", "base", 9.0, planar(1, 0, 0))
    tree.add("base", "neck", 3.0, planar(0, 0, 1))
    tree.add("neck", "head", 5.0, planar(0, 0, 1))
    tree.add("head", "camera", 0.0, planar(0, 0, 0), static=True)
    tree.add("base", "lidar", 0.0, planar(0, 0, 0), static=True)
    assert tree.moved_at("base", "camera") == tree.moved_at("camera", "base") == 3.0
    assert tree.moved_at("neck", "camera") == 5.0
    assert tree.moved_at("base", "lidar") == math.inf  # that odom moves does not matter
