"""Who has control of the robot. Pure: no web, no clock; time is an argument."""
