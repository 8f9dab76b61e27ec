"""Who is believed over ROS: the services of a node let in whom they may, and clients sign."""
