"""What the robot computes, apart from ROS: plain functions and small classes on NumPy arrays.

Units are metres, seconds and radians throughout. A *pose* is ``(x, y, yaw)`` in a named frame; a
*twist* is ``(vx, vy, omega)`` in the robot's base frame (x ahead, y to the left). Nothing here
reads a clock, starts a thread or opens a file, except :mod:`kompass.algorithms.map_file`.
"""
