"""The contract of the console: what the browser, the ROS side and the scene exchange."""
