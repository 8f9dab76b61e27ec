"""Try the embedded robot alone: `python -m kompass.simulation [WORLD] [--seed N]`."""

from __future__ import annotations

import argparse

from kompass.simulation.node import run_simulator
from kompass.simulation.worlds.registry import world_names


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m kompass.simulation",
        description="Run the embedded robot as a ROS 2 node until Ctrl-C.",
    )
    names = world_names()
    parser.add_argument("world", nargs="?", default=names[0], choices=names)
    parser.add_argument("--seed", type=int, default=0, help="of noise and calibration errors")
    parser.add_argument("--node-name", default="simulator")
    options = parser.parse_args()
    run_simulator(options.world, seed=options.seed, node_name=options.node_name)


if __name__ == "__main__":
    main()
