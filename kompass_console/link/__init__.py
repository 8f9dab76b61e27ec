"""The console's ROS side: one node on one thread, that reads the newest and asks in time."""
