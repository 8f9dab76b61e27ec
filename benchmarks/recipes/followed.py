"""The stack as it comes, with the follower that the environment names (``FOLLOWER``)."""

import os

from kompass.bench.stack import bring_up
from kompass.simulation.physics.robot_model import robot_model

bring_up(robot_model(os.environ.get("ROBOT", "turtlebot3")), os.environ["FOLLOWER"])
