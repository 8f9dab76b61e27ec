"""The people who may log in by name: kept in a file on the robot."""
