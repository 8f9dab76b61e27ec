"""Worlds by name."""

from __future__ import annotations

from kompass.simulation.worlds.apartment import APARTMENT
from kompass.simulation.worlds.depot import DEPOT
from kompass.simulation.worlds.hexagon import HEXAGON
from kompass.simulation.worlds.warehouse import WAREHOUSE
from kompass.simulation.worlds.world import World

_WORLDS = {item.name: item for item in (HEXAGON, APARTMENT, WAREHOUSE, DEPOT)}


def world_names() -> tuple[str, ...]:
    """The names that ``world`` knows, the default first."""
    return tuple(_WORLDS)


def add_world(place: World) -> None:
    """Let ``place`` be known by its name, in this process; it takes the place of one so named."""
    _WORLDS[place.name] = place


def world(name: str) -> World:
    """The world called ``name``.

    Raises
    ------
    ValueError
        There is no such world; the message lists those there are.
    """
    found = _WORLDS.get(name)
    if found is None:
        known = ", ".join(world_names())
        raise ValueError(f"world is {name!r}, which does not exist; choose one of: {known}")
    return found
