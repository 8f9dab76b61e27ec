"""The robot's own store: rules, places, missions, zones, its timeline. No ROS: SQLite."""
