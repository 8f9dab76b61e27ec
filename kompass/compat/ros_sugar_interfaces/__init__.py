"""Import name of the interface package in 2024; the interfaces live in automatika_ros_sugar."""
