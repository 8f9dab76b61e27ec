"""The drive manager: the last gate before the wheels, and the motions that free the robot."""
