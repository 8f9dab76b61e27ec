"""What happens to the robot: observed, kept, told."""
