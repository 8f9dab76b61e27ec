"""The embedded robot: a differential drive in MuJoCo with the sensors of a real one.

Importing this package loads neither MuJoCo nor ROS; ``kompass.simulation.robot`` and
``kompass.simulation.node`` do, in the process that runs the robot.
"""
