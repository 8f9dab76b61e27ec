"""A warehouse hall: three double racks with aisles, a packing area, columns and pallets."""

from __future__ import annotations

from kompass.simulation.worlds.shapes import Box, Cylinder, Shape
from kompass.simulation.worlds.world import World

_RACK_LENGTH = 3.2
_RACK_DEPTH = 0.9


def _racks() -> tuple[Shape, ...]:
    """Three rows of two racks; the aisles between rows are 1.6 m, the cross aisle 1.4 m."""
    return tuple(
        Box(
            name=f"rack_{row}_{half}",
            center=(5.2 + half * (_RACK_LENGTH + 1.4), 1.95 + row * (_RACK_DEPTH + 1.6)),
            size=(_RACK_LENGTH, _RACK_DEPTH),
            height=1.5,
        )
        for row in range(3)
        for half in range(2)
    )


WAREHOUSE = World(
    name="warehouse",
    title="Warehouse with racks, columns and a packing area",
    floor=((0.0, 0.0), (14.0, 0.0), (14.0, 9.0), (0.0, 9.0)),
    start=(1.2, 1.0, 0.0),
    wall_height=1.5,
    obstacles=(
        *_racks(),
        Box("packing_table_0", (0.9, 4.0), (0.8, 1.8), height=0.9),
        Box("packing_table_1", (0.9, 6.6), (0.8, 1.8), height=0.9),
        Box("pallet_0", (13.2, 1.2), (1.2, 0.8)),
        Box("pallet_1", (13.1, 4.6), (1.2, 0.8), yaw=1.45),
        Box("pallet_2", (13.0, 7.6), (1.2, 0.8), yaw=0.25),
        *(
            Cylinder(f"column_{index}", (2.6, y), 0.15, height=1.5)
            for index, y in enumerate((2.6, 5.3, 8.0))
        ),
    ),
)
