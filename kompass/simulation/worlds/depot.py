"""A distribution depot of 80 m by 50 m: long racks, cross aisles, columns, docks with pallets.

At 5 cm its map has 1,600 × 1,000 cells, as large halls have.
"""

from __future__ import annotations

from kompass.simulation.worlds.shapes import Box, Cylinder, Shape
from kompass.simulation.worlds.world import World

_WIDTH, _DEPTH = 80.0, 50.0
_RACK_LENGTH, _RACK_DEPTH = 10.8, 2.4
_AISLE, _CROSS_AISLE = 3.0, 2.6
_BLOCKS, _ROWS = 5, 8
_FIRST = (9.0, 5.0)  # lower left corner of the first rack


def _corner(block: int, row: int) -> tuple[float, float]:
    """Lower left corner of a rack."""
    x = _FIRST[0] + block * (_RACK_LENGTH + _CROSS_AISLE)
    return x, _FIRST[1] + row * (_RACK_DEPTH + _AISLE)


def _racks() -> tuple[Shape, ...]:
    found = []
    for row in range(_ROWS):
        for block in range(_BLOCKS):
            x, y = _corner(block, row)
            middle = (x + _RACK_LENGTH / 2, y + _RACK_DEPTH / 2)
            name = f"rack_{row}_{block}"
            found.append(Box(name, middle, (_RACK_LENGTH, _RACK_DEPTH), height=2.0))
    return tuple(found)


def _columns() -> tuple[Shape, ...]:
    """In the middle of every other cross aisle, where the racks of two rows end."""
    found = []
    for row in range(1, _ROWS, 2):
        for block in range(1, _BLOCKS, 2):
            x, y = _corner(block, row)
            middle = (x - _CROSS_AISLE / 2, y - _AISLE / 2)
            found.append(Cylinder(f"column_{row}_{block}", middle, 0.2, height=2.0))
    return tuple(found)


def _docks() -> tuple[Shape, ...]:
    """Along the left wall tables, along the right one pallets that nobody put straight."""
    tables = tuple(
        Box(f"table_{index}", (3.0, 7.0 + 6.0 * index), (1.0, 2.2), height=0.9)
        for index in range(7)
    )
    pallets = tuple(
        Box(f"pallet_{index}", (77.6 + 0.5 * (index % 2), 6.0 + 4.5 * index), (1.2, 0.8), yaw=turn)
        for index, turn in enumerate((0.0, 0.3, 1.5, 0.1, 1.3, 0.0, 0.7, 1.57, 0.2))
    )
    return (*tables, *pallets)


DEPOT = World(
    name="depot",
    title="Distribution depot of 80 m by 50 m with racks, columns and docks",
    floor=((0.0, 0.0), (_WIDTH, 0.0), (_WIDTH, _DEPTH), (0.0, _DEPTH)),
    start=(6.0, 2.5, 0.0),
    wall_height=2.0,
    obstacles=(*_racks(), *_columns(), *_docks()),
)
