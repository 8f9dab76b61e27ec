"""The robot's missions, kept and driven by the monitor."""
