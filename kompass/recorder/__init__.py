"""The flight recorder: what the robot heard and what its rules did, on disk; and replays of it."""
