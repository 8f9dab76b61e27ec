"""The monitor: feeds the rule engine on ROS 2, carries out what fires, and changes the rules."""
