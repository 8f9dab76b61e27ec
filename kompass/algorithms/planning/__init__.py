"""Global planning: from where the robot is to where it should be, over a known map."""
