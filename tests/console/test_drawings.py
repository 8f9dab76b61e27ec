"""Drawings: made in one thread, looked at from another at any moment."""

from __future__ import annotations

import numpy as np

from kompass.algorithms.grid import Grid
from kompass_console.scene.drawings import Converter, Drawings
from kompass_console.schema.world import (
    GoalMark,
    HindranceMark,
    PlaceMark,
    Pose,
    RobotMotion,
    Scan,
    WorldModel,
    ZoneMark,
)


def told_everything() -> WorldModel:
    """A world of which the robot has said everything once."""
    world = WorldModel()
    world.motion.set(RobotMotion(Pose(0.0, 0.0, 0.0), 0.0, 0.0, 0.0))
    world.scan.set(Scan(np.ones(4, np.float32), 0.0, 1.0, 0.1, 5.0, 0.0, "laser"))
    world.map.set(Grid(np.full((4, 4), 100, np.int8), 0.05))
    world.local_map.set(Grid(np.full((4, 4), 100, np.int8), 0.05))
    world.path.set(np.array([[0.0, 0.0], [1.0, 0.0]]))
    world.footprint.set(np.array([[0.1, 0.1], [-0.1, 0.1], [0.0, -0.1]]))
    box = '<geometry><box size="0.2 0.2 0.2"/></geometry>'
    world.description.set(
        f'<robot name="r"><link name="base_link"><visual>{box}</visual></link></robot>'
    )
    world.goal.set(GoalMark(1.0, 0.0, None, active=True))
    world.hindrance.set(HindranceMark(0.5, 0.0, "In the way: a box."))
    world.places.set((PlaceMark("Dock", 0.0, 0.0, None),))
    world.zones.set((ZoneMark("Slow", ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)), 0.2),))
    return world


def test_a_page_that_comes_while_a_layer_is_converted_does_not_take_it_for_drawn() -> None:
    drawings = Drawings()
    looked: set[str] = set()

    class Counts(dict[str, int]):
        """Where a page takes a look: at each change of a count, which tells it that it has drawn
        all there is."""

        def __setitem__(self, layer: str, count: int) -> None:
            drawing = getattr(drawings, layer)
            assert drawing is not None
            assert not isinstance(drawing, tuple) or drawing
            looked.add(layer)
            super().__setitem__(layer, count)

    drawings.counts = Counts(drawings.counts)
    converter = Converter(told_everything(), drawings)
    converter.convert()
    converter.convert_map()
    assert looked == set(drawings.counts)
