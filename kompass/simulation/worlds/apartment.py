"""A flat of four rooms: doorways 0.9 m wide, furniture, and a hall that joins them."""

from __future__ import annotations

from kompass.simulation.worlds.shapes import Box, Cylinder
from kompass.simulation.worlds.world import World

_WALL = 0.12


def _wall(name: str, start: tuple[float, float], end: tuple[float, float]) -> Box:
    """An inner wall along x or y from ``start`` to ``end``, metres."""
    center = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
    length_x, length_y = abs(end[0] - start[0]), abs(end[1] - start[1])
    size = (length_x, _WALL) if length_x > length_y else (_WALL, length_y)
    return Box(name=name, center=center, size=size, height=1.0)


def _door(name: str, start: tuple[float, float], end: tuple[float, float]) -> Box:
    """The closed door between two ends of a wall along x, metres."""
    return Box(name, ((start[0] + end[0]) / 2, start[1]), (end[0] - start[0], 0.04), height=1.0)


# x runs along the hall from the front door, y across it; the hall is 1.5 m wide.
APARTMENT = World(
    name="apartment",
    title="Flat with four rooms, doorways and furniture",
    floor=((0.0, 0.0), (9.0, 0.0), (9.0, 7.0), (0.0, 7.0)),
    start=(0.6, 3.6, 0.0),
    wall_height=1.0,
    obstacles=(
        # South of the hall: the living room (doorway at x = 2.0…2.9) and the kitchen (6.4…7.3).
        _wall("living_hall_west", (0.0, 2.85), (2.0, 2.85)),
        _wall("living_hall_east", (2.9, 2.85), (6.4, 2.85)),
        _wall("kitchen_hall_east", (7.3, 2.85), (9.0, 2.85)),
        _wall("living_kitchen", (5.2, 0.0), (5.2, 2.85)),
        # North of the hall: the bedroom (doorway at x = 1.2…2.1) and the study (5.6…6.5).
        _wall("bedroom_hall_west", (0.0, 4.35), (1.2, 4.35)),
        _wall("bedroom_hall_east", (2.1, 4.35), (5.6, 4.35)),
        _wall("study_hall_east", (6.5, 4.35), (9.0, 4.35)),
        _wall("bedroom_study", (4.6, 4.35), (4.6, 7.0)),
        Box("sofa", (1.3, 0.45), (1.9, 0.8)),
        Box("coffee_table", (1.3, 1.55), (0.9, 0.5), height=0.4),
        Box("bookshelf", (5.0, 1.6), (0.28, 1.4), height=1.0),
        Cylinder("floor_lamp", (3.0, 0.4), 0.15, height=1.0),
        Box("counter", (7.1, 0.3), (3.6, 0.6), height=0.9),
        Cylinder("kitchen_table", (7.9, 1.6), 0.4, height=0.75),
        Box("fridge", (5.6, 2.4), (0.65, 0.65), height=1.0),
        Box("bed", (0.95, 6.0), (1.6, 1.9)),
        Box("wardrobe", (4.2, 6.3), (0.6, 1.3), height=1.0),
        Box("desk", (7.2, 6.6), (1.6, 0.7), height=0.75),
        Box("desk_chair", (7.1, 5.9), (0.45, 0.45), yaw=0.4),
        Cylinder("plant", (8.6, 4.8), 0.22, height=0.9),
        Box("shoe_cabinet", (8.75, 3.6), (0.35, 0.8)),
    ),
    doorways=(
        _door("living", (2.0, 2.85), (2.9, 2.85)),
        _door("kitchen", (6.4, 2.85), (7.3, 2.85)),
        _door("bedroom", (1.2, 4.35), (2.1, 4.35)),
        _door("study", (5.6, 4.35), (6.5, 4.35)),
    ),
)
