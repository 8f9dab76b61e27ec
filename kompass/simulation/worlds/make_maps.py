"""Write the map files of all worlds: ``python -m kompass.simulation.worlds.make_maps [FOLDER]``."""

from __future__ import annotations

import argparse
from pathlib import Path

from kompass.algorithms.map_file import save_map
from kompass.simulation.worlds.rasterize import rasterize
from kompass.simulation.worlds.registry import world, world_names

MAPS_FOLDER = Path(__file__).resolve().parents[2] / "maps"

# Recipes written for the Webots TurtleBot3 load their map under this name.
ALIASES = {"turtlebot3_webots": "hexagon"}


def make_maps(folder: Path) -> list[Path]:
    """Write ``<world>.yaml`` and ``<world>.pgm`` for every world, and the aliases, into ``folder``.

    Returns
    -------
    list[Path]
        The .yaml files written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    sources = {name: name for name in world_names()} | ALIASES
    written = []
    for file_name, world_name in sources.items():
        path = folder / f"{file_name}.yaml"
        save_map(rasterize(world(world_name)), path)
        written.append(path)
    return written


def main() -> None:
    parser = argparse.ArgumentParser(description="Write the map files of all worlds.")
    parser.add_argument("folder", nargs="?", type=Path, default=MAPS_FOLDER)
    make_maps(parser.parse_args().folder)


if __name__ == "__main__":
    main()
