"""The monitor: the thin shell around the rule engine, on ROS 2."""
