"""Try the embedded robot alone: ``python -m kompass.simulation [WORLD] [--fault NAME]``."""

from __future__ import annotations

import argparse

from kompass.simulation.faults.fault_names import UnknownFault, help_text, parse_faults
from kompass.simulation.node import run_simulator
from kompass.simulation.physics.robot_model import robot_model, robot_names
from kompass.simulation.worlds.registry import world, world_names


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m kompass.simulation",
        description="Run the embedded robot as a ROS 2 node until Ctrl-C.",
    )
    names = world_names()
    parser.add_argument("world", nargs="?", default=names[0], choices=names)
    parser.add_argument("--robot", default=robot_names()[0], choices=robot_names())
    parser.add_argument("--seed", type=int, default=0, help="of noise and calibration errors")
    parser.add_argument("--node-name", default="simulator")
    parser.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="NAME[:SECONDS[:DURATION]]",
        help="switch a fault on, so many seconds after the start; may be given several times",
    )
    parser.epilog = f"faults:\n{help_text()}"
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    options = parser.parse_args()
    try:
        parse_faults(options.fault, world(options.world), robot_model(options.robot))
    except UnknownFault as error:
        parser.error(f"--fault: {error}")
    run_simulator(
        world(options.world),
        seed=options.seed,
        node_name=options.node_name,
        faults=options.fault,
        kind=robot_model(options.robot),
    )


if __name__ == "__main__":
    main()
