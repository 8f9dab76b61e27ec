"""Following a path: where along it the robot is, and which twist keeps it there."""
