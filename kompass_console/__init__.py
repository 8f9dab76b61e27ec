"""Kompass Console: the browser page from which people drive and heal their ROS 2 robots."""
